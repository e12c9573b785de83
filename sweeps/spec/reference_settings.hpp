#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "algorithms/reference/reference.hpp"

namespace pellucid::sweeps {

/// The standard that frames are compared with: the medium integrated in float64 (algorithms/reference), or the picture
/// that Imagire et al. 2007, Sec. 5, judge by: very many slices, drawn as the baseline draws them.
enum class ReferenceMethod { exact, slices };

/// Where the opaque surfaces of the exact reference come from: the forward pass's geometry with exact shadows, the same
/// with the shadow maps of the frame, or rays. `automatic`: rays where the scene has mirrors, metals or dielectrics, or
/// samples are asked for; else the forward pass's.
enum class ReferenceSurfaces { automatic, raster, forward, rays };

/// Bits of a colour channel that the slices blend into.
enum class SlicesFormat { half, single };

/// A spec's `[reference]`.
struct ReferenceSettings {
  ReferenceMethod method = ReferenceMethod::exact;
  ReferenceSurfaces surfaces = ReferenceSurfaces::automatic;
  double tolerance = 1e-4;  ///< of the exact one: ReferenceOptions
  int max_steps = 8192;
  int slices = 1024;  ///< of the method slices
  SlicesFormat format = SlicesFormat::half;
  /// Metrics are given also over the pixels whose luminance the shadows in the medium lower by more than this share
  /// (names with the suffix `_shadow`); 0: they are not.
  double shadow_share = 0;
  // For surfaces from rays: SurfaceOptions.
  int samples = 1;
  int reflections = SurfaceOptions{}.reflections;
  double cut = SurfaceOptions{}.cut;
  bool caustics = false;
  bool refract_light = false;
  int photons = static_cast<int>(SurfaceOptions{}.photons);

  bool operator==(const ReferenceSettings&) const = default;
};

const char* name(ReferenceMethod);
const char* name(ReferenceSurfaces);
const char* name(SlicesFormat);

/// The same with `surfaces` decided. InputError where the reference cannot be made so: what the forward pass does not
/// draw, a medium behind interfaces, samples of what is not traced.
ReferenceSettings settled(ReferenceSettings, const std::string& scene, bool has_interfaces, bool has_volume);

SurfaceOptions surface_options(const ReferenceSettings&);

/// All that determines the reference, for hashes, messages and files: equal settings give equal text.
nlohmann::json to_json(const ReferenceSettings&);
/// Throws nlohmann::json::exception for anything that to_json() did not make.
ReferenceSettings reference_settings(const nlohmann::json&);

}  // namespace pellucid::sweeps
