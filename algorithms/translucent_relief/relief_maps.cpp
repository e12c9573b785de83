#include "algorithms/translucent_relief/relief_maps.hpp"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <numeric>
#include <span>
#include <string>
#include <vector>

#include "algorithms/scene/meshes/tangents.hpp"
#include "algorithms/translucent_relief/height_pyramid.hpp"

namespace pellucid::translucent_relief {
namespace {

int level_count(const Image& image) {
  return static_cast<int>(std::bit_width(static_cast<unsigned>(std::max(image.width, image.height))));
}

gl::Texture make_map(const char* label, gl::Format format, const Image& image, int levels = 1) {
  gl::Texture texture = gl::Texture::make_2d(label, format, image.width, image.height, levels);
  const auto channels = static_cast<std::size_t>(gl::channels(format)),
             given = static_cast<std::size_t>(image.channels);
  std::vector<float> texels(image.pixels.size() / given * channels, 0.0F);
  for (std::size_t i = 0; i < texels.size() / channels; ++i) {
    for (std::size_t c = 0; c < std::min(channels, given); ++c)
      texels[i * channels + c] = image.pixels[i * given + c];
  }
  texture.upload(texels);
  texture.set_sampling(gl::Filter::linear, gl::Wrap::repeat);
  return texture;
}

struct Vertex {
  glm::vec3 position, normal, color;
  glm::vec2 uv;
  glm::vec3 over_u, over_v;
};

}  // namespace

void ReliefMaps::upload(const ReliefLayer& from, Search search, Animation* animation, Layer& to) {
  if (from.motion && !from.normal_map && animation != nullptr) {
    const auto fit = [&](gl::Texture& map, const char* label, gl::Format format) {
      if (map && map.format() == format && map.width() == from.heights.width && map.height() == from.heights.height)
        return;
      map = gl::Texture::make_2d(label, format, from.heights.width, from.heights.height);
      map.set_sampling(gl::Filter::linear, gl::Wrap::repeat);
    };
    fit(to.heights, "relief heights", gl::Format::r32f);
    fit(to.normals, "relief normals", gl::Format::rg32f);
    animation->run(*from.motion, to.heights, to.normals);
    return;
  }
  to.heights = make_map("relief heights", gl::Format::r32f, from.heights);
  to.normals = make_map("relief normals", from.normal_map ? gl::Format::rgba32f : gl::Format::rg32f, from.normals);
  to.acceleration = {};
  if (search == Search::max_mip) {
    const std::vector<Image> levels = height_pyramid(from.heights);
    to.acceleration = gl::Texture::make_2d("relief extremes", gl::Format::rg32f, from.heights.width,
                                           from.heights.height, static_cast<int>(levels.size()));
    for (std::size_t i = 0; i < levels.size(); ++i)
      to.acceleration.upload(levels[i].pixels, static_cast<int>(i));
  } else if (search == Search::cone_step) {
    to.acceleration = make_map("relief cones", gl::Format::r32f, cone_map(from.heights));
  } else if (search == Search::relaxed_cone_step) {
    to.acceleration = make_map("relief cones", gl::Format::rg32f, relaxed_cone_map(from.heights));
  }
}

void ReliefMaps::update(const Relief& relief, Search search, Animation* animation) {
  if (relief.scatters()) transfer_.update(relief);
  if (revision_ == relief.maps_revision && solid_.heights) return;
  revision_ = relief.maps_revision;
  upload(relief.solid, search, animation, solid_);
  if (relief.translucent) upload(*relief.translucent, search, animation, medium_);
  Image white(1, 1, 3);
  white.pixels = {1, 1, 1};
  const Image& colors = relief.solid.colors.width > 0 ? relief.solid.colors : white;
  colors_ = make_map("relief colours", gl::Format::rgba32f, colors, level_count(colors));
  colors_.generate_mipmaps();
  colors_.set_sampling(gl::Filter::mipmap, gl::Wrap::repeat);
  if (relief.air) {
    air_ = gl::Texture::make_3d("relief air", gl::Format::r32f, relief.air->size.x, relief.air->size.y,
                                relief.air->size.z);
    air_.upload(relief.air->index2);
    air_.set_sampling(gl::Filter::linear, gl::Wrap::repeat);
  }
  const std::vector<float>& heights = relief.solid.heights.pixels;
  mean_solid_ =
      static_cast<float>(std::accumulate(heights.begin(), heights.end(), 0.0) / static_cast<double>(heights.size()));
}

void ReliefMaps::bind(const Relief& relief, const gl::Program& program) const {
  solid_.heights.bind(3);
  solid_.normals.bind(5);
  colors_.bind(7);
  if (solid_.acceleration) solid_.acceleration.bind(8);
  const auto range = [](const ReliefLayer& layer) { return glm::vec2(layer.low_m, layer.high_m - layer.low_m); };
  program.set("solid_range", range(relief.solid));
  program.set("solid_normal_map", relief.solid.normal_map);
  program.set("tiling", relief.tiling);
  program.set("cut", relief.cut);
  if (relief.air) {
    air_.bind(10);
    program.set("air_height", relief.air->height_m);
  }
  if (!relief.translucent) return;
  if (relief.scatters()) transfer_.bind(relief, program);
  medium_.heights.bind(4);
  medium_.normals.bind(6);
  if (medium_.acceleration) medium_.acceleration.bind(9);
  program.set("medium_range", range(*relief.translucent));
  program.set("medium_normal_map", relief.translucent->normal_map);
}

float ReliefMaps::mean_solid_height_m(const Relief& relief) const {
  return glm::mix(relief.solid.low_m, relief.solid.high_m, mean_solid_);
}

ReliefMesh::ReliefMesh(const Mesh& mesh, const std::string& what) {
  const Tangents tangents = tangents_of(mesh, what);
  std::vector<Vertex> vertices(mesh.positions.size());
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    vertices[i] = {mesh.positions[i], mesh.normals[i], mesh.colors.empty() ? glm::vec3(1.0F) : mesh.colors[i],
                   mesh.uvs[i],       tangents.u[i],   tangents.v[i]};
  }
  vertices_ = gl::Buffer(mesh.name + " relief vertices", std::span<const Vertex>(vertices));
  indices_ = gl::Buffer(mesh.name + " relief indices", std::span<const glm::uvec3>(mesh.triangles));
  array_ = gl::VertexArray(mesh.name + " relief", vertices_, sizeof(Vertex),
                           {{0, 3, offsetof(Vertex, position)},
                            {1, 3, offsetof(Vertex, normal)},
                            {2, 3, offsetof(Vertex, color)},
                            {3, 2, offsetof(Vertex, uv)},
                            {4, 3, offsetof(Vertex, over_u)},
                            {5, 3, offsetof(Vertex, over_v)}},
                           &indices_);
  index_count_ = static_cast<int>(mesh.triangles.size() * 3);
}

void ReliefMesh::draw() const {
  array_.bind();
  glDrawElements(GL_TRIANGLES, index_count_, GL_UNSIGNED_INT, nullptr);
}

}  // namespace pellucid::translucent_relief
