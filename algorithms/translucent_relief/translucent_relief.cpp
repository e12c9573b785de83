// Timonen (references.bib: timonen): Real-time rendering of translucent volumetric surfaces.
#include "algorithms/translucent_relief/translucent_relief.hpp"

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "algorithms/raster/forward_pass.hpp"
#include "algorithms/translucent_relief/bloom.hpp"
#include "algorithms/translucent_relief/relief_pass.hpp"

namespace pellucid::translucent_relief {
namespace {

class TranslucentRelief final : public Technique {
 public:
  ParameterRef parameters() override { return bind_parameters(parameters_); }

  void prepare(const Scene& scene) override {
    frame_.reset();
    pass_.prepare(scene);
  }

  void render(const Scene& scene, const Camera& camera, ForwardPass& forward, const Target& target,
              gl::PassTimer& timer) override {
    pass_.update(scene, forward);
    {
      auto pass = timer.pass("opaque");
      target.framebuffer.bind();
      forward.draw_opaque(camera, false);
    }
    {
      auto pass = timer.pass("relief");
      pass_.draw(scene, camera, forward, target);
    }
    {
      auto pass = timer.pass("background");
      forward.draw_background(camera);
    }
    if (parameters_.bloom > 0.0F) {
      auto pass = timer.pass("bloom");
      bloom_.add(target, {parameters_.bloom, parameters_.bloom_threshold, parameters_.bloom_downsampling,
                          parameters_.bloom_sigma});
    } else {
      bloom_ = {};
    }
    frame_ = Frame{&scene, &forward, camera};
  }

  void native_errors(nlohmann::json& out) const override {
    if (frame_) pass_.compare_searches(*frame_->scene, frame_->camera, *frame_->forward).write(out);
  }
  std::vector<NativeMap> native_maps() const override {
    if (!frame_) return {};
    return pass_.compare_searches(*frame_->scene, frame_->camera, *frame_->forward).maps();
  }

  std::string reload_shaders() override { return pass_.reload_shaders() + bloom_.reload_shaders(); }

 private:
  struct Frame {
    const Scene* scene;
    const ForwardPass* forward;
    Camera camera;
  };

  Parameters parameters_;
  ReliefPass pass_{parameters_};
  Bloom bloom_;
  std::optional<Frame> frame_;
};

}  // namespace

const ParameterTable& table() {
  return parameter_table<Parameters>();
}
std::unique_ptr<Technique> make() {
  return std::make_unique<TranslucentRelief>();
}

}  // namespace pellucid::translucent_relief
