// Chan and Wang 2005 (references.bib: chan2005), Sec. 2: the transparency shader.
#include "algorithms/geocube/geocube.hpp"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "algorithms/geocube/glass_pass.hpp"
#include "algorithms/raster/environment_alone.hpp"
#include "algorithms/raster/forward_pass.hpp"

namespace pellucid::geocube {
namespace {

class Geocube final : public Technique {
 public:
  ParameterRef parameters() override { return bind_parameters(parameters_); }

  void prepare(const Scene& scene) override {
    warn_of_black_environment(scene, "geocube");
    frame_.reset();
    pass_.prepare(scene);
  }

  void render(const Scene& scene, const Camera& camera, ForwardPass& forward, const Target& target,
              gl::PassTimer& timer) override {
    pass_.draw_entries(scene, camera, forward, target, timer);
    auto pass = timer.pass("glass");
    pass_.draw_glass(scene, camera, target);
    frame_ = Frame{&scene, camera};
  }

  void native_errors(nlohmann::json& out) const override {
    double built_s = 0, unseen = 0, dropped = 0;
    std::size_t cubes = 0, bytes = 0, triangles = 0;
    for (const GlassObject& object : pass_.objects()) {
      if (object.cubes() == nullptr) continue;
      const CubeSet& set = object.cubes()->set();
      built_s += set.build_s;
      cubes += set.cubes.size();
      triangles += object.triangle_count();
      bytes += texture_bytes(set.options, set.cubes.size());
      unseen = std::max(unseen, set.unseen_share);
      for (const Cube& cube : set.cubes)
        dropped = std::max(dropped, cube.dropped_share);
    }
    if (cubes == 0) return;
    out["precomputation_s"] = built_s;  // of the run that filled the cache, if it was cached
    out["cubes_placed"] = cubes;
    out["object_triangles"] = triangles;
    out["cube_bytes"] = bytes;
    if (pass_.translucency().bytes() > 0) {
      out["key_map_bytes"] = pass_.translucency().bytes();
      out["key_map_full_bytes"] = pass_.translucency().full_resolution_bytes();
      out["key_map_filter_s"] = pass_.translucency().filter_s();
      for (const int factor : {2, 4, 8, 16, 32, 64})
        out[fmt::format("key_width_{}_texels", factor)] =
            scattering::least_width(factor, static_cast<double>(parameters_.omega));
    }
    out["unseen_share"] = unseen;
    out["dropped_share"] = dropped;
    if (frame_) pass_.compare_searches(*frame_->scene, frame_->camera).write(out);
  }

  std::vector<NativeMap> native_maps() const override {
    return frame_ ? pass_.compare_searches(*frame_->scene, frame_->camera).maps() : std::vector<NativeMap>();
  }

  std::string reload_shaders() override { return pass_.reload_shaders(); }

 private:
  struct Frame {
    const Scene* scene;
    Camera camera;
  };

  Parameters parameters_;
  GlassPass pass_{parameters_};
  std::optional<Frame> frame_;
};

}  // namespace

const ParameterTable& table() {
  return parameter_table<Parameters>();
}
std::unique_ptr<Technique> make() {
  return std::make_unique<Geocube>();
}

}  // namespace pellucid::geocube
