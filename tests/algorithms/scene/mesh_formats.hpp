#pragma once

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <glm/glm.hpp>
#include <gtest/gtest.h>

#include "algorithms/scene/meshes/mesh_file.hpp"
#include "tests/algorithms/scene/folder_test.hpp"

namespace pellucid::test {

/// A box of 1 x 0.6 x 0.4 in every dialect of every format.
inline const std::vector<glm::dvec3> kBoxCorners = {{-0.5, -0.3, -0.2}, {-0.5, -0.3, 0.2}, {-0.5, 0.3, -0.2},
                                                    {-0.5, 0.3, 0.2},   {0.5, -0.3, -0.2}, {0.5, -0.3, 0.2},
                                                    {0.5, 0.3, -0.2},   {0.5, 0.3, 0.2}};
inline const std::vector<std::vector<int>> kBoxSides = {{0, 1, 3, 2}, {4, 6, 7, 5}, {0, 4, 5, 1},
                                                        {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 5, 7, 3}};

class MeshFormats : public FolderTest {
 protected:
  std::string refusal(std::string_view name, const std::string& content) {
    const auto path = write(name, content);
    const std::string message = message_of([&] { load_mesh_file(path, 60); });
    const std::string begin = "cannot read mesh '" + path.string() + "': ";
    EXPECT_TRUE(message.starts_with(begin)) << message;
    return message.substr(std::min(begin.size(), message.size()));
  }
  /// The whole box, its triangles outward, with flat normals.
  MeshFile expect_box(std::string_view name, const std::string& content, double tolerance = 1e-6) {
    SCOPED_TRACE(name);
    return expect_box_in(write(name, content), tolerance);
  }
  static MeshFile expect_box_in(const std::filesystem::path& path, double tolerance = 1e-6) {
    MeshFile file = load_mesh_file(path, 60);
    const Mesh& mesh = file.mesh;
    EXPECT_EQ(mesh.triangles.size(), 12U);
    EXPECT_EQ(mesh.normals.size(), mesh.positions.size());
    double area = 0, volume = 0;
    glm::dvec3 low(1e30), high(-1e30);
    for (const glm::vec3& p : mesh.positions) {
      low = glm::min(low, glm::dvec3(p));
      high = glm::max(high, glm::dvec3(p));
    }
    const glm::dvec3 middle = (low + high) / 2.0;
    for (const glm::uvec3& t : mesh.triangles) {
      const glm::dvec3 a = glm::dvec3(mesh.positions[t.x]) - middle, b = glm::dvec3(mesh.positions[t.y]) - middle,
                       c = glm::dvec3(mesh.positions[t.z]) - middle;
      const glm::dvec3 doubled = glm::cross(b - a, c - a);
      area += glm::length(doubled) / 2;
      volume += glm::dot(a, glm::cross(b, c)) / 6;
      for (int corner = 0; corner < 3; ++corner)
        EXPECT_NEAR(glm::dot(glm::dvec3(mesh.normals[t[corner]]), glm::normalize(doubled)), 1, 1e-4);
    }
    const glm::dvec3 sides = high - low;
    EXPECT_NEAR(sides.x, 1.0, tolerance);
    EXPECT_NEAR(sides.y, 0.6, tolerance);
    EXPECT_NEAR(sides.z, 0.4, tolerance);
    EXPECT_NEAR(area, 2.48, 10 * tolerance);
    EXPECT_NEAR(volume, 0.24, 10 * tolerance) << "turned outward";
    return file;
  }
  template <class T>
  static void append(std::string& bytes, T value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
};

}  // namespace pellucid::test
