// pellucid compare.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "algorithms/parameters.hpp"
#include "algorithms/scene/files/tell.hpp"
#include "algorithms/scene/images/picture_file.hpp"
#include "gl/error.hpp"
#include "sandbox/arguments.hpp"
#include "sandbox/commands/commands.hpp"
#include "sweeps/metrics/metrics.hpp"

namespace pellucid::sandbox {
namespace {

using nlohmann::ordered_json;

struct CompareArguments {
  std::filesystem::path reference, test, map;
  std::vector<std::string> metrics, fail_above, fail_below;
  std::string mask;
  bool no_mask = false;
  bool json = false;
  double pixels_per_degree = sweeps::kDefaultPixelsPerDegree;
};

/// A bound that a value must keep, else exit status 3.
struct Bound {
  std::string column;
  double limit = 0;
  bool above = true;  ///< fails when the value is above the limit, else when it is below

  bool broken_by(double value) const { return above ? value > limit : value < limit; }
};

Bound parse_bound(const std::string& text, bool above, const std::vector<std::string>& columns) {
  const char* option = above ? "--fail-above" : "--fail-below";
  const std::size_t equals = text.find('=');
  Bound out{text.substr(0, equals), 0, above};
  const char* const first = text.data() + std::min(text.size(), equals + 1);
  const auto [end, error] = std::from_chars(first, text.data() + text.size(), out.limit);
  if (equals == std::string::npos || error != std::errc{} || end != text.data() + text.size() ||
      !std::isfinite(out.limit))
    throw InputError(fmt::format("{} {} is not metric=number, for example flip_mean=0.05", option, text));
  if (std::find(columns.begin(), columns.end(), out.column) == columns.end()) {
    const std::string near = nearest_name(out.column, columns);
    throw InputError(
        near.empty()
            ? fmt::format("{} {}: '{}' is not computed; one of {}", option, text, out.column, fmt::join(columns, ", "))
            : fmt::format("{} {}: '{}' is not computed; did you mean '{}'?", option, text, out.column, near));
  }
  return out;
}

/// The object mask and where it comes from; no image when there is none.
struct Mask {
  std::optional<Image> image;
  std::string source;
};

Mask find_mask(const CompareArguments& options, const PictureFile& reference) {
  const auto layer_of = [](const ImageFile& file, const std::string& name) -> const Image* {
    const auto found = file.layers.find(name);
    return found == file.layers.end() ? nullptr : &found->second;
  };
  if (options.no_mask) return {};
  if (options.mask.empty()) {
    const Image* layer = layer_of(reference, "mask");
    return layer ? Mask{*layer, "layer mask of " + options.reference.string()} : Mask{};
  }
  if (const Image* layer = layer_of(reference, options.mask))
    return {*layer, fmt::format("layer {} of {}", options.mask, options.reference.string())};
  std::error_code ignored;
  if (!std::filesystem::exists(options.mask, ignored)) {
    const std::vector<std::string>& layers = reference.layer_names;
    throw InputError(fmt::format("--mask {}: neither a file nor a layer of {}, which has {}", options.mask,
                                 options.reference.string(),
                                 layers.empty() ? "none" : fmt::format("{}", fmt::join(layers, ", "))));
  }
  PictureFile file = read_picture(options.mask, [](const std::string& layer) { return layer == "mask"; });
  if (const Image* layer = layer_of(file, "mask")) return {*layer, "layer mask of " + options.mask};
  return {std::move(file.image), options.mask};
}

/// A mask that nobody asked for and that marks nothing (an opaque scene's reference, another program's layer) is left
/// alone.
void drop_empty_mask(const CompareArguments& options, Mask& mask, std::vector<std::string>& notes) {
  if (!options.mask.empty() || !mask.image) return;
  const Image& image = *mask.image;
  bool marked = image.width < 1;
  for (std::size_t i = 0; !marked && i < image.pixels.size(); i += static_cast<std::size_t>(image.channels))
    marked = image.pixels[i] > 0.5F;
  if (marked) return;
  notes.push_back(
      fmt::format("{} marks no pixel and is not used (--no-mask leaves it out without this note)", mask.source));
  mask = {};
}

/// Both pictures are of one kind, size and shape of pixels.
void check_comparable(const CompareArguments& options, const PictureFile& reference, const PictureFile& test) {
  const auto kind = [](const PictureFile& file) { return file.display_encoded ? "display-encoded" : "scene-linear"; };
  if (reference.display_encoded != test.display_encoded)
    throw InputError(fmt::format("{} is {} and {} is {}: compare EXR with EXR, PNG with PNG",
                                 options.reference.string(), kind(reference), options.test.string(), kind(test)));
  if (reference.image.width != test.image.width || reference.image.height != test.image.height)
    throw InputError(fmt::format("test {} is {}, but the reference {} is {}", options.test.string(), size_text(test),
                                 options.reference.string(), size_text(reference)));
  if (std::abs(reference.pixel_aspect - test.pixel_aspect) > 1e-4 * reference.pixel_aspect)
    throw InputError(fmt::format("the pixels of {} are {:.4g} times as wide as high, those of {} {:.4g} times",
                                 options.test.string(), test.pixel_aspect, options.reference.string(),
                                 reference.pixel_aspect));
}

/// A map must not replace what is compared.
void check_map(const CompareArguments& options) {
  if (options.map.empty()) return;
  if (options.map.extension() != ".png" && options.map.extension() != ".exr")
    throw InputError(fmt::format("--map {}: the name must end in .png or .exr", options.map.string()));
  check_output(options.map, {".png", ".exr"});
  for (const std::filesystem::path& input : {options.reference, options.test, std::filesystem::path(options.mask)})
    check_no_input(options.map, input, "--map");
}

std::string text_of(double value) {
  return std::isinf(value) ? "inf" : fmt::format("{:.6g}", value);
}

void print_text(const sweeps::Comparison& comparison, const sweeps::ComparisonResult& result,
                const CompareArguments& options, bool display_encoded, const sweeps::MetricSet& metrics,
                const std::string& mask) {
  constexpr const char* kRow = "{:<22}{:>12}{}\n";
  const auto second = [](const std::string& text) { return fmt::format("{:>12}", text); };
  fmt::print(kRow, "metric", "frame", comparison.masked() ? second("mask") : "");
  for (const std::string& column : metrics.columns(false))
    fmt::print(kRow, column, text_of(result.at(column)),
               comparison.masked() ? second(text_of(result.at(column + "_mask"))) : "");
  fmt::print("\n{} values", display_encoded ? "display-encoded [0, 1]" : "scene-linear");
  if (metrics.has("flip")) {
    fmt::print("; {}-FLIP at {:.4g} pixels per degree", display_encoded ? "LDR" : "HDR", options.pixels_per_degree);
    if (const sweeps::Exposures* e = comparison.exposures())
      fmt::print(", {} exposures from {:+.3f} to {:+.3f} stops", e->count, e->start, e->stop);
  }
  if (comparison.masked()) fmt::print("; mask: {}", mask);
  fmt::print("\n");
}

ordered_json to_json(const sweeps::Comparison& comparison, const sweeps::ComparisonResult& result,
                     const CompareArguments& options, const Image& image, bool display_encoded,
                     const std::string& mask) {
  ordered_json out{{"reference", options.reference.string()},
                   {"test", options.test.string()},
                   {"width", image.width},
                   {"height", image.height},
                   {"encoding", display_encoded ? "display" : "scene-linear"},
                   {"mask", comparison.masked() ? ordered_json(mask) : ordered_json(nullptr)}};
  for (const auto& [name, value] : result.values)
    out[name] = std::isfinite(value) ? ordered_json(value) : ordered_json(nullptr);
  if (result.values.front().first.starts_with("flip")) {
    out["pixels_per_degree"] = options.pixels_per_degree;
    if (const sweeps::Exposures* e = comparison.exposures())
      out["exposures"] = {{"start", e->start}, {"stop", e->stop}, {"count", e->count}};
  }
  return out;
}

int compare(const CompareArguments& options) {
  check_map(options);
  const sweeps::MetricSet metrics = options.metrics.empty() ? sweeps::MetricSet() : sweeps::MetricSet(options.metrics);
  const std::string mask_layer = options.mask.empty() ? "mask" : options.mask;
  PictureFile reference = read_picture(
      options.reference, [&](const std::string& layer) { return !options.no_mask && layer == mask_layer; });
  PictureFile test = read_picture(options.test, no_layer);
  check_comparable(options, reference, test);
  std::vector<std::string> notes;
  for (const auto& [file, path] : {std::pair(&reference, &options.reference), std::pair(&test, &options.test)}) {
    encode_as_srgb(*file);
    for (const std::string& note : file->notes)
      notes.push_back(fmt::format("{}: {}", path->string(), note));
  }
  Mask mask = find_mask(options, reference);
  drop_empty_mask(options, mask, notes);
  for (const std::string& note : notes)
    tell("note: {}", note);
  const bool display_encoded = reference.display_encoded;
  std::vector<Bound> bounds;
  for (const std::string& text : options.fail_above)
    bounds.push_back(parse_bound(text, true, metrics.columns(mask.image.has_value())));
  for (const std::string& text : options.fail_below)
    bounds.push_back(parse_bound(text, false, metrics.columns(mask.image.has_value())));
  const sweeps::Comparison comparison(std::move(reference.image), mask.image ? &*mask.image : nullptr,
                                      {.metrics = metrics,
                                       .display_encoded = display_encoded,
                                       .keep_map = !options.map.empty(),
                                       .flip = {.pixels_per_degree = options.pixels_per_degree},
                                       .exposures = std::nullopt});
  sweeps::ComparisonResult result = comparison.compare(test.image);

  if (options.map.extension() == ".png") write_png(options.map, sweeps::error_colors(result.flip_map));
  if (options.map.extension() == ".exr") {
    ImageFile file;
    file.image = std::move(result.flip_map);
    write_exr(options.map, file, ExrPixel::single);
  }

  std::vector<const Bound*> broken;
  for (const Bound& bound : bounds)
    if (bound.broken_by(result.at(bound.column))) broken.push_back(&bound);
  if (options.json) {
    ordered_json out = to_json(comparison, result, options, test.image, display_encoded, mask.source);
    out["notes"] = notes;
    out["failed"] = ordered_json::array();
    for (const Bound* bound : broken)
      out["failed"].push_back(bound->column);
    fmt::print("{}\n", out.dump(2));
  } else {
    print_text(comparison, result, options, display_encoded, metrics, mask.source);
  }
  for (const Bound* bound : broken)
    tell("{} = {} is {} {}", bound->column, text_of(result.at(bound->column)), bound->above ? "above" : "below",
         bound->limit);
  return broken.empty() ? kDone : kRegression;
}

}  // namespace

void add_compare(cli::App& root, std::vector<Command>& commands) {
  auto options = std::make_shared<CompareArguments>();
  cli::App* app = root.add_subcommand("compare", "Compare an image with a reference by image metrics");
  app->add_option("reference", options->reference, "The reference: EXR (scene-linear) or PNG (display-encoded)")
      ->required();
  app->add_option("test", options->test, "The image to judge: of the same kind and size")->required();
  app->add_option("-m,--metrics", options->metrics,
                  fmt::format("Comma-separated; all without it: {}", fmt::join(sweeps::metric_names(), ", ")))
      ->delimiter(',')
      ->allow_extra_args(false);
  app->add_flag("--json", options->json, "Print the values as JSON; the infinite PSNR of equal images is null");
  app->add_option("--map", options->map,
                  "Write FLIP's error map: .png in colours from black (0) to pale yellow (1), .exr as values");
  cli::Option* mask = app->add_option(
      "--mask", options->mask,
      "Give every value under a mask too (above 0.5): an image file, or a layer of the reference; a layer named mask "
      "is used without asking");
  app->add_flag("--no-mask", options->no_mask, "Leave the reference's layer mask alone")->excludes(mask);
  app->add_option("--ppd", options->pixels_per_degree, "FLIP's pixels per degree of visual angle")
      ->check(cli::Range(1.0, 1000.0))
      ->capture_default_str();
  app->add_option("--fail-above", options->fail_above,
                  "metric=number: exit with status 3 if the value is above; repeatable")
      ->allow_extra_args(false);
  app->add_option("--fail-below", options->fail_below, "The same for values that should be high: psnr, ssim")
      ->allow_extra_args(false);
  app->footer(
      "PNG: LDR-FLIP, and the other metrics on the encoded values in [0, 1]. EXR: HDR-FLIP with the ACES curve and\n"
      "automatic exposures, and the other metrics on radiance; PSNR's peak is the largest component of the reference,\n"
      "SSIM is taken of the image clamped to [0, 1] and sRGB-encoded. Alpha is not compared.\n"
      "Pictures are compared in the EXR's display window, 0 where nothing is stored; other primaries than Rec. 709's\n"
      "(chromaticities) are converted, and a PNG's gamma (gAMA) to sRGB's encoding; its ICC profile is not applied.\n"
      "Example: pellucid compare truth.exr hulls.exr -m flip,rmse --map error.png --fail-above flip_mean=0.05");
  commands.push_back({app, [options] { return compare(*options); }});
}

}  // namespace pellucid::sandbox
