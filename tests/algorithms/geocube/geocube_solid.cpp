#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "algorithms/geocube/cubes.hpp"
#include "algorithms/geocube/placement.hpp"
#include "algorithms/geocube/search.hpp"
#include "algorithms/geocube/solid.hpp"
#include "algorithms/scene/files/asset_path.hpp"
#include "algorithms/scene/meshes/mesh_file.hpp"
#include "gl/error.hpp"
#include "tests/algorithms/geocube/geocube_solids.hpp"
#include "tests/algorithms/scene/folder_test.hpp"

namespace pellucid::geocube {
namespace {

using test::message_of;

bool contains_text(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}
#define EXPECT_SAYS(message, part) EXPECT_PRED2(contains_text, message, part)

Mesh named_box(const glm::vec3& size = glm::vec3(2.0F)) {
  Mesh mesh = make_box(size);
  mesh.name = "block";
  return mesh;
}

void append(Mesh& mesh, const Mesh& other, const glm::vec3& shift) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  for (std::size_t i = 0; i < other.positions.size(); ++i) {
    mesh.positions.push_back(other.positions[i] + shift);
    mesh.normals.push_back(other.normals[i]);
  }
  for (const glm::uvec3& t : other.triangles)
    mesh.triangles.push_back(t + first);
}

TEST(GeocubeSolid, WeldsCornersThatAreSplitAtCreasesAndSeams) {
  const Solid box(named_box());
  EXPECT_EQ(box.tree().positions().size(), 8U);
  EXPECT_NEAR(box.volume(), 8, 1e-9);
  EXPECT_NEAR(box.area(), 24, 1e-9);
  EXPECT_NEAR(box.diagonal(), std::sqrt(12.0), 1e-9);
  const Solid ball(make_sphere(1, 48));
  EXPECT_NEAR(ball.volume(), 4 * std::numbers::pi / 3, 0.05);
  EXPECT_NO_THROW(Solid(make_torus(1.0F, 0.3F, 24)));
}

TEST(GeocubeSolid, RaysTellInsideFromOutside) {
  const Solid solid(make_torus(1.0F, 0.3F, 48));
  EXPECT_TRUE(solid.contains({1, 0, 0}));
  EXPECT_FALSE(solid.contains({0, 0, 0}));
  EXPECT_FALSE(solid.contains({5, 0, 0}));
  const auto hit = solid.first_hit({1, 0, 0}, {-1, 0, 0});
  ASSERT_TRUE(hit);
  EXPECT_TRUE(hit->leaves);
  EXPECT_NEAR(hit->distance, 0.3, 0.01);
  const auto back = solid.first_hit({0, 0, 0}, {1, 0, 0});
  ASSERT_TRUE(back);
  EXPECT_FALSE(back->leaves);
}

TEST(GeocubeSolid, AnOpenMeshIsRefusedWithThePlaceOrCapped) {
  Mesh open = named_box();
  std::erase_if(open.triangles, [&](const glm::uvec3& t) {
    return open.positions[t.x].y > 0 && open.positions[t.y].y > 0 && open.positions[t.z].y > 0;
  });
  const std::string message = message_of([&] { Solid solid(open); });
  EXPECT_SAYS(message, "mesh 'block' is no solid: it is open: 1 hole, 4 border edges");
  EXPECT_SAYS(message, "near (0, 1, 0)");
  const Solid capped(open, Holes::cap);
  EXPECT_NEAR(capped.volume(), 8, 1e-9);
  EXPECT_EQ(capped.capped_holes(), 1U);
  EXPECT_FALSE(capped.source(static_cast<std::uint32_t>(capped.triangle_count() - 1)));
}

TEST(GeocubeSolid, UnsoundMeshesAreRefused) {
  Mesh empty;
  empty.name = "nothing";
  EXPECT_EQ(message_of([&] { Solid solid(empty); }), "mesh 'nothing' is no solid: it has no triangles");

  Mesh inside_out = named_box();
  for (glm::uvec3& t : inside_out.triangles)
    std::swap(t.y, t.z);
  EXPECT_SAYS(message_of([&] { Solid solid(inside_out); }), "inside out");

  Mesh one_wrong = named_box();
  std::swap(one_wrong.triangles[0].y, one_wrong.triangles[0].z);
  EXPECT_SAYS(message_of([&] { Solid solid(one_wrong); }), "disagree about which side is outside");

  Mesh fin = named_box();
  fin.positions.emplace_back(5.0F, 5.0F, 0.0F);
  fin.normals.emplace_back(0.0F, 1.0F, 0.0F);
  const glm::uvec3 t = fin.triangles[0];
  fin.triangles.emplace_back(t.x, t.y, static_cast<std::uint32_t>(fin.positions.size() - 1));
  EXPECT_SAYS(message_of([&] { Solid solid(fin); }), "more than two faces");

  Mesh flat;
  flat.name = "sheet";
  flat.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  flat.normals.assign(3, {0, 0, 1});
  flat.triangles = {{0, 1, 2}, {0, 2, 1}};
  EXPECT_SAYS(message_of([&] { Solid solid(flat); }), "encloses no volume");

  Mesh crossing = named_box();
  append(crossing, make_box(glm::vec3(2.0F)), {1.1F, 0.7F, 0.3F});
  EXPECT_SAYS(message_of([&] { Solid solid(crossing); }), "it cuts itself");
  Mesh apart = named_box();
  append(apart, make_box(glm::vec3(2.0F)), {3.0F, 0.0F, 0.0F});
  EXPECT_NO_THROW(Solid{apart});

  Mesh broken = named_box();
  broken.positions[3].x = std::nanf("");
  EXPECT_SAYS(message_of([&] { Solid solid(broken); }), "vertex 3 is not finite");
}

TEST(GeocubeSolid, ACentreOutsideOrOptionsOutOfRangeAreRefused) {
  const Solid solid(named_box());
  const auto refusal = [&](const glm::dvec3& center, const CubeOptions& options) {
    return message_of([&] { build_cubes(solid, std::vector{center}, options); });
  };
  EXPECT_EQ(refusal({0, 3, 0}, {}),
            "geocube: the centre of cube 1, (0, 3, 0), lies outside mesh 'block' (which reaches from (-1, -1, -1) to "
            "(1, 1, 1))");
  EXPECT_SAYS(refusal({0, 0, 0}, {.resolution = 4}), "resolution = 4 is out of range [8, 512]");
  EXPECT_SAYS(refusal({0, 0, 0}, {.epsilon = 0}), "epsilon");
  EXPECT_SAYS(refusal({0, 0, 0}, {.ior = -1}), "index of refraction");
  EXPECT_SAYS(message_of([&] { build_cubes(solid, {}, {}); }), "no cube centre");
  EXPECT_SAYS(message_of([&] { build_cubes(solid, std::vector<glm::dvec3>(17), {}); }), "at most 16");
}

TEST(GeocubeLayers, EveryIntervalAlongADirectionIsKept) {
  const Solid torus(make_torus(1.0F, 0.3F, 64));
  CubeOptions options;
  options.resolution = 32;
  options.layers = 3;
  const CubeSet set = build_cubes(torus, std::vector{glm::dvec3(1, 0, 0)}, options);
  EXPECT_EQ(set.cubes[0].dropped_share, 0);
  const CubeGrid grid = set.grid();
  // Through the hole to the other side: in at 1.7, out at 2.3.
  const std::size_t across = grid.index(grid.nearest({-1, 0.001, 0.001}));
  const Cube& cube = set.cubes[0];
  EXPECT_NEAR(cube.layers[0].bounds[across].x, 0.3F, 0.02F);
  EXPECT_NEAR(cube.layers[1].planes[across].w, 1.7F, 0.02F);
  EXPECT_NEAR(cube.layers[1].bounds[across].x, 2.3F, 0.02F);
  EXPECT_EQ(cube.layers[2].bounds[across].x, 0.0F);
  EXPECT_GT(cube.layers[1].inners[across].x, 0.9F) << "the inner end faces the hole";
  const CubeSet one = build_cubes(torus, std::vector{glm::dvec3(1, 0, 0)}, {.resolution = 32});
  EXPECT_EQ(one.cubes[0].dropped_share, 0) << "one layer keeps what is seen, and drops nothing";
}

TEST(GeocubePlacement, TakesTheMiddleWhereEveryPlaceSeesAll) {
  // An off-centre ball is seen whole from everywhere inside, from its middle straight on.
  Mesh ball = make_sphere(1.0F, 48);
  for (glm::vec3& p : ball.positions)
    p += glm::vec3(2.0F, -1.0F, 0.5F);
  for (const std::uint32_t seed : {1U, 2U, 3U}) {
    const Placement one = place_cubes(Solid(ball), {.cubes = 1, .candidates = 300, .samples = 600, .seed = seed});
    ASSERT_EQ(one.centers.size(), 1U);
    EXPECT_EQ(one.unseen[0], 0);
    EXPECT_LT(glm::distance(one.centers[0], glm::dvec3(2.0, -1.0, 0.5)), 0.1) << seed;
  }
}

TEST(GeocubePlacement, FewCentresSeeATorusAndAStar) {
  const Solid star(make_star({}, 84));
  const Placement one = place_cubes(star, {.cubes = 1, .candidates = 200, .samples = 600});
  ASSERT_EQ(one.centers.size(), 1U);
  EXPECT_LT(one.unseen[0], 0.01);
  const Solid torus(make_torus(1.0F, 0.3F, 32));
  const Placement ring = place_cubes(torus, {.cubes = 8, .enough = 0.999, .candidates = 200, .samples = 600});
  EXPECT_LT(ring.unseen.back(), 0.02);
  EXPECT_GT(ring.unseen.front(), 0.3);
  for (std::size_t i = 0; i < ring.centers.size(); ++i) {
    EXPECT_TRUE(torus.contains(ring.centers[i]));
    if (i > 0) {
      EXPECT_LE(ring.unseen[i], ring.unseen[i - 1]);
    }
  }
  const CubeSet set = build_cubes(torus, ring.centers, {.resolution = 8});
  EXPECT_NEAR(set.unseen_share, ring.unseen.back(), 1e-9);
  EXPECT_EQ(place_cubes(torus, {.cubes = 3, .candidates = 50, .samples = 200}).centers,
            place_cubes(torus, {.cubes = 3, .candidates = 50, .samples = 200}).centers)
      << "the same every time";
}

TEST(GeocubePlacement, EachTriangleStartsInTheNearestCubeThatSeesIt) {
  const Solid torus(make_torus(1.0F, 0.3F, 32));
  const std::vector<glm::dvec3> centers{{1, 0, 0}, {-1, 0, 0}, {0, 0, 1}, {0, 0, -1}};
  const std::vector<std::uint8_t> first = nearest_seeing(torus, centers);
  std::size_t seen = 0;
  for (std::uint32_t t = 0; t < torus.triangle_count(); ++t) {
    if (first[t] == kUnseen) continue;
    ++seen;
    EXPECT_TRUE(torus.sees(centers[first[t]], t));
    for (std::size_t i = 0; i < centers.size(); ++i) {
      if (glm::distance(centers[i], torus.centroid(t)) < glm::distance(centers[first[t]], torus.centroid(t))) {
        EXPECT_FALSE(torus.sees(centers[i], t));
      }
    }
  }
  EXPECT_GT(seen, torus.triangle_count() / 2);
}

TEST(GeocubeRealMeshes, AutomaticPlacementSeesTheBunny) {
  Mesh mesh;
  try {
    mesh = load_mesh_file(resolve_asset("asset:meshes/bunny00.off", "."), 60).mesh;
  } catch (const InputError& e) {
    GTEST_SKIP() << e.what();
  }
  mesh.name = "bunny";
  const Solid solid(mesh);
  const Placement two = place_cubes(solid, {.cubes = 2, .candidates = 500, .samples = 1200});
  EXPECT_LE(two.unseen.back(), 0.03);
  const Placement five = place_cubes(solid, {.cubes = 5, .candidates = 500, .samples = 1200});
  EXPECT_LE(five.unseen.back(), 0.001);
}

TEST(GeocubeCubes, TellWhereTheInsideBeginsAgain) {
  const Solid solid(make_torus(1.0F, 0.3F, 48));
  const CubeSet set = build_cubes(solid, std::vector{glm::dvec3(1, 0, 0)}, {.resolution = 32});
  const CubeGrid grid = set.grid();
  const CubeLayer& layer = set.cubes[0].layers[0];
  std::size_t marked = 0, again = 0;
  for (std::size_t i = 0; i < grid.texels(); ++i) {
    const float told = layer.planes[i].w;
    ASSERT_TRUE(told == 0 || told == 1);
    marked += told > 0;
    // Beyond the first surface, a millionth of the diagonal farther.
    const auto next =
        solid.first_hit({1, 0, 0}, grid.direction(i), static_cast<double>(layer.bounds[i].x) + 1e-5 * solid.diagonal());
    if (!next) continue;
    ++again;
    EXPECT_EQ(told, 1) << i;
  }
  EXPECT_GT(again, grid.texels() / 50);
  // The border of one texel about what is hidden, and no more.
  EXPECT_GT(marked, again);
  EXPECT_LT(marked, 2 * again);

  const CubeSet ball =
      build_cubes(Solid(make_sphere(1.0F, 48)), std::vector{glm::dvec3(0.3, 0, 0)}, {.resolution = 16});
  for (const glm::vec4& plane : ball.cubes[0].layers[0].planes)
    EXPECT_EQ(plane.w, 0);
}

// A ray that the surface hides from a cube's centre does not end there, and one that nothing hides asks nobody.
TEST(GeocubeCubes, AreAskedWhereTheInsideBeginsAgain) {
  const Solid solid(make_torus(1.0F, 0.3F, 48));
  const Placement place = place_cubes(solid, {.cubes = 4, .candidates = 150, .samples = 500});
  const CubeSet set = build_cubes(solid, place.centers, {});
  const CubeMaps maps(set);
  const auto mean_error = [&](bool always, int switches) {
    SearchOptions search;
    search.min_step = static_cast<float>(2e-3 * set.diagonal);
    search.iterations = 40;
    search.ask_always = always;
    search.switches = switches;
    Random random(9);
    double sum = 0;
    constexpr int kRays = 3000;
    for (int i = 0; i < kRays; ++i) {
      const auto t = static_cast<std::uint32_t>(random.below(static_cast<int>(solid.triangle_count())));
      const glm::dvec3 p = solid.centroid(t), n = solid.shading_normal(t, glm::dvec3(1.0 / 3));
      const glm::dvec3 way = test::random_direction(random);
      const glm::dvec3 h = glm::normalize(glm::refract(glm::dot(way, n) < 0 ? way : -way, n, 1 / 1.5));
      const auto truth = solid.first_hit(p, h, 1e-4 * solid.diagonal());
      if (!truth || !truth->leaves) continue;
      const Exit found =
          find_exit(maps, glm::vec3(p), glm::vec3(n), glm::vec3(h), set.first_cube[*solid.source(t)], search);
      sum += glm::distance(glm::dvec3(found.point), p + truth->distance * h) / set.diagonal / kRays;
    }
    return sum;
  };
  const double behind = mean_error(false, 2), always = mean_error(true, 2), never = mean_error(false, 0);
  EXPECT_LT(behind, 1.05 * always);
  EXPECT_LT(behind, 0.5 * never);
}

TEST(GeocubeRealMeshes, TheHeadsExitsAreFoundWithinTheBound) {
  Mesh mesh;
  try {
    mesh = load_mesh_file(resolve_asset("asset:meshes/head.off", "."), 60).mesh;
  } catch (const InputError& e) {
    GTEST_SKIP() << e.what();
  }
  mesh.name = "head";
  for (glm::uvec3& t : mesh.triangles)  // the file's own face inwards
    std::swap(t.y, t.z);
  make_normals(mesh, 60);
  const Solid solid(mesh, Holes::cap);
  EXPECT_EQ(solid.capped_holes(), 3U);
  const Placement place = place_cubes(solid, {.cubes = 1, .candidates = 300, .samples = 1000});
  EXPECT_LT(place.unseen.back(), 1e-4);
  const CubeSet set = build_cubes(solid, place.centers, {});
  const CubeMaps maps(set);
  SearchOptions search;
  search.min_step = static_cast<float>(2e-3 * set.diagonal);
  Random random(4);
  double error = 0, bounded = 0;
  constexpr int kRays = 4000;
  for (int i = 0; i < kRays; ++i) {
    // From outside, refracted at the first surface.
    const glm::dvec3 way = test::random_direction(random);
    const auto triangle = static_cast<std::uint32_t>(random.below(static_cast<int>(solid.triangle_count())));
    const glm::dvec3 p = solid.centroid(triangle);
    const glm::dvec3 n = solid.shading_normal(triangle, glm::dvec3(1.0 / 3));
    const glm::dvec3 facet = solid.facet_normal(triangle);
    const glm::dvec3 h = glm::normalize(glm::refract(glm::dot(way, n) < 0 ? way : -way, n, 1 / 1.5));
    if (glm::dot(h, facet) >= 0) continue;
    const auto truth = solid.first_hit(p - 1e-6 * facet, h);
    ASSERT_TRUE(truth);
    const Exit found = find_exit(maps, glm::vec3(p), glm::vec3(n), glm::vec3(h), 0, search);
    error += glm::distance(glm::dvec3(found.point), p + truth->distance * h) / set.diagonal / kRays;
    bounded += found.bounded ? 1.0 / kRays : 0;
  }
  RecordProperty("mean_exit_error_diagonals", std::to_string(error));
  RecordProperty("bounded_share", std::to_string(bounded));
  EXPECT_LT(error, 0.005);
  EXPECT_LT(bounded, 0.01);
}

}  // namespace
}  // namespace pellucid::geocube
