#include "sandbox/arguments.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <fstream>

#include <fmt/format.h>

#include "algorithms/scene/images/picture_file.hpp"
#include "gl/display/display.hpp"
#include "gl/error.hpp"

namespace pellucid::sandbox {

std::pair<std::string, std::string> parse_assignment(const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0) {
    throw InputError(fmt::format("-s {} is not name=value, for example hulls=4", text));
  }
  return {text.substr(0, equals), text.substr(equals + 1)};
}

void check_output(const std::filesystem::path& path, std::initializer_list<std::string_view> extensions) {
  const std::string extension = path.extension().string();
  if (std::find(extensions.begin(), extensions.end(), extension) == extensions.end()) {
    throw InputError(fmt::format("-o {}: the name must end in {}", path.string(), fmt::join(extensions, " or ")));
  }
  const std::filesystem::path folder = path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
  std::error_code error;
  if (!std::filesystem::is_directory(folder, error)) {
    throw RuntimeError(fmt::format("cannot write {}: {} is not a folder", path.string(), folder.string()));
  }
}

void check_no_input(const std::filesystem::path& output, const std::filesystem::path& input, std::string_view option) {
  std::error_code error;
  if (!input.empty() && std::filesystem::equivalent(output, input, error) && !error)
    throw InputError(fmt::format("{} {}: it would overwrite what is read", option, output.string()));
}

std::vector<std::string> process_arguments() {
  std::ifstream file("/proc/self/cmdline", std::ios::binary);
  std::vector<std::string> arguments;
  for (std::string argument; std::getline(file, argument, '\0');)
    arguments.push_back(argument);
  return arguments;
}

void write_picture(const std::filesystem::path& path, const ImageFile& file, const DisplayOptions& options) {
  if (path.extension() == ".exr") {
    write_exr(path, file, exact_pixel(file.image));
    return;
  }
  Image image = file.image;
  const float gain = std::exp2(static_cast<float>(options.exposure_ev));
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      float* pixel = image.at(x, y);
      for (int c = 0; c < std::min(image.channels, 3); ++c)
        pixel[c] *= gain;
      if (image.channels == 4) pixel[3] = 1.0F;  // a picture to look at, not to composite
    }
  }
  gl::DisplayTransform(options.display, options.view, options.look).apply(image.pixels, image.channels);
  write_png(path, image, file.attributes);
}

}  // namespace pellucid::sandbox
