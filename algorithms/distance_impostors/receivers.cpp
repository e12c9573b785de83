// Szirmay-Kalos et al. 2005 (references.bib: szirmaykalos2005), Sec. 5: what caustics fall on.
#include "algorithms/distance_impostors/receivers.hpp"

#include <cmath>
#include <cstddef>
#include <cstring>
#include <span>

#include <fmt/format.h>

#include "algorithms/distance_impostors/light_map_chart.hpp"
#include "algorithms/raster/object_vertices.hpp"

namespace pellucid::distance_impostors {
namespace {

constexpr int kPartsPerUnit = 1024;  // a receiver's part is coded behind the binary point of its number
constexpr int kMargin = 2;           // texels around a part

}  // namespace

std::vector<std::string> Receivers::prepare(const Scene& scene, int light_map_size) {
  receivers_.clear();
  std::vector<std::string> warnings;
  int left_out = 0;
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const Instance& instance = scene.instances[i];
    if (optical(scene, instance)) continue;
    const auto chart = make_chart(scene.meshes[static_cast<std::size_t>(instance.mesh)], light_map_size, kMargin);
    if (!chart) {
      warnings.push_back(fmt::format("'{}' receives no caustic: its texture coordinates do not keep its surface apart",
                                     scene.meshes[static_cast<std::size_t>(instance.mesh)].name));
    } else if (receivers_.size() < static_cast<std::size_t>(kMost)) {
      add(scene, static_cast<int>(i), *chart);
    } else {
      ++left_out;
    }
  }
  if (left_out > 0)
    warnings.push_back(fmt::format("{} opaque objects beyond the first {} receive no caustic", left_out, kMost));
  return warnings;
}

void Receivers::add(const Scene& scene, int instance, const LightMapChart& chart) {
  const Instance& object = scene.instances[static_cast<std::size_t>(instance)];
  const Mesh& mesh = scene.meshes[static_cast<std::size_t>(object.mesh)];
  std::vector<ObjectVertex> vertices(mesh.positions.size());
  const auto number = static_cast<float>(receivers_.size());
  // Where a normal would be: the place in the light map, and receiver and part in one number.
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const float part = static_cast<float>(chart.parts[i]) / static_cast<float>(kPartsPerUnit);
    vertices[i] = {mesh.positions[i], glm::vec3(chart.places[i], number + part),
                   mesh.colors.empty() ? glm::vec3(1) : mesh.colors[i]};
  }
  Receiver& receiver = receivers_.emplace_back();
  receiver.instance = instance;
  receiver.places = chart.places;
  receiver.index_count = static_cast<int>(mesh.triangles.size() * 3);
  receiver.vertices = gl::Buffer("receiver vertices", std::span<const ObjectVertex>(vertices));
  receiver.indices = gl::Buffer("receiver indices", std::span<const glm::uvec3>(mesh.triangles));
  receiver.attributes = gl::Buffer("receiver attributes", sizeof(InstanceAttributes), GL_DYNAMIC_DRAW);
  receiver.unshaded = gl::Buffer("receiver place", sizeof(InstanceAttributes), GL_DYNAMIC_DRAW);
  receiver.densities = gl::Buffer("receiver densities", vertices.size() * sizeof(ObjectVertex), GL_DYNAMIC_DRAW);
  receiver.array = make_object_array("receiver", receiver.vertices, receiver.indices, receiver.attributes);
  receiver.place_array = make_object_array("receiver", receiver.densities, receiver.indices, receiver.unshaded);
}

void Receivers::place(const Scene& scene) {
  for (std::size_t r = 0; r < receivers_.size(); ++r) {
    Receiver& receiver = receivers_[r];
    const Instance& instance = scene.instances[static_cast<std::size_t>(receiver.instance)];
    InstanceAttributes attributes;
    attributes.to_world = instance.to_world;
    attributes.albedo = glm::vec3(1);
    receiver.unshaded.upload(std::span<const InstanceAttributes>(&attributes, 1));
    attributes.albedo = material_of(scene, instance).albedo * instance.tint;
    receiver.attributes.upload(std::span<const InstanceAttributes>(&attributes, 1));
    if (const glm::mat3 axes(instance.to_world); axes != receiver.axes) measure_density(scene, receiver, axes);
  }
}

// About a vertex: the area of its triangles over the area that they take of the light map.
void Receivers::measure_density(const Scene& scene, Receiver& receiver, const glm::mat3& axes) {
  const Instance& instance = scene.instances[static_cast<std::size_t>(receiver.instance)];
  const Mesh& mesh = scene.meshes[static_cast<std::size_t>(instance.mesh)];
  std::vector<double> area(mesh.positions.size(), 0), taken(mesh.positions.size(), 0);
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::vec3 ab = axes * (mesh.positions[t.y] - mesh.positions[t.x]);
    const glm::vec3 ac = axes * (mesh.positions[t.z] - mesh.positions[t.x]);
    const glm::vec2 uv = receiver.places[t.y] - receiver.places[t.x], uw = receiver.places[t.z] - receiver.places[t.x];
    for (int i = 0; i < 3; ++i) {
      area[t[i]] += static_cast<double>(glm::length(glm::cross(ab, ac)));
      taken[t[i]] += static_cast<double>(std::abs(uv.x * uw.y - uv.y * uw.x));
    }
  }
  std::vector<ObjectVertex> vertices(mesh.positions.size());
  const std::vector<std::byte> drawn = receiver.vertices.read();
  std::memcpy(vertices.data(), drawn.data(), drawn.size());
  for (std::size_t i = 0; i < vertices.size(); ++i)
    vertices[i].color = glm::vec3(taken[i] > 0 ? static_cast<float>(area[i] / taken[i]) : 0.0F);
  receiver.densities.upload(std::span<const ObjectVertex>(vertices));
  receiver.axes = axes;
}

void Receivers::draw(gl::VertexArray Receiver::*array, int copies) const {
  constexpr GLuint kInstanceBinding = 1;
  for (const Receiver& receiver : receivers_) {
    (receiver.*array).bind();
    glVertexArrayBindingDivisor((receiver.*array).id(), kInstanceBinding, static_cast<GLuint>(copies));
    glDrawElementsInstanced(GL_TRIANGLES, receiver.index_count, GL_UNSIGNED_INT, nullptr, copies);
  }
}

std::vector<int> Receivers::instances() const {
  std::vector<int> instances;
  for (const Receiver& receiver : receivers_)
    instances.push_back(receiver.instance);
  return instances;
}

}  // namespace pellucid::distance_impostors
