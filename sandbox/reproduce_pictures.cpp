#include "sandbox/reproduce_pictures.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "algorithms/parameters.hpp"
#include "algorithms/scene/scene.hpp"
#include "gl/error.hpp"
#include "sandbox/commands/arguments.hpp"
#include "sandbox/self.hpp"
#include "sweeps/metrics/flip.hpp"
#include "sweeps/metrics/metrics.hpp"
#include "sweeps/provenance.hpp"

namespace pellucid::sandbox {
namespace {

using nlohmann::json;

constexpr int kEnlarged = 3;

std::string shown(std::vector<std::string> words) {
  words.insert(words.begin(), "pellucid");
  return sweeps::shell_line(words);
}

json attribute(const ImageFile& file, const char* name) {
  const auto found = file.attributes.find(name);
  return found == file.attributes.end() ? json() : json::parse(found->second, nullptr, false);
}

/// What a file must say of itself to be kept.
struct Wanted {
  std::string command;
  json recipe;  ///< these fields, and of its parameters these
  std::string scene_hash;
  std::string device;  ///< empty: any
};

// Why the file cannot stay; empty when it can.
std::string outdated(const ImageFile& file, const Wanted& wanted) {
  const auto command = file.attributes.find("pellucid.command");
  const json recipe = attribute(file, "pellucid.recipe"), origin = attribute(file, "pellucid.provenance");
  if (command == file.attributes.end() || command->second != wanted.command || !recipe.is_object() ||
      !origin.is_object()) {
    return "it is of another making";
  }
  for (const auto& [name, value] : wanted.recipe.items()) {
    if (name != "parameters" && recipe.value(name, json()) != value) return fmt::format("its {} differs", name);
  }
  const json parameters = recipe.value("parameters", json::object());
  for (const auto& [name, value] : wanted.recipe.at("parameters").items()) {
    if (parameters.value(name, json()) != value) return fmt::format("its {} differs", name);
  }
  if (origin.value("scene_hash", "") != wanted.scene_hash) return "the scene has changed";
  if (origin.value("commit", "") != sweeps::kCommit) return "the program has changed";
  if (!wanted.device.empty() && origin.value("device", wanted.device) != wanted.device)
    return "it is of another device";
  return "";
}

// The file at `path`, made by `command` unless it is there and as wanted.
ImageFile make(const std::filesystem::path& path, const std::vector<std::string>& command, const Wanted& wanted,
               const PictureOptions& options, DrawnPicture& picture) {
  std::error_code error;
  std::string why;
  std::optional<ImageFile> file;
  if (std::filesystem::exists(path, error)) {
    try {
      file = read_image(path);
      why = outdated(*file, wanted);
    } catch (const InputError&) {
      why = "it is damaged";
    }
  }
  picture.kept = file && why.empty();
  if (!picture.kept) {
    options.say(fmt::format("{}{}", path.filename().string(), why.empty() ? "" : fmt::format(" again: {}", why)));
    run_pellucid(command);
    file = read_image(path);
    if (const std::string flaw = outdated(*file, wanted); !flaw.empty())
      throw RuntimeError(fmt::format("{} is not what was asked for: {}", path.string(), flaw));
  }
  const json origin = attribute(*file, "pellucid.provenance");
  picture.device = origin.value("device", "");
  picture.driver = origin.value("driver", "");
  picture.commit = origin.value("commit", "");
  return std::move(*file);
}

Image crop(const Image& image, const Window& window) {
  Image out(window.width, window.height, image.channels);
  for (int y = 0; y < window.height; ++y) {
    std::copy_n(image.at(window.x, window.y + y), window.width * image.channels, out.at(0, y));
  }
  return out;
}

Image enlarge(const Image& image, int factor) {
  Image out(image.width * factor, image.height * factor, image.channels);
  for (int y = 0; y < out.height; ++y) {
    for (int x = 0; x < out.width; ++x)
      std::copy_n(image.at(x / factor, y / factor), image.channels, out.at(x, y));
  }
  return out;
}

Image scaled(Image image, double gain) {
  for (float& value : image.pixels)
    value = std::min(1.0F, value * static_cast<float>(gain));
  return image;
}

json settings_json(const PaperPicture& picture) {
  json out = json::object();
  for (const std::string_view setting : picture.settings) {
    const auto [name, text] = parse_assignment(std::string(setting));
    json value = json::parse(text, nullptr, false);
    out[name] = value.is_discarded() ? json(text) : std::move(value);  // a choice is a bare word
  }
  return out;
}

}  // namespace

Window brightest_window(const Image& image, int width, int height) {
  const int w = std::min(width, image.width), h = std::min(height, image.height);
  // Sums over all rectangles from the top left corner, so that a window costs four look-ups.
  const auto stride = static_cast<std::size_t>(image.width) + 1;
  std::vector<double> sums(stride * (static_cast<std::size_t>(image.height) + 1));
  auto sum = [&](int x, int y) -> double& {
    return sums[static_cast<std::size_t>(y) * stride + static_cast<std::size_t>(x)];
  };
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x)
      sum(x + 1, y + 1) = static_cast<double>(*image.at(x, y)) + sum(x, y + 1) + sum(x + 1, y) - sum(x, y);
  }
  Window best{0, 0, w, h};
  double largest = -HUGE_VAL;
  for (int y = 0; y + h <= image.height; ++y) {
    for (int x = 0; x + w <= image.width; ++x) {
      const double total = sum(x + w, y + h) - sum(x, y + h) - sum(x + w, y) + sum(x, y);
      if (total <= largest) continue;
      largest = total;
      best.x = x;
      best.y = y;
    }
  }
  return best;
}

DrawnPictures draw_pictures(const PaperPictures& set, const PictureOptions& options) {
  std::filesystem::create_directories(options.folder);
  const auto path = [&](const std::string& name) { return options.folder / name; };
  Scene scene = load_scene(std::string(set.scene));
  const View& view = scene.find_view(set.view);
  DrawnPictures out;
  out.name = set.name;
  out.title = set.title;
  out.scene = set.scene;
  out.scene_title = scene.title;
  out.stand_in = scene.stand_in;
  out.view = view.name;
  out.width = set.width;
  out.height = set.height;
  out.enlarged = kEnlarged;

  json place{{"scene", out.scene}, {"view", out.view}, {"width", out.width}, {"height", out.height}};
  place["parameters"] = json::object();
  Wanted wanted{.command = "reference", .recipe = place, .scene_hash = scene.content_hash(), .device = options.made_on};
  std::vector<std::string> common{"--view", out.view, "--size", fmt::format("{}x{}", out.width, out.height)};
  if (options.device) common.insert(common.end(), {"--device", std::to_string(*options.device)});

  // The reference takes its surfaces from the forward pass, so that the metrics see the medium alone.
  DrawnPicture& reference = out.reference;
  reference.name = "reference";
  reference.settings_text = "the reference";
  reference.exr = "reference.exr";
  reference.png = "reference.png";
  std::vector<std::string> command{"reference", out.scene, "--surfaces", "raster"};
  command.insert(command.end(), common.begin(), common.end());
  command.insert(command.end(), {"-o", path(reference.exr).string()});
  reference.repeat = shown(command);
  wanted.recipe["surfaces"] = "raster";
  const std::string device = std::exchange(wanted.device, "");  // traced on the CPU
  const ImageFile truth = make(path(reference.exr), command, wanted, options, reference);
  wanted.device = device;
  const json error = attribute(truth, "pellucid.reference_error");
  out.step_error_max = error.value("step_error_max", 0.0);
  out.step_error_mean = error.value("step_error_mean", 0.0);
  out.unconverged_share = error.value("unconverged_share", 0.0);

  std::vector<ImageFile> files;
  for (const PaperPicture& recipe : set.pictures) {
    DrawnPicture picture;
    picture.name = recipe.name;
    picture.label = recipe.label;
    picture.role = recipe.role;
    picture.technique = recipe.technique;
    picture.exr = picture.name + ".exr";
    picture.settings_text = picture.technique;
    command = {"render", out.scene, "-t", picture.technique};
    for (const std::string_view setting : recipe.settings) {
      const auto [name, value] = parse_assignment(std::string(setting));
      picture.settings_text += fmt::format(", {} {}", name, value);
      command.insert(command.end(), {"-s", std::string(setting)});
    }
    command.insert(command.end(), common.begin(), common.end());
    command.insert(command.end(), {"-o", path(picture.exr).string()});
    picture.repeat = shown(command);
    wanted.command = "render";
    wanted.recipe = place;
    wanted.recipe["technique"] = picture.technique;
    wanted.recipe["parameters"] = settings_json(recipe);
    files.push_back(make(path(picture.exr), command, wanted, options, picture));
    out.pictures.push_back(std::move(picture));
  }

  options.say("error maps");
  const sweeps::Comparison comparison(
      truth.image, nullptr, {.metrics = sweeps::MetricSet(std::vector<std::string>{"flip", "rmse"}), .keep_map = true});
  std::vector<Image> maps;
  for (std::size_t i = 0; i < files.size(); ++i) {
    DrawnPicture& picture = out.pictures[i];
    sweeps::ComparisonResult result = comparison.compare(files[i].image);
    for (const char* metric : {"flip_mean", "flip_max", "rmse"})
      picture.metrics[metric] = result.at(metric);
    maps.push_back(std::move(result.flip_map));
    picture.map_exr = picture.name + ".flip.exr";
    picture.repeat_map = shown({"compare", path(reference.exr).string(), path(picture.exr).string(), "-m", "flip,rmse",
                                "--no-mask", "--map", path(picture.map_exr).string()});
    if (picture.name == set.close_up_of) {
      out.close_up = brightest_window(maps.back(), set.close_up_width, set.close_up_height);
      out.close_up_of = picture.label.empty() ? picture.name : picture.label;
    }
  }
  // The maps share one scale, or they could not be compared; its end is a round number above the largest error.
  double largest = 0;
  for (const DrawnPicture& picture : out.pictures)
    largest = std::max(largest, picture.metrics.at("flip_max"));
  out.map_scale = std::min(1.0, std::ceil(largest * 20) / 20);

  const auto write_pair = [&](const ImageFile& file, DrawnPicture& picture) {
    picture.png = picture.name + ".png";
    picture.close_png = picture.name + ".close.png";
    write_picture(path(picture.png), file, {});
    ImageFile close;
    close.image = enlarge(crop(file.image, out.close_up), kEnlarged);
    write_picture(path(picture.close_png), close, {});
  };
  write_pair(truth, reference);
  for (std::size_t i = 0; i < files.size(); ++i) {
    DrawnPicture& picture = out.pictures[i];
    write_pair(files[i], picture);
    ImageFile map;
    map.image = maps[i];
    write_exr(path(picture.map_exr), map, ExrPixel::single);
    picture.map_png = picture.name + ".flip.png";
    picture.close_map_png = picture.name + ".close.flip.png";
    const Image colors = sweeps::error_colors(scaled(maps[i], 1 / out.map_scale));
    write_png(path(picture.map_png), colors);
    write_png(path(picture.close_map_png), enlarge(crop(colors, out.close_up), kEnlarged));
  }
  return out;
}

}  // namespace pellucid::sandbox
