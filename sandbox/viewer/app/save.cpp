#include "sandbox/viewer/app/save.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "gl/error.hpp"
#include "sandbox/file_provenance.hpp"

namespace pellucid::sandbox {

ImageFile file_of(const Picture& picture) {
  ImageFile file;
  file.image = picture.image;
  nlohmann::ordered_json origin = file_provenance();
  origin["scene_hash"] = picture.scene_hash;
  origin["device"] = picture.device;
  origin["driver"] = picture.driver;
  file.attributes = file_attributes("render", nlohmann::ordered_json(picture.recipe), origin);
  return file;
}

ImageFile crop_of(const Picture& picture, int x0, int y0, int x1, int y1) {
  const Image& whole = picture.image;
  x0 = std::clamp(x0, 0, whole.width);
  y0 = std::clamp(y0, 0, whole.height);
  x1 = std::clamp(x1, x0, whole.width);
  y1 = std::clamp(y1, y0, whole.height);
  if (x1 == x0 || y1 == y0) throw InputError("no pixel of the picture is seen");
  ImageFile file = file_of(picture);
  file.image = Image(x1 - x0, y1 - y0, whole.channels);
  for (int y = y0; y < y1; ++y)
    std::copy_n(whole.at(x0, y), (x1 - x0) * whole.channels, file.image.at(0, y - y0));
  file.attributes["pellucid.command"] = "view --crop";
  file.attributes["pellucid.crop"] = nlohmann::json({x0, y0, x1, y1}).dump();
  return file;
}

void save_picture(const Picture& picture, const std::filesystem::path& path, const DisplayOptions& display) {
  check_output(path, {".exr", ".png"});
  write_picture(path, file_of(picture), display);
}

std::filesystem::path free_name(const std::filesystem::path& folder, const std::string& stem,
                                const std::string& extension) {
  for (int number = 1;; ++number) {
    const std::filesystem::path path = folder / fmt::format("{}_{:03}{}", stem, number, extension);
    std::error_code error;
    if (!std::filesystem::exists(path, error)) return path;
  }
}

}  // namespace pellucid::sandbox
