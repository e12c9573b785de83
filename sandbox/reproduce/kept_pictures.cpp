#include "sandbox/reproduce/kept_pictures.hpp"

#include <algorithm>
#include <exception>
#include <system_error>

#include "algorithms/scene/files/tell.hpp"
#include "algorithms/scene/images/image.hpp"
#include "gl/display/display.hpp"
#include "gl/error.hpp"
#include "sweeps/workers/point_row.hpp"

namespace pellucid::sandbox {
namespace {

namespace fs = std::filesystem;

constexpr int kThumbnailWidth = 160;

/// Each pixel is the mean of a square of the picture's; colours alone.
Image shrunk(const Image& picture) {
  const int factor = std::max(1, (picture.width + kThumbnailWidth - 1) / kThumbnailWidth);
  Image small(std::max(1, picture.width / factor), std::max(1, picture.height / factor), 3);
  for (int y = 0; y < small.height; ++y) {
    for (int x = 0; x < small.width; ++x) {
      float count = 0;
      for (int v = y * factor; v < std::min((y + 1) * factor, picture.height); ++v) {
        for (int u = x * factor; u < std::min((x + 1) * factor, picture.width); ++u, ++count) {
          for (int c = 0; c < 3; ++c)
            small.at(x, y)[c] += picture.at(u, v)[c];
        }
      }
      for (int c = 0; c < 3; ++c)
        small.at(x, y)[c] /= count;
    }
  }
  return small;
}

bool up_to_date(const fs::path& thumbnail, const fs::path& picture) {
  std::error_code error;
  const auto made = fs::last_write_time(thumbnail, error);
  return !error && made >= fs::last_write_time(picture, error) && !error;
}

}  // namespace

std::vector<KeptPicture> kept_pictures(const sweeps::Plan& plan, const fs::path& store, const fs::path& folder) {
  std::vector<KeptPicture> result;
  std::error_code error;
  for (const sweeps::Point& point : plan.points) {
    if (point.keep == sweeps::Keep::nothing) continue;
    const fs::path picture = sweeps::picture_path(store, point);
    if (!fs::exists(picture, error)) continue;  // of a point that failed
    const fs::path thumbnail = folder / (point.id + ".png");
    try {
      if (!up_to_date(thumbnail, picture)) {
        fs::create_directories(folder);
        Image small = shrunk(read_image(picture).image);
        if (point.keep == sweeps::Keep::exr) gl::DisplayTransform().apply(small.pixels, small.channels);
        write_png(thumbnail, small);
      }
      result.push_back({sweeps::summary_of(point), sweeps::repeat_command(point), picture, thumbnail});
    } catch (const std::exception& e) {
      tell("warning: no thumbnail of '{}': {}", picture.string(), e.what());
    }
  }
  return result;
}

}  // namespace pellucid::sandbox
