#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "algorithms/scene/toml/scene_description.hpp"

namespace pellucid {

std::optional<MotionPath> parse_path(TableReader& parent, std::string_view key) {
  std::optional<TableReader> reader = parent.table(key);
  if (!reader) return std::nullopt;
  reader->set_affected(std::nullopt);
  MotionPath path;
  path.interpolation =
      static_cast<MotionPath::Interpolation>(reader->choice("interpolation", {"linear", "catmull_rom"}, 0));
  reader->boolean("loop", path.loop);
  for (TableReader& keyframe : reader->tables("keyframes", Need::required)) {
    Keyframe& key_value = path.keyframes.emplace_back();
    keyframe.number("time_s", key_value.time_s, {0, 1e6}, Need::required);
    keyframe.vector("value", key_value.value, kCoordinate, Need::required);
    keyframe.finish();
    const std::size_t n = path.keyframes.size();
    if (n >= 2 && !(key_value.time_s > path.keyframes[n - 2].time_s)) {
      keyframe.fail("time_s", fmt::format("{} does not follow {}; times must rise", key_value.time_s,
                                          path.keyframes[n - 2].time_s));
    }
  }
  reader->finish();
  if (path.keyframes.size() < 2) reader->fail("keyframes", "a path has at least two keyframes");
  if (path.loop && path.keyframes.front().value != path.keyframes.back().value) {
    reader->fail("keyframes", "a path that loops must end at the value where it begins");
  }
  return path;
}

std::optional<Spin> parse_spin(TableReader& parent) {
  std::optional<TableReader> reader = parent.table("spin");
  if (!reader) return std::nullopt;
  reader->set_affected(std::nullopt);
  Spin spin;
  reader->vector("axis", spin.axis, kCoordinate);
  reader->number("deg_per_s", spin.deg_per_s, kAngleDeg, Need::required);
  reader->finish();
  if (glm::length(spin.axis) < 1e-9) reader->fail("axis", "an axis must not be zero");
  return spin;
}

void parse_position(TableReader& reader, const std::string& key, glm::dvec3& position, std::optional<MotionPath>& path,
                    Need need) {
  const std::string path_key = key + "_path";
  reader.exclude(path_key, key);
  path = parse_path(reader, path_key);
  if (!path) reader.vector(key, position, kCoordinate, need);
}

}  // namespace pellucid
