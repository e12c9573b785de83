// pellucid list, describe, devices.
#include <algorithm>
#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "algorithms/scene/loading_facts.hpp"
#include "algorithms/scene/scene.hpp"
#include "algorithms/technique.hpp"
#include "gl/context.hpp"
#include "gl/devices/device_node.hpp"
#include "sandbox/commands/commands.hpp"
#include "sandbox/commands/scene_facts.hpp"
#include "sandbox/viewer/state/parameter_json.hpp"
#include "sweeps/papers/paper.hpp"
#include "sweeps/quantities/quantities.hpp"

namespace pellucid::sandbox {
namespace {

using nlohmann::ordered_json;

ordered_json techniques_json() {
  ordered_json out = ordered_json::array();
  for (const TechniqueInfo& t : techniques()) {
    out.push_back({{"name", t.name},
                   {"title", t.title},
                   {"reference", t.citation},
                   {"baseline", t.baseline},
                   {"interfaces", t.interfaces},
                   {"reliefs", t.reliefs},
                   {"maps", t.maps},
                   {"doc", t.doc}});
  }
  return out;
}

ordered_json scenes_json() {
  ordered_json out = ordered_json::array();
  for (const SceneInfo& s : list_scenes()) {
    out.push_back({{"name", s.name}, {"title", s.title}, {"description", s.description}, {"module", s.module}});
  }
  return out;
}

ordered_json papers_json() {
  ordered_json out = ordered_json::array();
  for (const sweeps::PaperPointer& paper : sweeps::papers())
    out.push_back({{"name", paper->name}, {"title", paper->title}});
  return out;
}

ordered_json quantity_json(const sweeps::Quantity& q) {
  ordered_json out{{"name", q.name},
                   {"label", q.label},
                   {"heading", q.heading},
                   {"unit", q.unit},
                   {"type", q.text ? "text" : "number"},
                   {"digits", q.digits},
                   {"better", sweeps::name(q.better)}};
  if (!q.low.empty()) out["bounds"] = {q.low, q.high};
  if (!q.interval.empty()) out["interval"] = q.interval;
  if (!q.module.empty()) out["module"] = q.module;
  out["doc"] = q.doc;
  return out;
}

ordered_json quantities_json() {
  ordered_json out = ordered_json::array();
  for (const sweeps::Quantity& q : sweeps::quantities())
    out.push_back(quantity_json(q));
  return out;
}

void print_rows(std::string_view heading, const ordered_json& rows, const char* text_field) {
  std::size_t width = 20;
  for (const auto& row : rows)
    width = std::max(width, row.at("name").get<std::string>().size());
  fmt::print("{}\n", heading);
  for (const auto& row : rows)
    fmt::print("  {:<{}} {}\n", row.at("name").get<std::string>(), width, row.at(text_field).get<std::string>());
}

int list(const std::string& what, bool json) {
  ordered_json all;
  if (what.empty() || what == "techniques") all["techniques"] = techniques_json();
  if (what.empty() || what == "scenes") all["scenes"] = scenes_json();
  if (what.empty() || what == "papers") all["papers"] = papers_json();
  if (what == "quantities") all["quantities"] = quantities_json();
  if (json) {
    fmt::print("{}\n", (what.empty() ? all : all[what]).dump(2));
    return kDone;
  }
  if (all.contains("techniques")) print_rows("techniques", all["techniques"], "doc");
  if (all.contains("scenes")) print_rows("scenes", all["scenes"], "title");
  if (all.contains("papers")) print_rows("papers", all["papers"], "title");
  if (all.contains("quantities")) print_rows("quantities", all["quantities"], "doc");
  return kDone;
}

std::string range_text(const ParameterInfo& p) {
  switch (p.type) {
    case ValueType::boolean:
      return "true|false";
    case ValueType::choice:
      return fmt::format("{}", fmt::join(p.choices, "|"));
    case ValueType::integer:
    case ValueType::real:
      return fmt::format("[{}, {}]{}{}", p.min, p.max, p.unit.empty() ? "" : " ", p.unit);
  }
  return "";
}

void print_parameters(std::span<const ParameterInfo> infos) {
  std::size_t width = 14;
  for (const ParameterInfo& p : infos)
    width = std::max(width, p.name.size());
  for (const ParameterInfo& p : infos) {
    fmt::print("  {:<{}} {}{}\n", p.name, width, p.symbol.empty() ? "" : p.symbol + ": ", p.doc);
    fmt::print("  {:<{}}   {} in {} (default: {}); {}; a change costs: {}\n", "", width, name(p.type), range_text(p),
               to_text(p.default_value), p.cite, name(p.when));
  }
}

int describe_quantity(const sweeps::Quantity& q, bool json) {
  if (json) {
    fmt::print("{}\n", quantity_json(q).dump(2));
    return kDone;
  }
  fmt::print("{}: {}\n{}\n", q.name, q.label, q.doc);
  if (q.text) {
    fmt::print("text\n");
    return kDone;
  }
  fmt::print("unit: {}; {} significant digits; better: {}\n", q.unit.empty() ? "none" : q.unit, q.digits,
             sweeps::name(q.better));
  if (!q.low.empty()) fmt::print("{}: {} to {}\n", q.interval, q.low, q.high);
  if (!q.module.empty()) fmt::print("declared by: {}\n", q.module);
  return kDone;
}

// A technique, a scene or a quantity by its name; of the first two the parameters are shown.
int describe(const std::string& wanted, bool json) {
  const auto scenes = list_scenes();
  const auto scene = std::find_if(scenes.begin(), scenes.end(), [&](const SceneInfo& s) { return s.name == wanted; });
  if (scene != scenes.end() || wanted.ends_with(".toml")) {
    Scene loaded = load_scene(wanted);
    print_warnings(loaded);
    if (json) {
      ordered_json views = ordered_json::array();
      for (const View& v : loaded.views)
        views.push_back(v.name);
      fmt::print("{}\n", ordered_json{{"name", loaded.name},
                                      {"title", loaded.title},
                                      {"description", loaded.description},
                                      {"stand_in", loaded.stand_in},
                                      {"views", views},
                                      {"volume", volume_json(loaded)},
                                      {"warnings", loading_facts(loaded).warnings},
                                      {"parameters", parameters_json(loaded.parameters().infos())}}
                             .dump(2));
      return kDone;
    }
    fmt::print("{}: {}\n{}\n", loaded.name, loaded.title, loaded.description);
    if (!loaded.stand_in.empty()) fmt::print("stands in: {}\n", loaded.stand_in);
    if (loaded.volume) fmt::print("volume: {}\n", volume_text(loaded));
    fmt::print("views:");
    for (const View& v : loaded.views)
      fmt::print(" {}", v.name);
    fmt::print("\nparameters (with the prefix scene.)\n");
    print_parameters(loaded.parameters().infos());
    return kDone;
  }
  const auto all = techniques();
  const bool technique_named =
      std::any_of(all.begin(), all.end(), [&](const TechniqueInfo& info) { return info.name == wanted; });
  const sweeps::Quantity* quantity = technique_named ? nullptr : sweeps::find_quantity(wanted);
  if (quantity != nullptr) return describe_quantity(*quantity, json);
  const TechniqueInfo& technique = find_technique(wanted);
  if (json) {
    fmt::print("{}\n", ordered_json{{"name", technique.name},
                                    {"title", technique.title},
                                    {"reference", technique.citation},
                                    {"baseline", technique.baseline},
                                    {"doc", technique.doc},
                                    {"parameters", parameters_json(technique.table().infos())}}
                           .dump(2));
    return kDone;
  }
  fmt::print("{}: {} ({})\n{}\nparameters\n", technique.name, technique.title, technique.citation, technique.doc);
  print_parameters(technique.table().infos());
  return kDone;
}

int devices(bool json) {
  const std::vector<gl::Device> found = gl::list_devices();
  if (json) {
    ordered_json out = ordered_json::array();
    for (const gl::Device& d : found) {
      out.push_back({{"index", d.index < 0 ? ordered_json() : ordered_json(d.index)},
                     {"platform", d.platform},
                     {"vendor", d.vendor},
                     {"renderer", d.renderer},
                     {"version", d.version},
                     {"node", gl::device_node(d.index)}});
    }
    fmt::print("{}\n", out.dump(2));
  } else {
    for (const gl::Device& d : found) {
      const std::string node = gl::device_node(d.index);
      fmt::print("{:>12}  {}, {}, OpenGL {}{}\n", d.index < 0 ? d.platform : fmt::format("--device {}", d.index),
                 d.vendor, d.renderer, d.version, node.empty() ? "" : ", " + node);
    }
  }
  if (found.empty()) throw RuntimeError("no EGL device or platform gives an OpenGL 4.5 core context");
  return kDone;
}

}  // namespace

void add_list(cli::App& root, std::vector<Command>& commands) {
  struct Options {
    std::string what;
    bool json = false;
  };
  auto options = std::make_shared<Options>();

  cli::App* list_app = root.add_subcommand("list", "List techniques, scenes, papers and quantities");
  list_app->add_option("what", options->what, "techniques, scenes, papers or quantities; the first three without it")
      ->check(cli::IsMember({"techniques", "scenes", "papers", "quantities"}));
  list_app->add_flag("--json", options->json, "Print JSON");
  list_app->footer("Example: pellucid list scenes");
  commands.push_back({list_app, [options] { return list(options->what, options->json); }});

  cli::App* describe_app =
      root.add_subcommand("describe", "Show the parameters of a technique or a scene, or explain a quantity");
  describe_app->add_option("name", options->what, "A technique, a scene or a quantity")->required();
  describe_app->add_flag("--json", options->json, "Print JSON");
  describe_app->footer("Examples:\n  pellucid describe volume_slices\n  pellucid describe flip_mean");
  commands.push_back({describe_app, [options] { return describe(options->what, options->json); }});

  cli::App* devices_app = root.add_subcommand("devices", "List the devices that can render");
  devices_app->add_flag("--json", options->json, "Print JSON");
  devices_app->footer(
      "Example: pellucid devices --json\nThe number is what --device takes; without it the first device is used.");
  commands.push_back({devices_app, [options] { return devices(options->json); }});
}

}  // namespace pellucid::sandbox
