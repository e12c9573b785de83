#include "sweeps/measure/reference_methods.hpp"

#include <cassert>
#include <cstdint>
#include <string_view>

#include "algorithms/parameter_names.hpp"
#include "gl/timer.hpp"
#include "sweeps/metrics/pixels.hpp"

namespace pellucid::sweeps {

Scene load_again(const std::string& scene, const std::map<std::string, Value>& parameters) {
  Scene loaded = load_scene(scene);
  const ParameterRef table = loaded.parameters();
  for (const auto& [name, value] : parameters) {
    const ParameterName routed = route(name);
    if (routed.owner == ParameterOwner::scene) table.assign(routed.local, value, "scene " + loaded.name);
  }
  return loaded;
}

SurfaceLayer reference_surfaces(RenderSession& session, const ReferenceSettings& settings,
                                const std::function<void(double)>& progress) {
  assert(settings.surfaces != ReferenceSurfaces::automatic);
  if (settings.surfaces == ReferenceSurfaces::rays) {
    SurfaceOptions options = surface_options(settings);
    options.progress = progress;
    return trace_surfaces(session.scene(), session.camera(), options);
  }
  return session.raster_surfaces(settings.surfaces == ReferenceSurfaces::forward);
}

Image draw_slices(const std::string& scene, const std::map<std::string, Value>& parameters, const std::string& view,
                  int width, int height, const ReferenceSettings& settings) {
  RenderSession session(load_again(scene, parameters), "volume_slices", view, width, height);
  session.assign("slices", std::int64_t{settings.slices});
  session.assign("frame.format", std::string(name(settings.format)));
  for (const auto& [name, value] : parameters) {
    if (route(name).owner == ParameterOwner::shadow) session.assign(name, value);
  }
  gl::PassTimer untimed;
  session.render(untimed);
  return session.read_color();
}

Reference trace_unshadowed(Scene scene, const Camera& camera, const SurfaceLayer& surfaces,
                           const ReferenceOptions& options) {
  for (Light& light : scene.lights)
    light.casts_shadow = false;
  return render_reference(scene, camera, surfaces, options);
}

Image shadow_mask(const Image& reference, const Image& unshadowed, double share) {
  assert(reference.width == unshadowed.width && reference.height == unshadowed.height);
  Image mask(reference.width, reference.height, 1);
  const auto luminance = [](const Image& image, int x, int y) {
    const float* p = image.at(x, y);
    return rec709(double{channel(image, p, 0)}, double{channel(image, p, 1)}, double{channel(image, p, 2)});
  };
  for (int y = 0; y < mask.height; ++y) {
    for (int x = 0; x < mask.width; ++x) {
      const double lit = luminance(unshadowed, x, y);
      mask.at(x, y)[0] = lit - luminance(reference, x, y) > share * lit ? 1.0F : 0.0F;
    }
  }
  return mask;
}

}  // namespace pellucid::sweeps
