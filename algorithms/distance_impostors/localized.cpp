#include "algorithms/distance_impostors/localized.hpp"

#include <cstdio>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace pellucid::distance_impostors {

void Localized::prepare(const Scene& scene, const MapSettings& maps, const LookupSettings& lookup,
                        const CausticSettings& caustics) {
  frame_.reset();
  objects_.prepare(scene, maps, lookup, technique_);
  for (const std::string& warning : objects_.warnings())
    fmt::print(stderr, "warning: {}\n", warning);
  caustic_settings_ = caustics;
  caustics_.prepare(scene, caustics, maps, objects_);
}

void Localized::render(const Scene& scene, const Camera& camera, ForwardPass& forward, const Target& target,
                       gl::PassTimer& timer, const MapSettings& maps, const LookupSettings& lookup) {
  const std::vector<std::size_t> due = objects_.due(scene, maps);
  if (!due.empty()) {
    auto pass = timer.pass("cube maps");
    gl::PassTimer& cost = objects_.cost_timer();
    cost.begin_frame();
    objects_.draw_maps(scene, forward, maps, lookup, due);
    objects_.draw_mutual(scene, forward, maps, lookup, due);
    cost.end_frame();
  }
  if (caustic_settings_.enabled) {
    auto pass = timer.pass("caustics");
    caustics_.update(scene, forward, objects_, maps, lookup, due);
  }
  {
    auto pass = timer.pass("opaque");
    target.framebuffer.bind();
    forward.draw_shaded(camera, false);
    caustics_.draw(scene, camera);
  }
  {
    auto pass = timer.pass("objects");
    objects_.draw(scene, forward, camera, target, maps, lookup);
  }
  frame_ = Frame{&scene, &forward, camera, maps, lookup};
}

void Localized::native_errors(nlohmann::json& out) const {
  const DynamicObjects::Cost& cost = objects_.cost();
  out["cube_refreshes"] = cost.refreshes;
  if (cost.timed > 0) {
    const double each = cost.total_ms / static_cast<double>(cost.timed);
    out["cube_ms"] = each;
    out["cube_ms_per_frame"] = cost.total_ms / static_cast<double>(cost.frames);
  }
  std::vector<std::string> warnings = objects_.warnings();
  warnings.insert(warnings.end(), caustics_.warnings().begin(), caustics_.warnings().end());
  if (!warnings.empty()) out["warnings"] = fmt::format("{}", fmt::join(warnings, "; "));
  if (!frame_) return;
  if (caustic_settings_.enabled) compare_caustics(caustics_, *frame_->scene, out);
  hit_errors().write(out);
}

std::vector<NativeMap> Localized::native_maps() const {
  return frame_ ? hit_errors().maps() : std::vector<NativeMap>();
}

HitErrors Localized::hit_errors() const {
  return {objects_, *frame_->scene, *frame_->forward, frame_->camera, frame_->maps, frame_->lookup};
}

}  // namespace pellucid::distance_impostors
