#include "sweeps/spec/spec.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <utility>

#include <fmt/format.h>
#include <toml++/toml.h>

#include "algorithms/parameter_names.hpp"
#include "algorithms/render_session.hpp"
#include "algorithms/scene/view_text.hpp"
#include "gl/error.hpp"
#include "gl/resources/resources.hpp"
#include "sweeps/metrics/metrics.hpp"
#include "sweeps/spec/preview.hpp"
#include "sweeps/spec/spec_axes.hpp"
#include "sweeps/spec/spec_values.hpp"

namespace pellucid::sweeps {
namespace {

constexpr std::size_t kMaxSpecBytes = 1U << 20;
const std::vector<std::string> kDefaultMetrics{"mse", "rmse", "psnr", "ssim", "flip"};
constexpr std::string_view kPreview = "_preview";

void read_timing(TableReader& parent, TimingLimits& limits) {
  std::optional<TableReader> table = parent.table("timing");
  if (!table) return;
  table->boolean("enabled", limits.enabled);
  table->integer("min_samples", limits.min_samples, 1, 1'000'000);
  table->integer("max_samples", limits.max_samples, 1, 1'000'000);
  table->number("max_seconds", limits.max_seconds, {0.001, 86'400});
  table->number("relative_ci", limits.relative_ci, {1e-6, 1});
  if (limits.max_samples < limits.min_samples) {
    table->fail(table->place(table->has("max_samples") ? "max_samples" : "min_samples"),
                fmt::format("max_samples = {} is below min_samples = {}", limits.max_samples, limits.min_samples));
  }
  table->finish();
}

/// Sets `value` to the choice that the key names; leaves it when the key is absent.
template <class Enum>
void read_choice(TableReader& table, std::string_view key, std::initializer_list<std::string_view> names, Enum& value) {
  value = static_cast<Enum>(table.choice(key, names, static_cast<std::size_t>(value)));
}

void read_keep(TableReader& table, Keep& keep) {
  read_choice(table, "keep", {"nothing", "png", "exr"}, keep);
}

void read_reference(TableReader& parent, ReferenceSettings& settings) {
  std::optional<TableReader> table = parent.table("reference");
  if (!table) return;
  read_choice(*table, "method", {"exact", "slices"}, settings.method);
  read_choice(*table, "surfaces", {"automatic", "raster", "forward", "rays"}, settings.surfaces);
  read_choice(*table, "format", {"half", "single"}, settings.format);
  table->integer("slices", settings.slices, 1, 4096);
  for (const char* key : {"slices", "format"}) {
    if (table->has(key) && settings.method != ReferenceMethod::slices) {
      table->fail(table->place(key), fmt::format("{} is of method = \"slices\"; the exact reference has none", key));
    }
  }
  table->number("tolerance", settings.tolerance, {1e-9, 1});
  table->integer("max_steps", settings.max_steps, 64, 1'048'576);
  table->number("shadow_share", settings.shadow_share, {0, 0.99});
  table->integer("samples", settings.samples, 1, 65'536);
  table->integer("reflections", settings.reflections, 0, 1024);
  table->number("cut", settings.cut, {0, 1});
  table->boolean("caustics", settings.caustics);
  table->boolean("refract_light", settings.refract_light);
  table->integer("photons", settings.photons, 1024, 1 << 28);
  table->finish();
}

void read_metrics(TableReader& table, std::vector<std::string>& metrics) {
  const bool given = table.has("metrics");
  const std::vector<PlacedText> texts = distinct_texts(table, "metrics", Need::optional, true);
  if (!given) return;
  metrics.clear();
  const std::vector<std::string> known = metric_names();
  for (const PlacedText& metric : texts) {
    table.one_of(metric.at, "metric", metric.text, known);
    metrics.push_back(metric.text);
  }
  if (!metrics.empty()) metrics = MetricSet(metrics).names();
}

// A view's name, or a camera as text. That is checked as far as it goes without the scene's own numbers.
void read_view(const TableReader& table, const PlacedText& view, const std::string& scene,
               const std::vector<std::string>& names) {
  if (!is_view_text(view.text)) {
    table.one_of(view.at, fmt::format("view of scene {}", scene), view.text, names);
    return;
  }
  Scene stand_in;
  stand_in.name = scene;
  for (const std::string& name : names)
    stand_in.views.emplace_back().name = name;
  try {
    parse_view_text(view.text, stand_in);
  } catch (const InputError& e) {
    table.fail(view.at, e.what());
  }
}

/// A relative path of a scene file counts from the spec's folder.
std::string resolve_scene(const std::string& scene, const std::string& source) {
  const std::filesystem::path path(scene);
  if (!scene.ends_with(".toml") || path.is_absolute()) return scene;
  return (std::filesystem::path(source).parent_path() / path).lexically_normal().string();
}

void read_places(TableReader& table, const std::string& source, const KnownNames& known_names, RunBlock& block) {
  const auto known = [&](const PlacedText& name, const auto& look_up) {
    try {
      look_up();
    } catch (const InputError& e) {
      table.fail(name.at, e.what());
    }
  };
  for (const PlacedText& technique : distinct_texts(table, "techniques", Need::required)) {
    known(technique, [&] { known_names.technique_parameters(technique.text); });
    block.techniques.push_back(technique.text);
  }
  for (const PlacedText& scene : distinct_texts(table, "scenes", Need::required)) {
    const std::string resolved = resolve_scene(scene.text, source);
    known(scene, [&] { known_names.scene(resolved); });
    block.scenes.push_back(resolved);
  }
  for (const PlacedText& view : distinct_texts(table, "views")) {
    for (const std::string& scene : block.scenes)
      read_view(table, view, scene, known_names.scene(scene).views);
    block.views.push_back(view.text);
  }
  for (const PlacedText& size : distinct_texts(table, "sizes"))
    block.sizes.push_back(read_size(table, size));
  if (block.sizes.empty()) block.sizes.push_back({});
}

RunBlock read_block(TableReader& table, const std::string& source, const KnownNames& known_names,
                    const RunBlock& defaults) {
  RunBlock block = defaults;
  block.at = table.place();
  block.name = identifier(table, "name");
  read_places(table, source, known_names, block);
  read_timing(table, block.timing);
  read_reference(table, block.reference);
  read_metrics(table, block.metrics);
  read_axes(table, known_names, block);
  read_keep(table, block.keep);
  for (const PlacedText& text : distinct_texts(table, "constraints", Need::optional, true))
    block.constraints.push_back({text.text, text.at});
  table.boolean("baseline", block.baseline);
  table.finish();
  if (block.baseline && !block.timing.enabled) {
    table.fail(table.place("baseline"), "the baseline is re-measured for its time; its block needs timing");
  }
  if (!block.timing.enabled && block.metrics.empty()) {
    table.fail(block.at, fmt::format("block '{}' has neither timing nor metrics: nothing to measure", block.name));
  }
  return block;
}

/// Name and resource of each spec that a technique's folder holds, sorted by name.
std::map<std::string, std::string> embedded_specs() {
  std::map<std::string, std::string> found;
  for (const std::string& resource : list_resources("algorithms/", ".toml")) {
    const std::filesystem::path path(resource);
    if (path.parent_path().filename() == "sweeps") found.emplace(path.stem().string(), resource);
  }
  return found;
}

Spec read_spec(const TomlFile& file, const toml::table& tree, const KnownNames& known_names) {
  Spec spec;
  spec.source = file.shown;
  TableReader root(file, tree);
  spec.name = identifier(root, "name");
  root.text("title", spec.title);
  root.text("description", spec.description);
  root.number("timeout_s", spec.timeout_s, {0.1, 86'400});

  RunBlock defaults;
  defaults.metrics = MetricSet(kDefaultMetrics).names();
  read_metrics(root, defaults.metrics);
  read_keep(root, defaults.keep);
  read_timing(root, defaults.timing);
  read_reference(root, defaults.reference);

  std::vector<TableReader> tables = root.tables("run");
  root.finish();
  if (tables.empty()) root.fail(root.place(), "the spec has no [[run]] block");
  for (TableReader& table : tables) {
    RunBlock block = read_block(table, file.shown, known_names, defaults);
    for (const RunBlock& other : spec.blocks) {
      if (other.name == block.name)
        table.fail(table.place("name"), fmt::format("a second block named '{}'", block.name));
      if (other.baseline && block.baseline)
        table.fail(table.place("baseline"), fmt::format("block '{}' is the baseline already", other.name));
    }
    spec.blocks.push_back(std::move(block));
  }
  return spec;
}

}  // namespace

Spec parse_spec(std::string_view text, const std::string& source, const KnownNames& known_names, Extent extent) {
  if (text.size() > kMaxSpecBytes) throw InputError(fmt::format("{}: a spec may have {} bytes", source, kMaxSpecBytes));
  const TomlFile file{source};
  const auto parse = [&] { return std::move(*parse_toml(text, file)); };
  toml::table root = parse();
  Spec spec;
  if (extent == Extent::preview) {
    spec = read_spec(file, preview_of(file, parse), known_names);  // alone: the full spec may need assets
  } else {
    // A mistake in the preview shows at once, too.
    if (root.contains("preview")) read_spec(file, preview_of(file, parse), known_names);
    root.erase("preview");
    spec = read_spec(file, root, known_names);
  }
  spec.text = text;
  return spec;
}

Spec load_spec(const std::string& path_or_name, const KnownNames& known_names, Extent extent) {
  if (!path_or_name.ends_with(".toml")) {
    const bool named_preview = path_or_name.ends_with(kPreview);
    const std::string_view base =
        std::string_view(path_or_name).substr(0, path_or_name.size() - (named_preview ? kPreview.size() : 0));
    for (const auto& [name, resource] : embedded_specs()) {
      if (name == path_or_name) return parse_spec(*find_resource(resource), resource, known_names, extent);
      if (named_preview && name == base) {
        return parse_spec(*find_resource(resource), resource, known_names, Extent::preview);
      }
    }
    const std::vector<std::string> names = list_specs();
    const std::string near = nearest_name(path_or_name, names);
    throw InputError(fmt::format("no spec named '{}'; {} (a file's name ends in .toml)", path_or_name,
                                 near.empty() ? fmt::format("built in are: {}", fmt::join(names, ", "))
                                              : fmt::format("did you mean '{}'?", near)));
  }
  return parse_spec(read_toml_text(path_or_name, "spec", kMaxSpecBytes), path_or_name, known_names, extent);
}

std::vector<std::string> list_specs() {
  std::vector<std::string> names;
  for (const auto& [name, resource] : embedded_specs()) {
    names.push_back(name);
    if (parse_toml(*find_resource(resource), {resource})->contains("preview"))
      names.push_back(name + std::string(kPreview));
  }
  return names;
}

}  // namespace pellucid::sweeps
