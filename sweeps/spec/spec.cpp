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
#include "sweeps/spec/spec_reader.hpp"

namespace pellucid::sweeps {
namespace {

constexpr std::size_t kMaxSpecBytes = 1U << 20;
const std::vector<std::string> kDefaultMetrics{"mse", "rmse", "psnr", "ssim", "flip"};
constexpr std::string_view kPreview = "_preview";

void read_timing(const SpecReader& read, const toml::table& parent, TimingLimits& limits) {
  const toml::table* table = read.table(parent, "timing");
  if (table == nullptr) return;
  read.allow(*table, {"enabled", "min_samples", "max_samples", "max_seconds", "relative_ci"}, "timing");
  read.boolean(*table, "enabled", limits.enabled);
  read.integer(*table, "min_samples", 1, 1'000'000, limits.min_samples);
  read.integer(*table, "max_samples", 1, 1'000'000, limits.max_samples);
  read.real(*table, "max_seconds", 0.001, 86'400, limits.max_seconds);
  read.real(*table, "relative_ci", 1e-6, 1, limits.relative_ci);
  if (limits.max_samples < limits.min_samples) {
    const char* key = table->contains("max_samples") ? "max_samples" : "min_samples";
    read.fail(*table->get(key),
              fmt::format("max_samples = {} is below min_samples = {}", limits.max_samples, limits.min_samples));
  }
}

void read_reference(const SpecReader& read, const toml::table& parent, ReferenceSettings& settings) {
  const toml::table* table = read.table(parent, "reference");
  if (table == nullptr) return;
  read.allow(*table,
             {"method", "slices", "format", "surfaces", "tolerance", "max_steps", "shadow_share", "samples",
              "reflections", "cut", "caustics", "refract_light", "photons"},
             "reference");
  std::string text;
  if (read.text(*table, "method", text)) {
    read.one_of(*table->get("method"), text, {"exact", "slices"}, "method");
    settings.method = text == "exact" ? ReferenceMethod::exact : ReferenceMethod::slices;
  }
  if (read.text(*table, "surfaces", text)) {
    read.one_of(*table->get("surfaces"), text, {"automatic", "raster", "forward", "rays"}, "surfaces");
    settings.surfaces = text == "automatic" ? ReferenceSurfaces::automatic
                        : text == "raster"  ? ReferenceSurfaces::raster
                        : text == "forward" ? ReferenceSurfaces::forward
                                            : ReferenceSurfaces::rays;
  }
  if (read.text(*table, "format", text)) {
    read.one_of(*table->get("format"), text, {"half", "single"}, "format");
    settings.format = text == "half" ? SlicesFormat::half : SlicesFormat::single;
  }
  read.integer(*table, "slices", 1, 4096, settings.slices);
  for (const char* key : {"slices", "format"}) {
    if (table->contains(key) && settings.method != ReferenceMethod::slices) {
      read.fail(*table->get(key), fmt::format("{} is of method = \"slices\"; the exact reference has none", key));
    }
  }
  read.real(*table, "tolerance", 1e-9, 1, settings.tolerance);
  read.integer(*table, "max_steps", 64, 1'048'576, settings.max_steps);
  read.real(*table, "shadow_share", 0, 0.99, settings.shadow_share);
  read.integer(*table, "samples", 1, 65'536, settings.samples);
  read.integer(*table, "reflections", 0, 1024, settings.reflections);
  read.real(*table, "cut", 0, 1, settings.cut);
  read.boolean(*table, "caustics", settings.caustics);
  read.boolean(*table, "refract_light", settings.refract_light);
  read.integer(*table, "photons", 1024, 1 << 28, settings.photons);
}

void read_metrics(const SpecReader& read, const toml::table& table, std::vector<std::string>& metrics) {
  if (!table.contains("metrics")) return;
  metrics.clear();
  const std::vector<std::string> known = metric_names();
  for (const SpecReader::Text& metric : read.texts(table, "metrics", true)) {
    read.one_of(*metric.node, metric.value, known, "metric");
    metrics.push_back(metric.value);
  }
  if (!metrics.empty()) metrics = MetricSet(metrics).names();
}

void read_keep(const SpecReader& read, const toml::table& table, Keep& keep) {
  std::string text;
  if (!read.text(table, "keep", text)) return;
  read.one_of(*table.get("keep"), text, {"nothing", "png", "exr"}, "keep");
  keep = text == "png" ? Keep::png : text == "exr" ? Keep::exr : Keep::nothing;
}

// A view's name, or a camera as text. That is checked as far as it goes without the scene's own numbers.
void read_view(const SpecReader& read, const SpecReader::Text& view, const std::string& scene,
               const std::vector<std::string>& names) {
  if (!is_view_text(view.value)) {
    read.one_of(*view.node, view.value, names, fmt::format("view of scene {}", scene));
    return;
  }
  Scene stand_in;
  stand_in.name = scene;
  for (const std::string& name : names)
    stand_in.views.emplace_back().name = name;
  read.at(*view.node, [&] { parse_view_text(view.value, stand_in); });
}

void read_places(const SpecReader& read, const toml::table& table, const Catalogue& catalogue, RunBlock& block) {
  for (const SpecReader::Text& technique : read.required_texts(table, "techniques", block.at)) {
    read.at(*technique.node, [&] { catalogue.technique_parameters(technique.value); });
    block.techniques.push_back(technique.value);
  }
  for (const SpecReader::Text& scene : read.required_texts(table, "scenes", block.at)) {
    const std::string resolved = read.resolve_scene(scene.value);
    read.at(*scene.node, [&] { catalogue.scene(resolved); });
    block.scenes.push_back(resolved);
  }
  for (const SpecReader::Text& view : read.texts(table, "views", false)) {
    for (const std::string& scene : block.scenes)
      read_view(read, view, scene, catalogue.scene(scene).views);
    block.views.push_back(view.value);
  }
  for (const SpecReader::Text& size : read.texts(table, "sizes", false))
    block.sizes.push_back(read.size(size));
  if (block.sizes.empty()) block.sizes.push_back({});
}

RunBlock read_block(const SpecReader& read, const toml::table& table, const Catalogue& catalogue,
                    const RunBlock& defaults) {
  RunBlock block = defaults;
  block.at = read.position(table);
  read.allow(table,
             {"name", "techniques", "scenes", "views", "sizes", "combine", "zip", "design", "constraints", "metrics",
              "baseline", "keep", "axes", "fixed", "timing", "reference"},
             "run");
  block.name = read.identifier(table, "name", block.at);
  read_places(read, table, catalogue, block);
  read_timing(read, table, block.timing);
  read_reference(read, table, block.reference);
  read_metrics(read, table, block.metrics);
  read_axes(read, table, catalogue, block);
  read_keep(read, table, block.keep);
  for (const SpecReader::Text& text : read.texts(table, "constraints", true)) {
    block.constraints.push_back({text.value, read.position(*text.node)});
  }
  read.boolean(table, "baseline", block.baseline);
  if (block.baseline && !block.timing.enabled) {
    read.fail(*table.get("baseline"), "the baseline is re-measured for its time; its block needs timing");
  }
  if (!block.timing.enabled && block.metrics.empty()) {
    read.fail(block.at, fmt::format("block '{}' has neither timing nor metrics: nothing to measure", block.name));
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

toml::table parse_tree(std::string_view text, const std::string& source) {
  try {
    return toml::parse(text, source);
  } catch (const toml::parse_error& e) {
    throw InputError(
        fmt::format("{}:{}:{}: {}", source, e.source().begin.line, e.source().begin.column, e.description()));
  }
}

Spec read_spec(const SpecReader& read, const toml::table& root, const Catalogue& catalogue) {
  Spec spec;
  read.allow(root, {"name", "title", "description", "metrics", "keep", "timeout_s", "timing", "reference", "run"},
             "the spec");
  spec.name = read.identifier(root, "name", {1, 1});
  read.text(root, "title", spec.title);
  read.text(root, "description", spec.description);
  read.real(root, "timeout_s", 0.1, 86'400, spec.timeout_s);

  RunBlock defaults;
  defaults.metrics = MetricSet(kDefaultMetrics).names();
  read_metrics(read, root, defaults.metrics);
  read_keep(read, root, defaults.keep);
  read_timing(read, root, defaults.timing);
  read_reference(read, root, defaults.reference);

  const toml::node* runs = root.get("run");
  if (runs == nullptr) read.fail(Position{1, 1}, "the spec has no [[run]] block");
  const toml::array* blocks = runs->as_array();
  if (blocks == nullptr || blocks->empty() || !blocks->is_homogeneous(toml::node_type::table)) {
    read.fail(*runs, "run is a list of tables: write [[run]]");
  }
  for (const toml::node& node : *blocks) {
    RunBlock block = read_block(read, *node.as_table(), catalogue, defaults);
    for (const RunBlock& other : spec.blocks) {
      if (other.name == block.name) {
        read.fail(*node.as_table()->get("name"), fmt::format("a second block named '{}'", block.name));
      }
      if (other.baseline && block.baseline) {
        read.fail(*node.as_table()->get("baseline"), fmt::format("block '{}' is the baseline already", other.name));
      }
    }
    spec.blocks.push_back(std::move(block));
  }
  return spec;
}

}  // namespace

Spec parse_spec(std::string_view text, const std::string& source, const Catalogue& catalogue, Extent extent) {
  if (text.size() > kMaxSpecBytes) throw InputError(fmt::format("{}: a spec may have {} bytes", source, kMaxSpecBytes));
  const SpecReader read(source);
  const auto parse = [&] { return parse_tree(text, source); };
  toml::table root = parse();
  Spec spec;
  if (extent == Extent::preview) {
    spec = read_spec(read, preview_of(read, parse), catalogue);  // alone: the full spec may need assets
  } else {
    // A mistake in the preview shows at once, too.
    if (root.contains("preview")) read_spec(read, preview_of(read, parse), catalogue);
    root.erase("preview");
    spec = read_spec(read, root, catalogue);
  }
  spec.source = source;
  spec.text = text;
  return spec;
}

Spec load_spec(const std::string& path_or_name, const Catalogue& catalogue, Extent extent) {
  if (!path_or_name.ends_with(".toml")) {
    const bool named_preview = path_or_name.ends_with(kPreview);
    const std::string_view base =
        std::string_view(path_or_name).substr(0, path_or_name.size() - (named_preview ? kPreview.size() : 0));
    for (const auto& [name, resource] : embedded_specs()) {
      if (name == path_or_name) return parse_spec(*find_resource(resource), resource, catalogue, extent);
      if (named_preview && name == base) {
        return parse_spec(*find_resource(resource), resource, catalogue, Extent::preview);
      }
    }
    const std::vector<std::string> names = list_specs();
    const std::string near = nearest_name(path_or_name, names);
    throw InputError(fmt::format("no spec named '{}'; {} (a file's name ends in .toml)", path_or_name,
                                 near.empty() ? fmt::format("built in are: {}", fmt::join(names, ", "))
                                              : fmt::format("did you mean '{}'?", near)));
  }
  std::error_code error;
  if (!std::filesystem::is_regular_file(path_or_name, error)) {
    throw InputError(fmt::format("{}: {}", path_or_name,
                                 std::filesystem::exists(path_or_name, error) ? "not a file" : "no such file"));
  }
  if (std::filesystem::file_size(path_or_name, error) > kMaxSpecBytes) {
    throw InputError(fmt::format("{}: a spec may have {} bytes", path_or_name, kMaxSpecBytes));
  }
  std::ifstream file(path_or_name, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  if (!file) throw InputError(fmt::format("{}: cannot be read", path_or_name));
  return parse_spec(text, path_or_name, catalogue, extent);
}

std::vector<std::string> list_specs() {
  std::vector<std::string> names;
  for (const auto& [name, resource] : embedded_specs()) {
    names.push_back(name);
    if (parse_tree(*find_resource(resource), resource).contains("preview"))
      names.push_back(name + std::string(kPreview));
  }
  return names;
}

}  // namespace pellucid::sweeps
