#include "algorithms/scene/images/environment_layout.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <glm/glm.hpp>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "gl/error.hpp"

namespace pellucid {
namespace {

constexpr int kWidest = 16384;

/// A cube's face as it is seen from inside.
struct Face {
  glm::dvec3 forward, right, up;
};
constexpr std::array<Face, 6> kFaces{{{{1, 0, 0}, {0, 0, 1}, {0, 1, 0}},
                                      {{-1, 0, 0}, {0, 0, -1}, {0, 1, 0}},
                                      {{0, 1, 0}, {1, 0, 0}, {0, 0, 1}},
                                      {{0, -1, 0}, {1, 0, 0}, {0, 0, -1}},
                                      {{0, 0, 1}, {-1, 0, 0}, {0, 1, 0}},
                                      {{0, 0, -1}, {1, 0, 0}, {0, 1, 0}}}};

/// Where the faces lie in the picture: columns and rows of faces, and which of them are upside down.
struct Faces {
  int side = 0;
  std::array<glm::ivec2, 6> at{};
  bool back_turned = false;  ///< +z, in a 3:4 cross
  bool centres_on_edges = false;
};

int face_of(const glm::dvec3& d) {
  const glm::dvec3 a = glm::abs(d);
  if (a.x >= a.y && a.x >= a.z) return d.x > 0 ? 0 : 1;
  if (a.y >= a.z) return d.y > 0 ? 2 : 3;
  return d.z > 0 ? 4 : 5;
}

glm::vec4 bilinear(const Image& image, glm::dvec2 at, const glm::ivec2& low, const glm::ivec2& high) {
  at = glm::clamp(at, glm::dvec2(low), glm::dvec2(high));
  const glm::ivec2 first(at);
  const glm::ivec2 second = glm::min(first + 1, high);
  const glm::vec2 share(at - glm::dvec2(first));
  const auto texel = [&](int x, int y) {
    glm::vec4 out(0.0F);
    for (int c = 0; c < image.channels; ++c)
      out[c] = image.at(x, y)[c];
    return out;
  };
  return glm::mix(glm::mix(texel(first.x, first.y), texel(second.x, first.y), share.x),
                  glm::mix(texel(first.x, second.y), texel(second.x, second.y), share.x), share.y);
}

glm::vec4 on_cube(const Image& image, const Faces& faces, const glm::dvec3& direction) {
  const int number = face_of(direction);
  const Face& face = kFaces[static_cast<std::size_t>(number)];
  const double depth = glm::dot(direction, face.forward);
  glm::dvec2 place(glm::dot(direction, face.right) / depth, -glm::dot(direction, face.up) / depth);  // −1…1, downwards
  if (number == 4 && faces.back_turned) place = -place;
  const glm::dvec2 share = (place + 1.0) / 2.0;
  const glm::dvec2 pixel = faces.centres_on_edges ? share * (faces.side - 1.0) : share * double(faces.side) - 0.5;
  const glm::ivec2 low = faces.at[static_cast<std::size_t>(number)] * faces.side;
  return bilinear(image, glm::dvec2(low) + pixel, low, low + faces.side - 1);
}

glm::vec4 on_disc(const Image& image, bool mirrored, const glm::dvec3& d) {
  glm::dvec2 place(0.0);  // −1…1, upwards
  if (mirrored) {
    // The ball's normal lies half-way between the direction and the viewer's, +z.
    const glm::dvec3 half = d + glm::dvec3(0, 0, 1);
    const double length = glm::length(half);
    place = length > 1e-9 ? glm::dvec2(half) / length : glm::dvec2(1, 0);
  } else {
    const double across = glm::length(glm::dvec2(d));
    const double angle = std::atan2(across, -d.z);
    place = across > 1e-12 ? glm::dvec2(d) * (angle / (std::numbers::pi * across)) : glm::dvec2(angle > 1 ? 1 : 0, 0);
  }
  const glm::dvec2 pixel((place.x + 1) / 2 * image.width - 0.5, (1 - place.y) / 2 * image.height - 0.5);
  return bilinear(image, pixel, glm::ivec2(0), glm::ivec2(image.width - 1, image.height - 1));
}

/// Calls `radiance(direction)` for each pixel of a lat-long picture.
template <class F>
Image resample(int width, int channels, F&& radiance) {
  width = std::min(width, kWidest);
  Image out(width, width / 2, channels);
  tbb::parallel_for(tbb::blocked_range<int>(0, out.height), [&](const tbb::blocked_range<int>& rows) {
    for (int y = rows.begin(); y < rows.end(); ++y) {
      const double polar = std::numbers::pi * (y + 0.5) / out.height;
      for (int x = 0; x < out.width; ++x) {
        const double azimuth = 2 * std::numbers::pi * ((x + 0.5) / out.width - 0.5);
        const glm::dvec3 d(std::sin(polar) * std::sin(azimuth), std::cos(polar), -std::sin(polar) * std::cos(azimuth));
        const glm::vec4 value = radiance(d);
        for (int c = 0; c < channels; ++c)
          out.at(x, y)[c] = value[c];
      }
    }
  });
  return out;
}

/// Throws unless the picture has the shape across:down.
int side_of(const Image& image, int across, int down, std::string_view name) {
  if (image.width % across == 0 && image.height % down == 0 && image.width / across == image.height / down)
    return image.width / across;
  throw InputError(
      fmt::format("{}x{} pixels are no {}, which is {}:{}", image.width, image.height, name, across, down));
}

Faces strip_of(const PictureFile& file) {
  Faces faces;
  const bool across = file.image.width > file.image.height;
  faces.side =
      across ? side_of(file.image, 6, 1, "strip of cube faces") : side_of(file.image, 1, 6, "strip of cube faces");
  for (int i = 0; i < 6; ++i)
    faces.at[static_cast<std::size_t>(i)] = across ? glm::ivec2(i, 0) : glm::ivec2(0, i);
  faces.centres_on_edges = file.envmap == PictureFile::Envmap::cube && faces.side > 1;
  return faces;
}

Faces cross_of(const PictureFile& file) {
  Faces faces;
  const bool lying = file.image.width > file.image.height;
  faces.side =
      lying ? side_of(file.image, 4, 3, "cross of cube faces") : side_of(file.image, 3, 4, "cross of cube faces");
  faces.at = {{{2, 1}, {0, 1}, {1, 0}, {1, 2}, lying ? glm::ivec2(3, 1) : glm::ivec2(1, 3), {1, 1}}};
  faces.back_turned = !lying;
  return faces;
}

bool has_shape(const PictureFile& file, double across, double down) {
  return std::abs(file.image.width * file.pixel_aspect * down - file.image.height * across) <=
         0.01 * file.image.height * across;
}

void check_lat_long(const PictureFile& file, bool stated, std::vector<std::string>& warnings) {
  const std::string size = size_text(file);
  if (has_shape(file, 2, 1)) return;
  if (stated) {
    warnings.push_back(
        fmt::format("{} are not 2:1, the shape of a lat-long environment; it is stretched over the sphere", size));
    return;
  }
  if (has_shape(file, 1, 1))
    throw InputError(
        fmt::format("{} are 1:1, the shape of a mirror ball or an angular probe and not of a lat-long "
                    "environment (2:1); say layout = \"mirror_ball\", \"angular\" or \"lat_long\"",
                    size));
  for (const auto& [across, down] : {std::pair(1, 6), std::pair(6, 1)}) {
    if (has_shape(file, across, down))
      throw InputError(
          fmt::format("{} are {}:{}, the shape of six cube faces and not of a lat-long environment (2:1); "
                      "say layout = \"cube_strip\" or \"lat_long\"",
                      size, across, down));
  }
  const bool cross = has_shape(file, 4, 3) || has_shape(file, 3, 4);
  warnings.push_back(
      fmt::format("{} are not 2:1, the shape of a lat-long environment; it is stretched over the sphere{}", size,
                  cross ? " (a cross of cube faces is read with layout = \"cube_cross\")" : ""));
}

/// Finite, not above `most`; below 0, as ringing filters and other primaries leave them, becomes 0.
void check_radiance(PictureFile& file, double most, std::vector<std::string>& warnings) {
  Image& image = file.image;
  const int colors = std::min(image.channels, 3);
  std::size_t negative = 0;
  float lowest = 0;
  for (std::size_t i = 0; i < image.pixels.size(); i += static_cast<std::size_t>(image.channels)) {
    for (int c = 0; c < colors; ++c) {
      float& v = image.pixels[i + static_cast<std::size_t>(c)];
      if (!std::isfinite(v)) throw InputError("it has a pixel that is not finite");
      if (static_cast<double>(v) > most)
        throw InputError(fmt::format("it has a pixel of radiance {:.4g}; at most {:.4g} is read", v, most));
      if (v >= 0) continue;
      lowest = std::min(lowest, v);
      ++negative;
      v = 0;
    }
  }
  if (negative > 0)
    warnings.push_back(
        fmt::format("{} of its values are below 0, down to {:.3g}; they are taken for 0", negative, lowest));
}

/// Alpha is of no use, and may hold anything.
Image without_alpha(Image image) {
  if (image.channels != 4) return image;
  const std::size_t count = image.pixels.size() / 4;
  for (std::size_t i = 1; i < count; ++i)  // in place: a large picture has no room for a second one
    for (std::size_t c = 0; c < 3; ++c)
      image.pixels[3 * i + c] = image.pixels[4 * i + c];
  image.pixels.resize(3 * count);
  image.channels = 3;
  return image;
}

}  // namespace

Image to_lat_long(PictureFile file, std::optional<EnvironmentLayout> layout, double most,
                  std::vector<std::string>& warnings) {
  warnings.insert(warnings.end(), file.notes.begin(), file.notes.end());
  file.image = without_alpha(std::move(file.image));
  check_radiance(file, most, warnings);
  if (file.data_window != file.display_window)
    warnings.push_back(fmt::format("it stores a part of its picture only, {}; the rest is black", size_text(file)));
  const bool stated = layout.has_value() || file.envmap == PictureFile::Envmap::lat_long;
  if (!layout && file.envmap == PictureFile::Envmap::cube) layout = EnvironmentLayout::cube_strip;
  const Image& image = file.image;
  switch (layout.value_or(EnvironmentLayout::lat_long)) {
    case EnvironmentLayout::lat_long:
      check_lat_long(file, stated, warnings);
      break;
    case EnvironmentLayout::cube_strip:
    case EnvironmentLayout::cube_cross: {
      const Faces faces = layout == EnvironmentLayout::cube_cross ? cross_of(file) : strip_of(file);
      return resample(4 * faces.side, image.channels, [&](const glm::dvec3& d) { return on_cube(image, faces, d); });
    }
    case EnvironmentLayout::mirror_ball:
    case EnvironmentLayout::angular: {
      if (!has_shape(file, 1, 1)) throw InputError(fmt::format("{} are not 1:1, the shape of a ball", size_text(file)));
      const bool mirrored = layout == EnvironmentLayout::mirror_ball;
      return resample(2 * image.height, image.channels,
                      [&](const glm::dvec3& d) { return on_disc(image, mirrored, d); });
    }
  }
  return std::move(file.image);
}

}  // namespace pellucid
