#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <optional>
#include <string_view>
#include <tuple>

#include "algorithms/key_maps/key_chain.hpp"
#include "algorithms/scattering/transfer_table.hpp"
#include "algorithms/scene/scene.hpp"
#include "gl/objects.hpp"
#include "gl/program.hpp"

/// Translucency as Chan and Wang 2005, Sec. 3 (references.bib: chan2005) have it, for any technique that knows how long
/// a ray is inside: shaders/translucency.glsl reads a chain of blurred environments and a table of transfer functions.
namespace pellucid {

/// The meaning of a technique's parameter `transfer`: nothing, so that a medium acts by its absorption alone, or a
/// scattering::TransferModel.
enum class Transfer { none, gaussian, unscattered, two_gaussians };
inline constexpr std::string_view kTransfers = "none|gaussian|unscattered|two_gaussians";

struct TranslucencySettings {
  scattering::TransferModel model = scattering::TransferModel::gaussian;
  scattering::KeyChainOptions chain;
  double widening = 1;  ///< factor of the Gaussians' widths
  bool operator==(const TranslucencySettings&) const = default;
};
std::optional<TranslucencySettings> translucency_settings(Transfer, const scattering::KeyChainOptions& = {},
                                                          float widening = 1);

/// Whether any material of the scene does.
bool scatters(const Scene&);

/// The textures. A context must be current for every call.
class Translucency {
 public:
  /// Filters the environment, or takes it from the cache; nothing where no material of the scene scatters. The table of
  /// a material is made when it is first bound.
  void prepare(const Scene&, const TranslucencySettings&);
  /// The defines with which a program that includes translucency.glsl must be compiled; empty where no material
  /// scatters.
  static gl::Defines defines(const Scene&, scattering::TransferModel);
  /// Sets what translucency.glsl reads for one material, which scatters or not: textures to the units 11 and 12.
  void bind(const gl::Program&, const Scene&, const Material&);

  std::size_t bytes() const;  ///< of the chain, borders included
  std::size_t full_resolution_bytes() const { return full_bytes_; }
  double filter_s() const { return filter_s_; }  ///< of the run that filled the cache, if it was cached

 private:
  using MediumKey = std::tuple<float, float, float, float>;  // anisotropy, and the albedo by channel
  void refresh(const Scene&);
  const gl::Texture& table_of(const Material&);

  TranslucencySettings settings_;
  scattering::KeyWidths widths_{2, 0.02};
  Environment filtered_;  // what the chain is of; without its image
  gl::Texture chain_;
  int map_size_ = 0, face_rows_ = 0;  // as KeyAtlas has them
  float chain_scale_ = 1;
  glm::vec3 mean_{0.0F};
  std::size_t full_bytes_ = 0;
  double filter_s_ = 0;
  std::map<MediumKey, gl::Texture> tables_;
};

}  // namespace pellucid
