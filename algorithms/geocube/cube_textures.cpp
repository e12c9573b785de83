#include "algorithms/geocube/cube_textures.hpp"

#include <algorithm>
#include <cstddef>
#include <span>
#include <string>

#include <fmt/format.h>
#include <unistd.h>

#include "algorithms/geocube/search.hpp"
#include "algorithms/scene/files/tell.hpp"
#include "gl/error.hpp"

namespace pellucid::geocube {
namespace {

constexpr float kTableFar = 16.0F;  // farther than any step that matters; infinity would spoil its neighbours

// The most that the device may hold: its own memory where it tells, else half of the machine's.
std::size_t device_bytes() {
  if (epoxy_has_gl_extension("GL_NVX_gpu_memory_info")) {
    GLint kib = 0;
    glGetIntegerv(0x9047, &kib);  // GPU_MEMORY_INFO_DEDICATED_VIDMEM_NVX
    if (kib > 0) return static_cast<std::size_t>(kib) * 1024;
  }
  return static_cast<std::size_t>(sysconf(_SC_PHYS_PAGES)) * static_cast<std::size_t>(sysconf(_SC_PAGE_SIZE)) / 2;
}

gl::Texture make_map(const std::string& label, const CubeSet& set, std::vector<glm::vec4> CubeLayer::*texels) {
  const CubeGrid grid = set.grid();
  const int size = grid.n() + 2, layers = set.options.layers;
  const int faces = static_cast<int>(set.cubes.size()) * layers * 6;
  gl::Texture texture = gl::Texture::make_2d_array(label, gl::Format::rgba32f, size, size, faces);
  const auto face_floats = static_cast<std::size_t>(size) * static_cast<std::size_t>(size) * 4;
  int at = 0;
  for (const Cube& cube : set.cubes) {
    for (const CubeLayer& layer : cube.layers) {
      const std::vector<glm::vec4>& values = layer.*texels;
      const std::vector<float> faces_of_layer =
          values.empty() ? std::vector<float>(6 * face_floats) : with_borders(grid, values);
      for (std::size_t face = 0; face < 6; ++face)
        texture.upload_layer(at++, std::span(faces_of_layer).subspan(face * face_floats, face_floats));
    }
  }
  texture.set_sampling(gl::Filter::linear, gl::Wrap::clamp);
  return texture;
}

}  // namespace

std::vector<float> with_borders(const CubeGrid& grid, const std::vector<glm::vec4>& texels) {
  const int n = grid.n(), size = n + 2;
  std::vector<float> result;
  result.reserve(6 * static_cast<std::size_t>(size) * static_cast<std::size_t>(size) * 4);
  const auto texel = [&](int face, int x, int y) {
    const bool inside = x >= 0 && x < n && y >= 0 && y < n;
    const CubeTexel t{face, x, y};
    return texels[grid.index(inside ? t : grid.nearest(grid.direction(t)))];
  };
  for (int face = 0; face < 6; ++face) {
    for (int y = -1; y <= n; ++y) {
      for (int x = -1; x <= n; ++x) {
        const int cx = std::clamp(x, 0, n - 1), cy = std::clamp(y, 0, n - 1);
        const glm::vec4 value = cx != x && cy != y
                                    ? (texel(face, cx, cy) + texel(face, x, cy) + texel(face, cx, y)) / 3.0F
                                    : texel(face, x, y);
        for (int c = 0; c < 4; ++c)
          result.push_back(value[c]);
      }
    }
  }
  return result;
}

CubeTextures::CubeTextures(const std::string& label, const CubeSet& set) : set_(set) {
  const std::size_t bytes = texture_bytes(set.options, set.cubes.size()), limit = device_bytes();
  if (bytes > limit) {
    throw InputError(fmt::format("geocube: {} of {} texels and {} take {} MiB of textures; the device has {} MiB",
                                 counted(set.cubes.size(), "cube"), set.options.resolution,
                                 counted(static_cast<std::size_t>(set.options.layers), "layer"), bytes >> 20U,
                                 limit >> 20U));
  }
  bounds_ = make_map(label + " bounds", set, &CubeLayer::bounds);
  planes_ = make_map(label + " planes", set, &CubeLayer::planes);
  if (set.options.layers > 1) inners_ = make_map(label + " inner planes", set, &CubeLayer::inners);
}

void CubeTextures::bind(const gl::Program& program) const {
  bounds_.bind(1);
  planes_.bind(2);
  if (inners_) inners_.bind(4);
  program.set("cube_count", static_cast<int>(set_.cubes.size()));
  program.set("cube_layers", set_.options.layers);
  for (std::size_t i = 0; i < set_.cubes.size(); ++i)
    program.set(fmt::format("cube_spheres[{}]", i), glm::vec4(set_.cubes[i].center, set_.cubes[i].sphere));
}

gl::Texture make_function_table(int size) {
  std::vector<float> texels;
  texels.reserve(static_cast<std::size_t>(size) * static_cast<std::size_t>(size) * 2);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const float first = static_cast<float>(x) / static_cast<float>(size - 1);
      const float gamma = 2.0F * static_cast<float>(y) / static_cast<float>(size - 1) - 1.0F;
      texels.push_back(std::min(cone_wall(first, gamma), kTableFar));
      texels.push_back(sphere_step(first, gamma));
    }
  }
  gl::Texture table = gl::Texture::make_2d("geocube functions", gl::Format::rg32f, size, size);
  table.upload(texels);
  table.set_sampling(gl::Filter::linear, gl::Wrap::clamp);
  return table;
}

}  // namespace pellucid::geocube
