#pragma once

#include <nlohmann/json_fwd.hpp>

namespace pellucid::sweeps {

/// What frames are compared with: the medium integrated in float64 (algorithms/reference), or the picture that Imagire
/// et al. 2007, Sec. 5, judge by: very many slices, drawn as the baseline draws them.
enum class ReferenceMethod { exact, slices };

/// Where the opaque surfaces of the exact reference come from: the forward pass's geometry with exact shadows, the same
/// with the shadow maps of the frame, or rays.
enum class ReferenceSurfaces { raster, forward, rays };

/// Bits of a colour channel that the slices blend into.
enum class SlicesFormat { half, single };

/// A spec's `[reference]`.
struct ReferenceSettings {
  ReferenceMethod method = ReferenceMethod::exact;
  ReferenceSurfaces surfaces = ReferenceSurfaces::raster;
  double tolerance = 1e-4;  ///< of the exact one: ReferenceOptions
  int max_steps = 8192;
  int slices = 1024;  ///< of the method slices
  SlicesFormat format = SlicesFormat::half;
  /// Metrics are given also over the pixels whose luminance the shadows in the medium lower by more than this share
  /// (names with the suffix `_shadow`); 0: they are not.
  double shadow_share = 0;

  bool operator==(const ReferenceSettings&) const = default;
};

const char* name(ReferenceMethod);
const char* name(ReferenceSurfaces);
const char* name(SlicesFormat);

/// All that determines the reference, for hashes, messages and files: equal settings give equal text.
nlohmann::json to_json(const ReferenceSettings&);
/// Throws nlohmann::json::exception for anything that to_json() did not make.
ReferenceSettings reference_settings(const nlohmann::json&);

}  // namespace pellucid::sweeps
