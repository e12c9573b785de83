// Distance impostors' frame with maps that were drawn once, and the same with a bare shader in place of the search.
#include "algorithms/distance_impostors/bench/bare_impostors.hpp"

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "algorithms/distance_impostors/distance_impostors.hpp"
#include "algorithms/local_cube_maps/dynamic_objects.hpp"
#include "algorithms/raster/forward_pass.hpp"
#include "gl/context.hpp"
#include "gl/error.hpp"

namespace pellucid::distance_impostors {
namespace {

using local_cube_maps::DynamicObjects;

constexpr const char* kName = "distance_impostors";

/// The scene's interface objects over the opaque ones, with the technique's shaders or the bare one.
struct ShadedObjects {
  ShadedObjects(const BareFrameRequest& request, ForwardPass& forward, const MapSettings& maps, LookupSettings settings,
                bool bare)
      : lookup(settings) {
    lookup.bare = bare;
    objects.prepare(request.scene, maps, lookup, kName);
    const std::vector<std::size_t> due = objects.due(request.scene, maps);
    objects.draw_maps(request.scene, forward, maps, lookup, due);
    objects.draw_mutual(request.scene, forward, maps, lookup, due);
  }

  LookupSettings lookup;
  DynamicObjects objects;
};

/// The bare shader makes as many fetches as a search at most.
class BareImpostors final : public BareFrame {
 public:
  explicit BareImpostors(const BareFrameRequest& request)
      : scene_(request.scene),
        camera_(request.camera),
        maps_(map_settings(parameters_of<Parameters>(request, kName))),
        shadow_(request.shadow),
        forward_(scene_),
        target_(camera_, request.format) {
    forward_.update_shadows(scene_, shadow_);
    const LookupSettings lookup = lookup_settings(parameters_of<Parameters>(request, kName));
    method_ = std::make_unique<ShadedObjects>(request, forward_, maps_, lookup, false);
    bare_ = std::make_unique<ShadedObjects>(request, forward_, maps_, lookup, true);
  }

  void render(gl::PassTimer& timer, Part part) override {
    timer.begin_frame();
    if (forward_.shadowed()) forward_.update_shadows(scene_, shadow_);
    target_.framebuffer.bind();
    forward_.draw_shaded(camera_, false);
    if (part != Part::shared) {
      ShadedObjects& shaded = part == Part::method ? *method_ : *bare_;
      shaded.objects.draw(scene_, forward_, camera_, target_.target(), maps_, shaded.lookup);
    }
    timer.end_frame();
    gl::check("bench", kName);
  }

  /// Over the pixels that show an object; the fetches are those of a mirror or metal.
  Counts counts() override {
    gl::PassTimer untimed;
    render(untimed, Part::shared);
    method_->objects.draw_surfaces(scene_, forward_, camera_, target_.target());
    GLuint query = 0;
    glCreateQueries(GL_SAMPLES_PASSED, 1, &query);
    glBeginQuery(GL_SAMPLES_PASSED, query);
    method_->objects.shade(scene_, camera_, target_.target(), maps_, method_->lookup);
    glEndQuery(GL_SAMPLES_PASSED);
    GLuint64 passed = 0;
    glGetQueryObjectui64v(query, GL_QUERY_RESULT, &passed);
    glDeleteQueries(1, &query);
    return {static_cast<double>(passed) / (static_cast<double>(camera_.width) * camera_.height),
            static_cast<double>(fetches(method_->lookup.search) + 1)};
  }

  /// As far as the frame follows light: into an object, `internal` times on inside, out, and on by the pictures of the
  /// other objects in its maps, each of which shows one object more.
  std::optional<SurfaceOptions> reference() const override {
    int objects = 0;
    bool solid = false;
    for (const Instance& instance : scene_.instances) {
      if (!optical(scene_, instance)) continue;
      ++objects;
      solid = solid || material_of(scene_, instance).kind == SurfaceKind::dielectric;
    }
    const LookupSettings& lookup = method_->lookup;
    SurfaceOptions options;
    options.both_sides = lookup.bounces > 1;
    options.reflections = options.both_sides ? lookup.internal : 0;
    const int of_one = solid && options.both_sides ? 2 + lookup.internal : 1;
    options.depth = of_one * (objects > 1 ? 1 + maps_.mutual : 1);
    return options;
  }

 private:
  const Scene& scene_;
  Camera camera_;
  MapSettings maps_;
  ShadowSettings shadow_;
  ForwardPass forward_;
  std::unique_ptr<ShadedObjects> method_, bare_;
  BareFrameTarget target_;
};

}  // namespace

const BareFrameInfo& bare_frame() {
  static constexpr BareFrameInfo kInfo{
      .technique = "distance_impostors",
      .scene = "mirror_room",
      .make = [](const BareFrameRequest& request) -> std::unique_ptr<BareFrame> {
        return std::make_unique<BareImpostors>(request);
      },
      .counts = [](const nlohmann::json& p) { return fmt::format("NITER {}", p.at("iterations").get<int>()); }};
  return kInfo;
}

}  // namespace pellucid::distance_impostors
