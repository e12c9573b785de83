#pragma once

#include <functional>
#include <map>
#include <string>

#include "algorithms/reference/reference.hpp"
#include "algorithms/render_session.hpp"
#include "sweeps/spec/reference_settings.hpp"

/// The ingredients of a reference besides the tracer: surfaces, the picture of many slices, the shadows' region. Needs
/// a current GL context where a session is drawn.
namespace pellucid::sweeps {

/// The session's scene again, to be changed or drawn another way: loaded from `scene` (a name or a file) with the
/// values of `parameters` whose names begin with "scene.".
Scene load_again(const std::string& scene, const std::map<std::string, Value>& parameters);

/// The surfaces as the settings, settled, ask for them; `progress` is told the share done of what is traced.
SurfaceLayer reference_surfaces(RenderSession&, const ReferenceSettings&,
                                const std::function<void(double)>& progress = {});

/// Imagire et al. 2007, Sec. 5: the picture of settings.slices slices in a frame of settings.format, RGBA. `parameters`
/// are those of the frame to be judged, of which the shadow maps' and the scene's count.
Image draw_slices(const std::string& scene, const std::map<std::string, Value>& parameters, const std::string& view,
                  int width, int height, const ReferenceSettings& settings);

/// The exact reference without any shadow in the medium; the surfaces keep theirs.
Reference trace_unshadowed(Scene scene, const Camera&, const SurfaceLayer&, const ReferenceOptions&);

/// 1 where the shadows in the medium take more than `share` of the pixel's luminance, else 0; one channel. Both images
/// are of the same surfaces.
Image shadow_mask(const Image& reference, const Image& unshadowed, double share);

}  // namespace pellucid::sweeps
