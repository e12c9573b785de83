#include "algorithms/raster/translucency.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <glm/gtc/packing.hpp>

#include "algorithms/progress.hpp"
#include "algorithms/scene/files/cache_file.hpp"
#include "gl/cube_faces.hpp"

namespace pellucid {
namespace {

using namespace scattering;

bool any_scatters(const Scene& scene) {
  return std::any_of(scene.materials.begin(), scene.materials.end(), [](const Material& m) { return m.scatters(); });
}

bool grey(const Material& m) {
  const auto same = [](const glm::vec3& v) { return v.x == v.y && v.y == v.z; };
  return same(m.scattering) && same(m.absorption);
}

bool same_gradient(const Environment& a, const Environment& b) {
  return a.zenith == b.zenith && a.horizon == b.horizon && a.ground == b.ground;
}

glm::vec3 albedo_of(const Material& m) {
  const glm::vec3 extinction = m.scattering + m.absorption;
  glm::vec3 albedo(0.0F);
  for (int c = 0; c < 3; ++c)
    albedo[c] = extinction[c] > 0 ? m.scattering[c] / extinction[c] : 0;
  return albedo;
}

constexpr int kTables = 8;  // media that are kept, as a slider passes them

}  // namespace

std::optional<TranslucencySettings> translucency_settings(Transfer transfer, const KeyChainOptions& chain,
                                                          float widening) {
  if (transfer == Transfer::none) return std::nullopt;
  return TranslucencySettings{static_cast<TransferModel>(static_cast<int>(transfer) - 1), chain,
                              static_cast<double>(widening)};
}

void Translucency::prepare(const Scene& scene, const TranslucencySettings& settings) {
  settings_ = settings;
  chain_ = {};
  tables_.clear();
  if (any_scatters(scene)) refresh(scene);
}

gl::Defines Translucency::defines(const Scene& scene) {
  if (!any_scatters(scene)) return {};
  gl::Defines defines{{"SCATTERING", "1"}};
  if (std::any_of(scene.materials.begin(), scene.materials.end(),
                  [](const Material& m) { return m.scatters() && !grey(m); }))
    defines.emplace_back("COLOURED_MEDIUM", "1");
  return defines;
}

// A gradient's colours may change without a call of prepare(), and a material may begin to scatter.
void Translucency::refresh(const Scene& scene) {
  const Environment& environment = scene.environment;
  if (chain_ && (environment.image || same_gradient(environment, filtered_))) return;
  KeyChainOptions options = settings_.chain;
  if (!environment.image) options.face_size = kLeastFace;  // a gradient has no details
  const KeyChain chain = key_chain(environment, options, environment.image ? cache_folder("key_maps") : "",
                                   [](double share) { tell_progress("filtering the environment", share); });
  chain_ = gl::Texture::make_cube("key maps", gl::Format::rgba16f, options.face_size / 2, chain.widths.levels());
  for (std::size_t level = 0; level < chain.half_rgb.size(); ++level) {
    const std::vector<std::uint16_t>& half = chain.half_rgb[level];
    std::vector<float> face(half.size() / 3 * 4 / gl::kCubeFaces, 1.0F);
    for (int f = 0; f < gl::kCubeFaces; ++f) {
      const std::size_t first = static_cast<std::size_t>(f) * face.size() / 4 * 3;
      for (std::size_t i = 0; i < face.size() / 4; ++i) {
        for (std::size_t c = 0; c < 3; ++c)
          face[4 * i + c] = glm::unpackHalf1x16(half[first + 3 * i + c]);
      }
      chain_.upload_layer(f, face, static_cast<int>(level));
    }
  }
  chain_.set_sampling(gl::Filter::mipmap, gl::Wrap::clamp);
  widths_ = chain.widths;
  chain_scale_ = chain.scale;
  mean_ = chain.mean;
  full_bytes_ = chain.full_resolution_bytes();
  filter_s_ = chain.filter_s;
  filtered_ = environment;
  filtered_.image.reset();
  tables_.clear();  // they hold levels of the chain
}

const gl::Texture& Translucency::table_of(const Material& material) {
  const glm::vec3 albedo = albedo_of(material);
  const MediumKey key(material.anisotropy, albedo.x, albedo.y, albedo.z);
  if (const auto found = tables_.find(key); found != tables_.end()) return found->second;
  if (tables_.size() >= kTables) tables_.clear();
  constexpr int kEntries = TransferTable::kEntries, kRows = 6;
  std::vector<float> texels(static_cast<std::size_t>(4 * kEntries * kRows));
  for (int c = 0; c < 3; ++c) {
    const bool repeated = c > 0 && albedo[c] == albedo[0];
    if (repeated) {
      for (const int row : {0, 3}) {
        const auto from = texels.begin() + 4 * kEntries * row;
        std::copy(from, from + 4 * kEntries, texels.begin() + 4 * kEntries * (row + c));
      }
      continue;
    }
    const TransferTable table({static_cast<double>(material.anisotropy), static_cast<double>(albedo[c])},
                              settings_.model);
    for (int i = 0; i < kEntries; ++i) {
      const TransferFit& fit = table.entries[static_cast<std::size_t>(i)];
      const double one[] = {widths_.level(settings_.widening * fit.theta_bar), fit.f_t, fit.c_t, fit.c_r};
      const double two[] = {widths_.level(settings_.widening * fit.theta_2), fit.f_2, 0, 0};
      for (int k = 0; k < 4; ++k) {
        texels[static_cast<std::size_t>(4 * (kEntries * c + i) + k)] = static_cast<float>(one[k]);
        texels[static_cast<std::size_t>(4 * (kEntries * (c + 3) + i) + k)] = static_cast<float>(two[k]);
      }
    }
  }
  gl::Texture texture = gl::Texture::make_2d("transfer functions", gl::Format::rgba32f, kEntries, kRows);
  texture.upload(texels);
  texture.set_sampling(gl::Filter::linear, gl::Wrap::clamp);
  return tables_.emplace(key, std::move(texture)).first->second;
}

void Translucency::bind(const gl::Program& program, const Scene& scene, const Material& material) {
  if (!any_scatters(scene)) return;
  refresh(scene);
  chain_.bind(11);
  table_of(material).bind(12);
  program.set("extinction", material.scattering + material.absorption);
  program.set("key_scale", chain_scale_ * scene.environment.scale);
  program.set("mean_radiance", mean_ * scene.environment.scale);
  program.set("transfer_model", static_cast<int>(settings_.model));
}

std::size_t Translucency::bytes() const {
  return chain_ ? chain_.bytes() : 0;
}

}  // namespace pellucid
