// By how much a refractor is not star-shaped.
#include <cmath>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "algorithms/local_cube_maps/star_shape.hpp"
#include "algorithms/scene/shapes/procedural.hpp"

namespace pellucid::local_cube_maps {
namespace {

TEST(ImpostorStarShape, ConvexSolidsAreFromAnyPointInside) {
  for (const glm::dvec3& center : {glm::dvec3(0), glm::dvec3(0.3, -0.2, 0.35)}) {
    EXPECT_TRUE(measure_star_shape(make_sphere(1, 64), center).exact());
    EXPECT_TRUE(measure_star_shape(make_box({1, 0.8F, 1.2F}), center).exact());
  }
}

// From 2 m off a unit ball: a spherical cap of a quarter of its area faces the point, under a cone of half-angle 30°.
TEST(ImpostorStarShape, SaysHowMuchOfABallAPointOutsideSees) {
  const StarShape shape = measure_star_shape(make_sphere(1, 256), {2, 0, 0});
  EXPECT_NEAR(shape.hidden_area, 0.25, 0.003);
  EXPECT_NEAR(shape.folded, 0.5 * (1 - std::sqrt(0.75)), 0.001);
  EXPECT_NEAR(shape.uncovered, 1, 1e-6);  // no direction's last surface is left from inside
  EXPECT_FALSE(shape.exact());
}

TEST(ImpostorStarShape, ATorusIsNot) {
  const Mesh torus = make_torus(1, 0.3F, 64);
  const StarShape shape = measure_star_shape(torus, choose_center(torus));
  EXPECT_GT(shape.folded, 0.15);
  EXPECT_GT(shape.hidden_area, 0.25);
  const std::string text = describe("ring", shape);
  EXPECT_NE(text.find("'ring' is not star-shaped"), std::string::npos) << text;
  EXPECT_NE(text.find('%'), std::string::npos);
}

TEST(ImpostorStarShape, KnowsClosedSolids) {
  for (const Mesh& mesh : {make_sphere(1, 16), make_box({1, 2, 3}), make_cone(1, 2, 16), make_torus(1, 0.3F, 16)})
    EXPECT_TRUE(closed(mesh)) << mesh.name;
  EXPECT_FALSE(closed(make_plane({1, 1}, 2)));
  Mesh open = make_sphere(1, 16);
  open.triangles.pop_back();
  EXPECT_FALSE(closed(open));
  Mesh inside_out = make_sphere(1, 16);
  for (glm::uvec3& t : inside_out.triangles)
    std::swap(t.y, t.z);
  EXPECT_FALSE(closed(inside_out));
}

// A cone's centroid stands at a quarter of its height, and sees all of it; both choices do.
TEST(ImpostorStarShape, ChoosesACentreInside) {
  const Mesh cone = make_cone(1, 2, 64);
  EXPECT_TRUE(measure_star_shape(cone, choose_center(cone)).exact());
}

}  // namespace
}  // namespace pellucid::local_cube_maps
