#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "algorithms/scene/toml/scene_description.hpp"

namespace pellucid {

namespace {

constexpr std::string_view kTime = "time_s";

ParameterInfo built_in_time() {
  ParameterInfo info;
  info.name = kTime;
  info.symbol = "t";
  info.cite = "scene file";
  info.doc = "time at which paths and rotations are evaluated";
  info.unit = "s";
  info.type = ValueType::real;
  info.min = 0;
  info.max = 3600;
  info.default_value = 0.0;
  return info;
}

void parse_numbers(TableReader& reader, ParameterInfo& info) {
  glm::dvec2 range{0.0};
  double otherwise = 0;
  constexpr NumberRange kAny{-1e12, 1e12};
  const bool whole = info.type == ValueType::integer;
  reader.pair("range", range, kAny, whole, Need::required);
  if (whole)
    reader.integer("default", otherwise, kAny, Need::required);
  else
    reader.number("default", otherwise, kAny, Need::required);
  if (!(range.x < range.y)) reader.fail("range", fmt::format("[{}, {}] is empty", range.x, range.y));
  if (otherwise < range.x || otherwise > range.y) {
    reader.fail("default", fmt::format("{} is out of its range [{}, {}]", otherwise, range.x, range.y));
  }
  info.min = range.x;
  info.max = range.y;
  if (whole)
    info.default_value = static_cast<std::int64_t>(std::llround(otherwise));
  else
    info.default_value = otherwise;
}

const DriveTarget& find_target(TableReader& reader, const std::string& wanted, FilePosition place,
                               const std::vector<DriveTarget>& targets) {
  std::vector<std::string> names;
  for (const DriveTarget& target : targets) {
    if (target.path == wanted) return target;
    names.push_back(target.path);
  }
  const std::string near = nearest_name(wanted, names);
  reader.fail(place, fmt::format("{}.drives: '{}' is nothing that can be driven{}", reader.path(), wanted,
                                 near.empty() ? "" : fmt::format("; did you mean '{}'?", near)));
}

bool needs_precomputation(const DriveTarget& target) {
  const auto heavy = [](const Affected& affected) {
    constexpr Part kHeavy[] = {Part::mesh,   Part::forest,     Part::relief_maps,
                               Part::voxels, Part::scattering, Part::transfer};
    return std::find(std::begin(kHeavy), std::end(kHeavy), affected.part) != std::end(kHeavy);
  };
  return heavy(target.affected) || std::any_of(target.also.begin(), target.also.end(), heavy);
}

}  // namespace

void parse_parameters(TableReader& root, SceneDescription& scene) {
  bool has_time = false;
  for (auto& [name, reader] : root.named_tables("parameters")) {
    ParameterDescription parameter;
    parameter.place = reader.place();
    ParameterInfo& info = parameter.info;
    const bool time = name == kTime;
    has_time = has_time || time;
    info.name = name;
    info.cite = "scene file";
    if (time) {
      info = built_in_time();  // the file may give its own default and range
      reader.text("doc", info.doc);
    } else {
      parameter.mode = static_cast<DriveMode>(reader.choice("mode", {"set", "scale", "add"}, 0));
      parameter.drives = reader.texts("drives", Need::required);
      if (parameter.drives.empty()) reader.fail("drives", "a parameter drives at least one target");
      for (const auto& [path, place] : parameter.drives) {
        const DriveTarget& target = find_target(reader, path, place, scene.targets);
        if (target.integer) info.type = ValueType::integer;
        if (target.integer && parameter.mode != DriveMode::set) {
          reader.fail(place,
                      fmt::format("{}.drives: {} is an integer, which a parameter can only set", reader.path(), path));
        }
        if (needs_precomputation(target)) info.when = Change::precompute;
      }
      reader.text("doc", info.doc, Need::required);
      reader.text("unit", info.unit);
      reader.text("symbol", info.symbol);
      reader.text("cite", info.cite);
    }
    parse_numbers(reader, info);
    if (time && info.min < 0) reader.fail("range", "time begins at 0");
    reader.finish();
    scene.parameters.push_back(std::move(parameter));
  }
  if (!has_time) {
    ParameterDescription time;
    time.info = built_in_time();
    scene.parameters.push_back(std::move(time));
  }
}

}  // namespace pellucid
