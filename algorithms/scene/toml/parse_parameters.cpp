#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <toml++/toml.h>

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

constexpr NumberRange kAnyNumber{-1e12, 1e12};

void parse_range(TableReader& reader, ParameterInfo& info) {
  glm::dvec2 range{0.0};
  reader.pair("range", range, kAnyNumber, info.type == ValueType::integer, Need::required);
  if (!(range.x < range.y)) reader.fail("range", fmt::format("[{}, {}] is empty", range.x, range.y));
  info.min = range.x;
  info.max = range.y;
}

void set_default(TableReader& reader, ParameterInfo& info, double otherwise) {
  if (otherwise < info.min || otherwise > info.max)
    reader.fail("default", fmt::format("{} is out of its range [{}, {}]", otherwise, info.min, info.max));
  if (info.type == ValueType::integer)
    info.default_value = static_cast<std::int64_t>(std::llround(otherwise));
  else
    info.default_value = otherwise;
}

void parse_numbers(TableReader& reader, ParameterInfo& info) {
  double otherwise = 0;
  parse_range(reader, info);
  if (info.type == ValueType::integer)
    reader.integer("default", otherwise, kAnyNumber, Need::required);
  else
    reader.number("default", otherwise, kAnyNumber, Need::required);
  set_default(reader, info, otherwise);
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

void parse_words(TableReader& reader, ParameterInfo& info) {
  reader.text("doc", info.doc, Need::required);
  reader.text("unit", info.unit);
  reader.text("symbol", info.symbol);
  reader.text("cite", info.cite);
}

void parse_drives(TableReader& reader, ParameterDescription& parameter, const std::vector<DriveTarget>& targets) {
  ParameterInfo& info = parameter.info;
  parameter.mode = static_cast<DriveMode>(reader.choice("mode", {"set", "scale", "add"}, 0));
  parameter.drives = reader.texts("drives", Need::required);
  if (parameter.drives.empty()) reader.fail("drives", "a parameter drives at least one target");
  for (const auto& [path, place] : parameter.drives) {
    const DriveTarget& target = find_target(reader, path, place, targets);
    if (target.integer) info.type = ValueType::integer;
    if (target.integer && parameter.mode != DriveMode::set) {
      reader.fail(place,
                  fmt::format("{}.drives: {} is an integer, which a parameter can only set", reader.path(), path));
    }
    if (needs_precomputation(target)) info.when = Change::precompute;
  }
}

// A default [r, g, b] makes three parameters, each of one channel of the colours that are driven.
std::vector<ParameterDescription> channels_of(TableReader& reader, const ParameterDescription& all,
                                              const std::vector<DriveTarget>& targets) {
  glm::dvec3 otherwise{0.0};
  reader.color("default", otherwise, kAnyNumber, Need::required);
  std::vector<ParameterDescription> out;
  for (int c = 0; c < 3; ++c) {
    constexpr const char* kNames[] = {"red", "green", "blue"};
    ParameterDescription& channel = out.emplace_back(all);
    channel.info.name += fmt::format("_{}", kNames[c]);
    channel.info.doc += fmt::format(", {}", kNames[c]);
    set_default(reader, channel.info, otherwise[c]);
    for (auto& [path, place] : channel.drives) {
      const std::string of_channel = fmt::format("{}.{}", path, "rgb"[c]);
      const bool known = std::any_of(targets.begin(), targets.end(),
                                     [&](const DriveTarget& target) { return target.path == of_channel; });
      if (!known)
        reader.fail(place, fmt::format("{}.drives: {} is no colour, and the default is one", reader.path(), path));
      path = of_channel;
    }
  }
  return out;
}

}  // namespace

void parse_parameters(TableReader& root, SceneDescription& scene) {
  bool has_time = false;
  std::vector<std::string> known;
  for (auto& [name, reader] : root.named_tables("parameters")) {
    ParameterDescription parameter;
    parameter.place = reader.place();
    ParameterInfo& info = parameter.info;
    const bool time = name == kTime;
    has_time = has_time || time;
    info.name = name;
    info.cite = "scene file";
    const toml::node* otherwise = time ? nullptr : reader.node("default");
    const bool color = otherwise != nullptr && otherwise->is_array();
    if (time) {
      info = built_in_time();  // the file may give its own default and range
      reader.text("doc", info.doc);
    } else {
      parse_drives(reader, parameter, scene.targets);
      parse_words(reader, info);
    }
    std::vector<ParameterDescription> made;
    if (color) {
      parse_range(reader, info);
      made = channels_of(reader, parameter, scene.targets);
    } else {
      parse_numbers(reader, info);
      made = {parameter};
    }
    if (time && info.min < 0) reader.fail("range", "time begins at 0");
    reader.finish();
    for (ParameterDescription& one : made) {
      if (std::find(known.begin(), known.end(), one.info.name) != known.end())
        reader.fail(reader.place(), fmt::format("{}: there are two parameters '{}'", reader.path(), one.info.name));
      known.push_back(one.info.name);
      scene.parameters.push_back(std::move(one));
    }
  }
  if (!has_time) {
    ParameterDescription time;
    time.info = built_in_time();
    scene.parameters.push_back(std::move(time));
  }
}

}  // namespace pellucid
