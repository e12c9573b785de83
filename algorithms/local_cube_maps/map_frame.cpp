#include "algorithms/local_cube_maps/map_frame.hpp"

#include <cstdio>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "algorithms/scene/files/tell.hpp"

namespace pellucid::local_cube_maps {

void MapFrame::prepare(const Scene& scene, const MapSettings& maps, const LookupSettings& lookup) {
  frame_.reset();
  objects_.prepare(scene, maps, lookup, technique_);
  for (const std::string& warning : objects_.warnings())
    tell("warning: {}", warning);
}

std::vector<std::size_t> MapFrame::draw_maps(const Scene& scene, ForwardPass& forward, gl::PassTimer& timer,
                                             const MapSettings& maps, const LookupSettings& lookup) {
  std::vector<std::size_t> due = objects_.due(scene, maps);
  if (due.empty()) return due;
  auto pass = timer.pass("cube maps");
  gl::PassTimer& cost = objects_.cost_timer();
  cost.begin_frame();
  objects_.draw_maps(scene, forward, maps, lookup, due);
  objects_.draw_mutual(scene, forward, maps, lookup, due);
  cost.end_frame();
  return due;
}

void MapFrame::draw_objects(const Scene& scene, const Camera& camera, ForwardPass& forward, const Target& target,
                            gl::PassTimer& timer, const MapSettings& maps, const LookupSettings& lookup) {
  auto pass = timer.pass("objects");
  objects_.draw(scene, forward, camera, target, maps, lookup);
  frame_ = Frame{&scene, &forward, camera, maps, lookup};
}

void MapFrame::native_errors(const std::vector<std::string>& further, nlohmann::json& out) const {
  const DynamicObjects::Cost& cost = objects_.cost();
  out["cube_refreshes"] = cost.refreshes;
  if (cost.timed > 0) {
    out["cube_ms"] = cost.total_ms / static_cast<double>(cost.timed);
    out["cube_ms_per_frame"] = cost.total_ms / static_cast<double>(cost.frames);
  }
  std::vector<std::string> warnings = objects_.warnings();
  warnings.insert(warnings.end(), further.begin(), further.end());
  if (!warnings.empty()) out["warnings"] = fmt::format("{}", fmt::join(warnings, "; "));
  if (frame_) hit_errors().write(out);
}

std::vector<NativeMap> MapFrame::native_maps() const {
  return frame_ ? hit_errors().maps() : std::vector<NativeMap>();
}

HitErrors MapFrame::hit_errors() const {
  return {objects_, *frame_->scene, *frame_->forward, frame_->camera, frame_->maps, frame_->lookup};
}

}  // namespace pellucid::local_cube_maps
