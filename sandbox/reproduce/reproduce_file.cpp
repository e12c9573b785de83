#include "sandbox/reproduce/reproduce_file.hpp"

#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "algorithms/scene/images/image.hpp"
#include "gl/error.hpp"
#include "sandbox/reproduce/run_pellucid.hpp"
#include "sandbox/status.hpp"
#include "sweeps/spec/provenance.hpp"

namespace pellucid::sandbox {
namespace {

using nlohmann::json;
using nlohmann::ordered_json;

json attribute(const ImageFile& file, const std::filesystem::path& path, const char* name) {
  const auto found = file.attributes.find(name);
  if (found == file.attributes.end()) {
    throw InputError(fmt::format(
        "{}: no attribute {}: only an EXR that pellucid render or pellucid reference wrote can be made again",
        path.string(), name));
  }
  const json value = json::parse(found->second, nullptr, false);
  if (!value.is_object()) throw InputError(fmt::format("{}: attribute {} is not a JSON object", path.string(), name));
  return value;
}

std::string text(const json& value) {
  return value.is_string() ? value.get<std::string>() : value.dump();
}

// The command line that makes the picture of `recipe`. Values come glued to their options: a file cannot slip in
// options of its own.
std::vector<std::string> arguments(const std::string& command, const json& recipe, const std::filesystem::path& output,
                                   std::optional<int> device) {
  std::vector<std::string> out{
      command, "--view=" + recipe.at("view").get<std::string>(),
      fmt::format("--size={}x{}", recipe.at("width").get<std::int64_t>(), recipe.at("height").get<std::int64_t>()),
      "--output=" + output.string()};
  if (command == "render") {
    out.push_back("--technique=" + recipe.at("technique").get<std::string>());
  } else {
    out.push_back("--surfaces=" + recipe.at("surfaces").get<std::string>());
    out.push_back(fmt::format("--tolerance={}", recipe.at("tolerance").get<double>()));
    out.push_back("--max-steps=" + std::to_string(recipe.at("max_steps").get<std::int64_t>()));
    for (const auto& [field, option] :
         {std::pair{"method", "--method="}, std::pair{"slices", "--slices="}, std::pair{"format", "--format="},
          std::pair{"shadow_share", "--shadow-share="}, std::pair{"samples", "--samples="},
          std::pair{"reflections", "--reflections="}, std::pair{"cut", "--cut="}, std::pair{"caustics", "--caustics="},
          std::pair{"photons", "--photons="}, std::pair{"caustic_radius_m", "--caustic-radius="}}) {
      if (recipe.contains(field)) out.push_back(option + text(recipe.at(field)));
    }
  }
  for (const auto& [name, value] : recipe.at("parameters").items())
    out.push_back("--set=" + name + "=" + text(value));
  if (device) out.push_back("--device=" + std::to_string(*device));
  out.insert(out.end(), {"--", recipe.at("scene").get<std::string>()});
  return out;
}

struct Difference {
  double largest = 0;  ///< of a channel; infinite when one picture has a number where the other has none
  int x = 0, y = 0;
  std::size_t pixels = 0;  ///< that differ in any bit of any channel
  std::string layer;       ///< of the largest; empty for the picture itself
};

void add_difference(const Image& a, const Image& b, const std::string& layer, Difference& out) {
  const auto channels = static_cast<std::size_t>(a.channels);
  for (std::size_t pixel = 0; pixel * channels < a.pixels.size(); ++pixel) {
    const float* p = a.pixels.data() + pixel * channels;
    const float* q = b.pixels.data() + pixel * channels;
    if (std::memcmp(p, q, channels * sizeof(float)) == 0) continue;
    ++out.pixels;
    for (std::size_t c = 0; c < channels; ++c) {
      double distance = std::abs(static_cast<double>(p[c]) - static_cast<double>(q[c]));
      if (std::isnan(distance)) distance = std::isnan(p[c]) && std::isnan(q[c]) ? 0.0 : HUGE_VAL;
      if (distance <= out.largest) continue;
      out.largest = distance;
      out.x = static_cast<int>(pixel % static_cast<std::size_t>(a.width));
      out.y = static_cast<int>(pixel / static_cast<std::size_t>(a.width));
      out.layer = layer;
    }
  }
}

Difference difference(const ImageFile& before, const ImageFile& now, const std::filesystem::path& path) {
  Difference out;
  auto same_shape = [&](const Image& a, const Image& b, const std::string& what) {
    if (a.width != b.width || a.height != b.height || a.channels != b.channels) {
      throw InputError(fmt::format("{}: {} is {}x{} with {} channels, but its recipe makes {}x{} with {}",
                                   path.string(), what, a.width, a.height, a.channels, b.width, b.height, b.channels));
    }
  };
  same_shape(before.image, now.image, "the picture");
  add_difference(before.image, now.image, "", out);
  for (const auto& [name, layer] : before.layers) {
    const auto found = now.layers.find(name);
    if (found == now.layers.end()) {
      throw InputError(fmt::format("{}: its recipe makes no layer {}", path.string(), name));
    }
    same_shape(layer, found->second, "layer " + name);
    add_difference(layer, found->second, name, out);
  }
  return out;
}

// The differences between then and now besides the pixels, each as one line.
std::vector<std::string> changes(const json& then, const json& now) {
  std::vector<std::string> out;
  for (const char* field : {"device", "driver", "version", "commit", "scene_hash"}) {
    const std::string a = text(then.value(field, json())), b = text(now.value(field, json()));
    if (a != b) out.push_back(fmt::format("another {}: {}, now {}", field, a, b));
  }
  if (then.value("dirty", false)) out.emplace_back("it was made by a program with uncommitted changes");
  if (now.value("dirty", false)) out.emplace_back("this program was built with uncommitted changes");
  return out;
}

}  // namespace

int reproduce_file(const FileOptions& options) {
  const ImageFile before = read_image(options.file);
  const json recipe = attribute(before, options.file, "pellucid.recipe");
  const json then = attribute(before, options.file, "pellucid.provenance");
  const auto command = before.attributes.find("pellucid.command");
  if (command == before.attributes.end() || (command->second != "render" && command->second != "reference")) {
    throw InputError(
        fmt::format("{}: attribute pellucid.command is neither render nor reference", options.file.string()));
  }

  std::error_code error;
  std::filesystem::create_directories(options.folder, error);
  if (error) throw RuntimeError(fmt::format("cannot make {}: {}", options.folder.string(), error.message()));
  const std::filesystem::path output = options.folder / options.file.filename();
  if (std::filesystem::equivalent(output, options.file, error)) {
    throw InputError(
        fmt::format("-o {}: the new picture would overwrite {}", options.folder.string(), options.file.string()));
  }

  std::vector<std::string> words;
  try {
    words = arguments(command->second, recipe, output, options.device);
  } catch (const json::exception&) {
    throw InputError(
        fmt::format("{}: attribute pellucid.recipe lacks what {} needs", options.file.string(), command->second));
  }
  try {
    run_pellucid(words);
  } catch (const InputError& e) {
    throw InputError(fmt::format("{}: its recipe cannot be made again: {}", options.file.string(), e.what()));
  }

  const ImageFile after = read_image(output);
  const json now = attribute(after, output, "pellucid.provenance");
  const Difference found = difference(before, after, options.file);
  const bool identical = found.pixels == 0;
  const bool within = found.largest <= options.tolerance;
  bool comparable = true;
  for (const char* field : {"device", "driver", "commit"})
    comparable = comparable && then.value(field, json()) == now.value(field, json());
  const char* verdict = identical ? "identical" : within ? "within tolerance" : comparable ? "differs" : "not judged";
  const std::vector<std::string> notes = changes(then, now);
  words.insert(words.begin(), "pellucid");

  if (options.json) {
    ordered_json out{
        {"file", options.file.string()},
        {"output", output.string()},
        {"command", sweeps::shell_line(words)},
        {"verdict", verdict},
        {"bit_identical", identical},
        {"max_abs_difference", std::isfinite(found.largest) ? ordered_json(found.largest) : ordered_json(nullptr)},
        {"different_pixels", found.pixels},
        {"tolerance", options.tolerance},
        {"same_device_driver_commit", comparable},
        {"changes", notes},
        {"recipe", recipe},
        {"provenance", {{"then", then}, {"now", now}}}};
    fmt::print("{}\n", out.dump(2));
  } else {
    const std::string layer = found.layer.empty() ? "" : " of layer " + found.layer;
    fmt::print("{}\n", output.string());
    if (identical) {
      fmt::print("bit-identical to {}\n", options.file.string());
    } else {
      fmt::print("max abs difference {:.6g} at pixel ({}, {}){}; {} pixels differ; tolerance {:.6g}: {}\n",
                 found.largest, found.x, found.y, layer, found.pixels, options.tolerance, verdict);
    }
    for (const std::string& note : notes)
      fmt::print("{}\n", note);
  }
  return !within && comparable ? kRegression : kDone;
}

}  // namespace pellucid::sandbox
