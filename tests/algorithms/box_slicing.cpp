#include "algorithms/media/box_slicing.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <random>
#include <tuple>

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

namespace pellucid {
namespace {

struct Placement {
  glm::mat4 to_world, world_to_view;
};

// Boxes of any place, size and turn before, around and behind a camera.
Placement random_placement(std::mt19937& random) {
  std::uniform_real_distribution<float> unit(-1.0F, 1.0F);
  glm::mat4 to_world = glm::translate(glm::mat4(1.0F), 2.0F * glm::vec3{unit(random), unit(random), unit(random)});
  const float angle = 3.0F * unit(random);
  to_world = glm::rotate(to_world, angle, glm::normalize(glm::vec3{unit(random), 1.1F, unit(random)}));
  to_world = glm::scale(to_world, glm::vec3(1.5F) + glm::vec3{unit(random), unit(random), unit(random)});
  if (unit(random) > 0.5F) to_world[0] = -to_world[0];  // mirrored
  return {to_world, glm::lookAt(3.0F * glm::vec3{unit(random), unit(random), unit(random)}, glm::vec3(0.0F),
                                glm::vec3(0.1F, 1.0F, 0.0F))};
}

using Key = std::tuple<float, float, float>;
Key key(const glm::vec3& v) {
  return {v.x, v.y, v.z};
}

double signed_volume(const BoxPieces& pieces, const BoxPieces::Piece& piece) {
  double volume = 0;
  for (int i = piece.first; i < piece.first + piece.count; i += 3) {
    const auto at = [&](int k) { return glm::dvec3(pieces.vertices[static_cast<std::size_t>(i + k)]); };
    volume += glm::dot(at(0), glm::cross(at(1), at(2))) / 6;
  }
  return volume;
}

TEST(BoxSlicing, HullsAreClosedAndFillTheBox) {
  std::mt19937 random(7);
  int visible = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const Placement p = random_placement(random);
    const BoxDepth depth(p.to_world, p.world_to_view);
    const auto range = depth_range(depth, 0.1);
    if (!range) continue;
    ++visible;
    const int hulls = 1 + trial % 9;
    const BoxPieces pieces = cut_hulls(depth, *range, hulls);
    ASSERT_EQ(static_cast<int>(pieces.pieces.size()), hulls);
    double volume = 0;
    for (const auto& piece : pieces.pieces) {
      // Closed: every directed edge has its opposite, to the bit, so the rasteriser leaves no gap. Edges of zero length
      // (a plane through a corner) cancel by themselves.
      std::map<std::pair<Key, Key>, int> edges;
      for (int i = piece.first; i < piece.first + piece.count; i += 3) {
        for (int k = 0; k < 3; ++k) {
          const Key a = key(pieces.vertices[static_cast<std::size_t>(i + k)]);
          const Key b = key(pieces.vertices[static_cast<std::size_t>(i + (k + 1) % 3)]);
          if (a == b) continue;
          ++edges[{a, b}];
          --edges[{b, a}];
        }
      }
      for (const auto& [edge, count] : edges)
        ASSERT_EQ(count, 0) << "trial " << trial;
      const double sign = depth.mirrored ? -1 : 1;
      EXPECT_GE(sign * signed_volume(pieces, piece), -1e-9) << "outward faces";
      volume += sign * signed_volume(pieces, piece);
    }
    // Without the near plane the pieces make up the unit cube; with it, the share in front is missing.
    if (range->clipped) {
      EXPECT_LT(volume, 1.0);
    } else {
      EXPECT_NEAR(volume, 1.0, 1e-6) << "trial " << trial;
    }
    for (const glm::vec3& v : pieces.vertices) {
      EXPECT_GE(depth(v), range->front - 1e-5);
      EXPECT_LE(depth(v), range->back + 1e-5);
    }
  }
  EXPECT_GT(visible, 200);
}

TEST(BoxSlicing, PiecesComeFarthestFirst) {
  const glm::mat4 view = glm::lookAt(glm::vec3(3, 2, 5), glm::vec3(0.5F), glm::vec3(0, 1, 0));
  const BoxDepth depth(glm::mat4(1.0F), view);
  const BoxPieces pieces = cut_hulls(depth, *depth_range(depth, 0.1), 5);
  double last = 1e9;
  for (const auto& piece : pieces.pieces) {
    double sum = 0;
    for (int i = 0; i < piece.count; ++i)
      sum += depth(pieces.vertices[static_cast<std::size_t>(piece.first + i)]);
    EXPECT_LT(sum / piece.count, last);
    last = sum / piece.count;
  }
}

TEST(BoxSlicing, BoxBehindTheCameraHasNoHulls) {
  const glm::mat4 view = glm::lookAt(glm::vec3(0.5F, 0.5F, -2), glm::vec3(0.5F, 0.5F, -5), glm::vec3(0, 1, 0));
  EXPECT_FALSE(depth_range(BoxDepth(glm::mat4(1.0F), view), 0.1).has_value());
}

// A camera in the middle of the box that looks along −z sees the half in front of its near plane.
TEST(BoxSlicing, CameraInsideStartsAtTheNearPlane) {
  const glm::mat4 view = glm::lookAt(glm::vec3(0.5F), glm::vec3(0.5F, 0.5F, -1), glm::vec3(0, 1, 0));
  const BoxDepth depth(glm::mat4(1.0F), view);
  const auto range = depth_range(depth, 0.1);
  ASSERT_TRUE(range && range->clipped);
  EXPECT_NEAR(range->front, 0.1, 1e-12);
  EXPECT_NEAR(range->back, 0.5, 1e-6);
  const BoxPieces pieces = cut_hulls(depth, *range, 3);
  double volume = 0;
  for (const auto& piece : pieces.pieces)
    volume += signed_volume(pieces, piece);
  EXPECT_NEAR(volume, 0.4, 1e-6);
}

// Seen along an axis every slice is the whole face; seen from a corner the middle slice is the regular hexagon.
TEST(BoxSlicing, SlicesHaveTheAreaOfTheCrossSection) {
  auto area = [](const BoxPieces& pieces, int polygon_triangles_from, int count) {
    double sum = 0;
    for (int i = polygon_triangles_from; i < polygon_triangles_from + count; i += 3) {
      const auto at = [&](int k) { return glm::dvec3(pieces.vertices[static_cast<std::size_t>(i + k)]); };
      sum += glm::length(glm::cross(at(1) - at(0), at(2) - at(0))) / 2;
    }
    return sum;
  };
  const BoxDepth straight(glm::mat4(1.0F), glm::lookAt(glm::vec3(0.5F, 0.5F, 3), glm::vec3(0.5F), glm::vec3(0, 1, 0)));
  const BoxPieces ten = cut_slices(straight, *depth_range(straight, 0.1), 10);
  EXPECT_NEAR(area(ten, 0, static_cast<int>(ten.vertices.size())), 10.0, 1e-5);

  const BoxDepth corner(glm::mat4(1.0F), glm::lookAt(glm::vec3(3.0F), glm::vec3(0.0F), glm::vec3(0, 1, 0)));
  const BoxPieces one = cut_slices(corner, *depth_range(corner, 0.1), 1);
  EXPECT_NEAR(area(one, 0, static_cast<int>(one.vertices.size())), 3 * std::sqrt(3.0) / 4, 1e-5);
}

}  // namespace
}  // namespace pellucid
