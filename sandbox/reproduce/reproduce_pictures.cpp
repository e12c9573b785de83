#include "sandbox/reproduce/reproduce_pictures.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "algorithms/parameters.hpp"
#include "algorithms/scene/scene.hpp"
#include "algorithms/scene/view_text.hpp"
#include "algorithms/technique.hpp"
#include "gl/display/display.hpp"
#include "gl/error.hpp"
#include "plots/pictures/close_up.hpp"
#include "plots/pictures/false_color.hpp"
#include "sandbox/arguments.hpp"
#include "sandbox/reproduce/run_pellucid.hpp"
#include "sweeps/measure/reference_methods.hpp"
#include "sweeps/metrics/flip.hpp"
#include "sweeps/metrics/metrics.hpp"
#include "sweeps/spec/point_json.hpp"
#include "sweeps/spec/provenance.hpp"
#include "sweeps/store/rows.hpp"

namespace pellucid::sandbox {
namespace {

using nlohmann::json;
using plots::PictureRecipe;
using plots::PictureSet;
using plots::Settings;

constexpr int kEnlarged = 3;
constexpr int kPreviewShrink = 2;  ///< along each side; close-ups are enlarged the more

std::string shown(std::vector<std::string> words) {
  words.insert(words.begin(), "pellucid");
  return sweeps::shell_line(words);
}

json attribute(const ImageFile& file, const char* name) {
  const auto found = file.attributes.find(name);
  return found == file.attributes.end() ? json() : json::parse(found->second, nullptr, false);
}

/// A file must say this of itself to be kept.
struct Wanted {
  std::string command;
  json recipe;  ///< these fields, and of its parameters these
  std::string scene_hash;
  std::string device;  ///< empty: any
};

// Reals are floats in a session: the file has them rounded.
bool same(const json& a, const json& b) {
  if (!a.is_number() || !b.is_number()) return a == b;
  return a.get<float>() == b.get<float>();
}

// Why the file cannot stay; empty when it can.
std::string outdated(const ImageFile& file, const Wanted& wanted) {
  const auto command = file.attributes.find("pellucid.command");
  const json recipe = attribute(file, "pellucid.recipe"), origin = attribute(file, "pellucid.provenance");
  if (command == file.attributes.end() || command->second != wanted.command || !recipe.is_object() ||
      !origin.is_object()) {
    return "another command wrote it";
  }
  for (const auto& [name, value] : wanted.recipe.items()) {
    if (name != "parameters" && recipe.value(name, json()) != value) return fmt::format("its {} differs", name);
  }
  const json parameters = recipe.value("parameters", json::object());
  for (const auto& [name, value] : wanted.recipe.at("parameters").items()) {
    if (!same(parameters.value(name, json()), value)) return fmt::format("its {} differs", name);
  }
  if (origin.value("scene_hash", "") != wanted.scene_hash) return "the scene has changed";
  if (origin.value("commit", "") != sweeps::kCommit) return "the program has changed";
  if (!wanted.device.empty() && origin.value("device", wanted.device) != wanted.device)
    return "it is of another device";
  return "";
}

/// A file of a picture.
struct Product {
  std::filesystem::path path;
  Wanted wanted;
  std::optional<ImageFile> file;  ///< as it was found, damaged ones left out
  std::string why;                ///< it cannot stay; empty when it can or is not there

  bool good() const { return file && why.empty(); }
  void look() {
    std::error_code error;
    why.clear();
    file.reset();
    if (!std::filesystem::exists(path, error)) return;
    try {
      file = read_image(path);
      why = outdated(*file, wanted);
    } catch (const InputError&) {
      why = "it is damaged";
    }
  }
};

// The files, made by one `command` unless all are there and as wanted.
void make(std::vector<Product>& products, const std::vector<std::string>& command, const PictureOptions& options,
          DrawnPicture& picture) {
  const auto good = [](const Product& product) { return product.good(); };
  for (Product& product : products)
    product.look();
  picture.kept = std::all_of(products.begin(), products.end(), good);
  if (!picture.kept) {
    const auto bad = std::find_if_not(products.begin(), products.end(), good);
    options.say(fmt::format("{}{}", bad->path.filename().string(), bad->why.empty() ? "" : " again: " + bad->why));
    run_pellucid(command);
    for (Product& product : products) {
      product.look();
      if (product.good()) continue;
      throw RuntimeError(fmt::format("{} is not what was asked for: {}", product.path.string(),
                                     product.why.empty() ? "it is missing" : product.why));
    }
  }
  const json origin = attribute(*products.front().file, "pellucid.provenance");
  picture.device = origin.value("device", "");
  picture.driver = origin.value("driver", "");
  picture.commit = origin.value("commit", "");
}

json value_of(const std::string& text) {
  json value = json::parse(text, nullptr, false);
  return value.is_discarded() ? json(text) : std::move(value);  // a choice is a bare word
}

/// Every parameter of the technique as the picture has it.
json parameters_of(const PictureRecipe& picture) {
  json out = json::object();
  for (const ParameterInfo& info : find_technique(picture.technique).table().infos())
    out[info.name] = sweeps::value_to_json(info.default_value);
  for (const auto& [name, text] : picture.settings)
    out[name] = value_of(text);
  return out;
}

/// The settings of the set, which are of the scene alone.
std::map<std::string, Value> scene_parameters(const PictureSet& set, Scene scene) {
  std::map<std::string, Value> out;
  for (const auto& [name, text] : set.settings) {
    const std::string bare = name.substr(std::string_view("scene.").size());
    const std::string owner = "scene " + scene.name;
    const auto infos = scene.parameters().infos();
    const auto info = std::find_if(infos.begin(), infos.end(), [&](const ParameterInfo& i) { return i.name == bare; });
    if (info == infos.end()) throw unknown_parameter(bare, owner, infos);
    out[name] = parse_value(*info, text, owner);
  }
  return out;
}

std::string told(const Settings& settings, std::string text) {
  for (const auto& [name, value] : settings)
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", name, value);
  return text;
}

/// One set of pictures in the making.
class Drawing {
 public:
  Drawing(const PictureSet& set, const PictureOptions& options)
      : set_(set), options_(options), shrink_(options.preview ? kPreviewShrink : 1) {
    const std::string& name = options.preview && !set.preview_scene.empty() ? set.preview_scene : set.scene;
    const Scene scene = sweeps::load_again(name, scene_parameters(set, load_scene(name)));
    out_.name = set.name;
    out_.title = set.title;
    out_.scene = name;
    out_.settings_text = told(set.settings, "");
    out_.surfaces = set.surfaces;
    out_.close_up_why = set.close_up_why;
    out_.scene_title = scene.title;
    out_.stand_in = scene.stand_in;
    out_.view = view_of(scene, set.view).name;
    out_.width = set.width / shrink_;
    out_.height = set.height / shrink_;
    out_.enlarged = kEnlarged * shrink_;
    scene_hash_ = scene.content_hash();
  }

  DrawnPictures draw() {
    draw_reference();
    for (const PictureRecipe& recipe : set_.pictures)
      draw_picture(recipe);
    compare();
    options_.say("PNG, error maps, close-ups");
    write_plain();
    write_native();
    if (has_close_up()) write_close_ups();
    return std::move(out_);
  }

 private:
  bool has_close_up() const { return set_.close_up.width > 0; }
  std::filesystem::path path(const std::string& name) const { return options_.folder / name; }

  json place() const {
    json parameters = json::object();
    for (const auto& [name, text] : set_.settings)
      parameters[name] = value_of(text);
    return {{"scene", out_.scene},
            {"view", out_.view},
            {"width", out_.width},
            {"height", out_.height},
            {"parameters", parameters}};
  }
  /// The scene as the set has it, but for what a picture sets of it.
  std::string scene_hash_with(const Settings& own) const {
    PictureSet changed = set_;
    changed.settings.clear();
    for (const Settings* settings : {&own, &set_.settings}) {
      for (const auto& [name, value] : *settings) {
        if (name.starts_with("scene.")) changed.settings.emplace_back(name, value);
      }
    }
    if (changed.settings.size() == set_.settings.size()) return scene_hash_;
    return sweeps::load_again(out_.scene, scene_parameters(changed, load_scene(out_.scene))).content_hash();
  }
  static void add_settings(std::vector<std::string>& command, const Settings& settings) {
    for (const auto& [name, value] : settings)
      command.insert(command.end(), {"-s", name + "=" + value});
  }
  void add_place(std::vector<std::string>& command, const std::string& output) const {
    add_settings(command, set_.settings);
    command.insert(command.end(), {"--view", out_.view, "--size", fmt::format("{}x{}", out_.width, out_.height)});
    if (options_.device) command.insert(command.end(), {"--device", std::to_string(*options_.device)});
    command.insert(command.end(), {"-o", path(output).string()});
  }

  void draw_reference() {
    DrawnPicture& reference = out_.reference;
    reference.name = "reference";
    reference.exr = "reference.exr";
    std::vector<std::string> command{"reference", out_.scene, "--surfaces", set_.surfaces};
    const int samples = options_.preview ? set_.preview_samples : set_.samples;
    if (samples > 1) command.insert(command.end(), {"--samples", std::to_string(samples)});
    if (set_.caustics) command.emplace_back("--caustics");
    add_place(command, reference.exr);
    reference.repeat = shown(command);
    Wanted wanted{.command = "reference", .recipe = place(), .scene_hash = scene_hash_, .device = options_.made_on};
    wanted.recipe["surfaces"] = set_.surfaces;
    if (set_.surfaces == "rays") {
      wanted.recipe["samples"] = samples;
      wanted.recipe["caustics"] = set_.caustics;
    }
    std::vector<Product> products{{.path = path(reference.exr), .wanted = std::move(wanted), .file = {}, .why = {}}};
    make(products, command, options_, reference);
    truth_ = std::move(*products.front().file);
    const json error = attribute(truth_, "pellucid.reference_error");
    json row;
    for (const auto& [name, value] : error.items())
      row["reference_" + name] = value;
    out_.exactness = sweeps::reference_exactness({&row});
    out_.unconverged_share = error.value("unconverged_share", 0.0);
  }

  void draw_picture(const PictureRecipe& recipe) {
    DrawnPicture picture;
    picture.name = recipe.name;
    picture.label = recipe.label;
    picture.role = recipe.role;
    picture.technique = recipe.technique;
    picture.settings_text = told(recipe.settings, recipe.technique);
    picture.exr = picture.name + ".exr";
    std::vector<std::string> command{"render", out_.scene, "-t", picture.technique};
    add_settings(command, recipe.settings);
    add_place(command, picture.exr);
    Wanted wanted{.command = "render", .recipe = place(), .scene_hash = scene_hash_, .device = options_.made_on};
    wanted.recipe["technique"] = picture.technique;
    wanted.recipe["parameters"].update(parameters_of(recipe));
    wanted.scene_hash = scene_hash_with(recipe.settings);
    std::vector<Product> products{{.path = path(picture.exr), .wanted = wanted, .file = {}, .why = {}}};
    if (!recipe.map.empty()) {
      const std::string maps = picture.name + ".maps";
      picture.native_exr = fmt::format("{}/{}.exr", maps, recipe.map);
      picture.native_png = fmt::format("{}.{}.png", picture.name, recipe.map);
      command.insert(command.end(), {"--maps", path(maps).string()});
      wanted.command = "render --maps";
      products.push_back({.path = path(picture.native_exr), .wanted = std::move(wanted), .file = {}, .why = {}});
    }
    picture.repeat = shown(command);
    make(products, command, options_, picture);
    files_.push_back(std::move(*products.front().file));
    native_.push_back(products.size() > 1 ? std::move(products.back().file) : std::nullopt);
    out_.pictures.push_back(std::move(picture));
  }

  // The techniques' own errors, on one scale of their own.
  void write_native() {
    std::vector<const Image*> maps;
    for (std::size_t i = 0; i < native_.size(); ++i) {
      if (!native_[i]) continue;
      const Image& map = native_[i]->image;
      maps.push_back(&map);
      const json what = attribute(*native_[i], "pellucid.map");
      out_.native_name = what.value("name", "");
      out_.native_doc = what.value("doc", "");
      out_.native_unit = what.value("unit", "");
      double sum = 0, count = 0;
      for (const float value : map.pixels) {
        if (!std::isfinite(value)) continue;
        sum += static_cast<double>(value);
        ++count;
        out_.pictures[i].native_max = std::max(out_.pictures[i].native_max, static_cast<double>(value));
      }
      out_.pictures[i].native_mean = sum / std::max(count, 1.0);
    }
    if (maps.empty()) return;
    out_.native_scale = out_.native_unit.empty() ? 1 : plots::color_range(maps);
    for (std::size_t i = 0; i < native_.size(); ++i) {
      if (native_[i])
        write_png(path(out_.pictures[i].native_png), plots::false_colors(native_[i]->image, out_.native_scale));
    }
  }

  void compare() {
    options_.say("comparing with the reference");
    const sweeps::Comparison comparison(
        truth_.image, nullptr,
        {.metrics = sweeps::MetricSet(std::vector<std::string>{"flip", "rmse"}), .keep_map = true});
    double largest = 0;
    const int width = set_.close_up.width / shrink_, height = set_.close_up.height / shrink_;
    if (set_.close_up_of.empty()) out_.close_up = {set_.close_up.x / shrink_, set_.close_up.y / shrink_, width, height};
    for (std::size_t i = 0; i < files_.size(); ++i) {
      DrawnPicture& picture = out_.pictures[i];
      sweeps::ComparisonResult result = comparison.compare(files_[i].image);
      for (const char* metric : {"flip_mean", "flip_max", "rmse"})
        picture.metrics[metric] = result.at(metric);
      largest = std::max(largest, result.at("flip_max"));
      if (picture.name == set_.close_up_of) {
        out_.close_up = plots::brightest_window(result.flip_map, width, height);
        out_.close_up_of = picture.label.empty() ? picture.name : picture.label;
      }
      ImageFile map;
      map.image = std::move(result.flip_map);
      picture.map_exr = picture.name + ".flip.exr";
      write_exr(path(picture.map_exr), map, ExrPixel::single);
      picture.repeat_map = shown({"compare", path(out_.reference.exr).string(), path(picture.exr).string(), "-m",
                                  "flip,rmse", "--no-mask", "--map", path(picture.map_exr).string()});
      maps_.push_back(std::move(map.image));
    }
    // The maps share one scale, or they could not be told apart; its end is a round number above the largest error.
    out_.map_scale = std::clamp(std::ceil(largest * 20) / 20, 0.05, 1.0);
  }

  void write_plain() {
    out_.reference.png = out_.reference.name + ".png";
    write_picture(path(out_.reference.png), truth_, {});
    for (std::size_t i = 0; i < files_.size(); ++i) {
      DrawnPicture& picture = out_.pictures[i];
      picture.png = picture.name + ".png";
      write_picture(path(picture.png), files_[i], {});
      picture.map_png = picture.name + ".flip.png";
      for (float& value : maps_[i].pixels)
        value = std::min(1.0F, value / static_cast<float>(out_.map_scale));
      write_png(path(picture.map_png), sweeps::error_colors(maps_[i]));
    }
  }

  // Stripes are faint, so the same window is shown with its contrast stretched too, by the reference's range for all.
  void write_close_ups() {
    const gl::DisplayTransform display;
    const auto window_of = [&](const ImageFile& file) {
      Image image = plots::crop(file.image, out_.close_up);
      display.apply(image.pixels, image.channels);
      for (std::size_t i = 3; image.channels == 4 && i < image.pixels.size(); i += 4)
        image.pixels[i] = 1.0F;  // a picture to look at, not to composite
      return image;
    };
    const Image truth = window_of(truth_);
    const plots::Contrast contrast = plots::contrast_for(truth);
    const auto write = [&](const Image& window, DrawnPicture& picture) {
      picture.close_png = picture.name + ".close.png";
      picture.stretched_png = picture.name + ".stretched.png";
      write_png(path(picture.close_png), plots::enlarge(window, out_.enlarged));
      write_png(path(picture.stretched_png), plots::enlarge(plots::stretch(window, contrast), out_.enlarged));
    };
    write(truth, out_.reference);
    for (std::size_t i = 0; i < files_.size(); ++i)
      write(window_of(files_[i]), out_.pictures[i]);
  }

  const PictureSet& set_;
  const PictureOptions& options_;
  int shrink_;
  std::string scene_hash_;
  DrawnPictures out_;
  ImageFile truth_;
  std::vector<ImageFile> files_;  // of the pictures, in their order
  std::vector<Image> maps_;
  std::vector<std::optional<ImageFile>> native_;
};

}  // namespace

DrawnPictures draw_pictures(const PictureSet& set, const PictureOptions& options) {
  return Drawing(set, options).draw();
}

}  // namespace pellucid::sandbox
