// The geocube's searches in GLSL against their C++ twins.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "algorithms/geocube/cube_textures.hpp"
#include "algorithms/geocube/layers.hpp"
#include "algorithms/geocube/placement.hpp"
#include "algorithms/geocube/search.hpp"
#include "gl/error.hpp"
#include "gl/program.hpp"
#include "tests/algorithms/compute.hpp"
#include "tests/algorithms/geocube/geocube_solids.hpp"
#include "tests/algorithms/rendered.hpp"

namespace pellucid::geocube {
namespace {

struct Input {
  glm::vec3 point;
  float cube;
  glm::vec4 normal, direction, functions;
};
struct Output {
  glm::vec3 point;
  float length;
  glm::vec3 normal;
  float steps, cube, bounded, cone, sphere;
  glm::vec4 bounds;
};

// Rays refracted into a torus, whose two sides no single centre sees.
struct Case {
  Solid solid{make_torus(1.0F, 0.35F, 48)};
  CubeSet set;
  std::vector<Input> inputs;

  Case(const CubeOptions& options, int cubes) {
    const Placement place = place_cubes(solid, {.cubes = cubes, .candidates = 150, .samples = 500});
    set = build_cubes(solid, place.centers, options);
    Random random(21);
    for (int i = 0; i < 2000; ++i) {
      const auto t = static_cast<std::uint32_t>(random.below(static_cast<int>(solid.triangle_count())));
      const glm::vec3 n(solid.shading_normal(t, glm::dvec3(1.0 / 3)));
      const glm::vec3 way(test::random_direction(random));
      const glm::vec3 h = glm::normalize(glm::refract(glm::dot(way, n) < 0 ? way : -way, n, 1 / 1.5F));
      inputs.push_back(
          {glm::vec3(solid.centroid(t)), static_cast<float>(set.first_cube[*solid.source(t)]), glm::vec4(n, 0),
           glm::vec4(h, 0),
           glm::vec4(random.next(), random.range(-1, 1), random.range(-1, 1), random.range(0.05F, 0.99F))});
    }
  }
};

SearchOptions options_for(const CubeSet& set) {
  SearchOptions search;
  search.iterations = 24;
  search.min_step = static_cast<float>(0.002 * set.diagonal);
  search.cosine_c = std::sqrt(1 - 1 / 2.25F);
  return search;
}

std::vector<Output> run_on_gpu(const Case& c, const SearchOptions& search, const gl::Defines& defines) {
  test::use_context();
  const gl::Program program("geocube twins", {"tests/algorithms/geocube/geocube_search.comp.glsl"}, defines);
  const CubeTextures textures("twins", c.set);
  const gl::Texture functions = make_function_table(512);
  textures.bind(program);
  functions.bind(3);
  program.set("iterations", search.iterations);
  program.set("refine", search.refine);
  program.set("switches", search.switches);
  program.set("ask_always", search.ask_always);
  program.set("min_step", search.min_step);
  program.set("cosine_c", search.cosine_c);
  return test::compute<Output>(program, c.inputs);
}

// Share of the rays that both find alike. Rounding may send a grazing ray another way.
template <class Trace>
double agreement(const Case& c, const std::vector<Output>& found, Trace trace) {
  int same = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const Input& q = c.inputs[i];
    const Exit exit = trace(q.point, glm::vec3(q.normal), glm::vec3(q.direction), static_cast<int>(q.cube));
    same += glm::distance(exit.point, found[i].point) < 1e-3F * static_cast<float>(c.set.diagonal) &&
            glm::dot(exit.normal, found[i].normal) > 0.999F && exit.cube == static_cast<int>(found[i].cube) &&
            exit.bounded == (found[i].bounded > 0.5F);
  }
  return static_cast<double>(same) / static_cast<double>(found.size());
}

TEST(GeocubeTwins, TheSearchAndItsFetches) {
  const Case c({.resolution = 24}, 4);
  const SearchOptions search = options_for(c.set);
  const CubeMaps maps(c.set);
  const std::vector<Output> found = run_on_gpu(c, search, {});
  for (std::size_t i = 0; i < found.size(); ++i) {
    const Input& q = c.inputs[i];
    const CubeSample s = maps.fetch(static_cast<int>(q.cube), glm::vec3(q.direction));
    EXPECT_LT(glm::distance(s.bounds, found[i].bounds), 2e-2F) << "filters have 8 bits of weight";
    const float cone = cone_step(q.functions.x, q.functions.y, q.functions.z, 0.8F, q.functions.w);
    if (cone < 1e3F) {
      EXPECT_NEAR(found[i].cone, cone, 1e-3F * (1 + cone));
    } else {
      EXPECT_GT(found[i].cone, 1e2F);
    }
    EXPECT_NEAR(found[i].sphere, sphere_step(q.functions.x, q.functions.y), 1e-5F);
  }
  const double alike = agreement(c, found, [&](const glm::vec3& p, const glm::vec3& n, const glm::vec3& h, int cube) {
    return find_exit(maps, p, n, h, cube, search);
  });
  EXPECT_GT(alike, 0.98);
}

// The programs of one and of two cubes leave out what choosing among many takes; and others may be asked always.
TEST(GeocubeTwins, TheSearchAmongFewCubes) {
  for (const int cubes : {1, 2}) {
    const Case c({.resolution = 24}, cubes);
    ASSERT_EQ(c.set.cubes.size(), static_cast<std::size_t>(cubes));
    SearchOptions search = options_for(c.set);
    const CubeMaps maps(c.set);
    for (const bool always : {false, true}) {
      search.ask_always = always;
      const double alike = agreement(c, run_on_gpu(c, search, {{"CUBES", std::to_string(cubes)}}),
                                     [&](const glm::vec3& p, const glm::vec3& n, const glm::vec3& h, int cube) {
                                       return find_exit(maps, p, n, h, cube, search);
                                     });
      EXPECT_GT(alike, 0.98) << cubes << " cubes, " << (always ? "asked always" : "asked where more is behind");
    }
  }
}

TEST(GeocubeTwins, TheSearchWithATableOfItsFunctions) {
  const Case c({.resolution = 24}, 4);
  const SearchOptions search = options_for(c.set);
  const std::vector<Output> exact = run_on_gpu(c, search, {}),
                            looked_up = run_on_gpu(c, search, {{"FUNCTION_TABLE", "1"}});
  double apart = 0, steps = 0, table_steps = 0;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    apart += static_cast<double>(glm::distance(exact[i].point, looked_up[i].point)) / c.set.diagonal;
    steps += static_cast<double>(exact[i].steps);
    table_steps += static_cast<double>(looked_up[i].steps);
  }
  EXPECT_LT(apart / static_cast<double>(exact.size()), 0.005);
  EXPECT_NEAR(table_steps / steps, 1, 0.1);
}

TEST(GeocubeTwins, TheSearchInLayers) {
  const Case c({.resolution = 24, .layers = 3}, 1);
  const SearchOptions search = options_for(c.set);
  const LayerMaps maps(c.set);
  const double alike = agreement(c, run_on_gpu(c, search, {{"LAYERS", "1"}}),
                                 [&](const glm::vec3& p, const glm::vec3& n, const glm::vec3& h, int cube) {
                                   return find_exit_in_layers(maps, p, n, h, cube, search);
                                 });
  EXPECT_GT(alike, 0.97);
}

TEST(GeocubeTextures, MoreThanTheDeviceHoldsIsRefused) {
  test::use_context();
  CubeSet set;
  set.options.resolution = 512;
  set.options.layers = 8;
  set.cubes.resize(4000);  // 2.3 TiB; nothing is allocated for them
  try {
    const CubeTextures textures("huge", set);
    ADD_FAILURE() << "it was taken";
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("MiB of textures; the device has"), std::string::npos) << e.what();
  }
}

TEST(GeocubeLayers, OneCubeOfManyLayersDoesAsWellAsSeveralCubes) {
  const Case layered({.resolution = 64, .layers = 3}, 1), single({.resolution = 64}, 4), blind({.resolution = 64}, 1);
  const auto mean_error = [](const Case& c, auto trace) {
    double sum = 0;
    for (const Input& q : c.inputs) {
      const glm::dvec3 p(q.point), h(q.direction);
      const auto truth = c.solid.first_hit(p, h, 1e-4);
      if (!truth) continue;
      const Exit exit = trace(q);
      sum += glm::distance(glm::dvec3(exit.point), p + truth->distance * h) / c.set.diagonal;
    }
    return sum / static_cast<double>(c.inputs.size());
  };
  const LayerMaps maps(layered.set);
  const CubeMaps few(single.set), one(blind.set);
  const double in_layers = mean_error(layered, [&](const Input& q) {
    return find_exit_in_layers(maps, q.point, glm::vec3(q.normal), glm::vec3(q.direction), 0, options_for(layered.set));
  });
  const double in_cubes = mean_error(single, [&](const Input& q) {
    return find_exit(few, q.point, glm::vec3(q.normal), glm::vec3(q.direction), static_cast<int>(q.cube),
                     options_for(single.set));
  });
  const double in_one = mean_error(blind, [&](const Input& q) {
    return find_exit(one, q.point, glm::vec3(q.normal), glm::vec3(q.direction), 0, options_for(blind.set));
  });
  RecordProperty("layers", std::to_string(in_layers));
  RecordProperty("cubes", std::to_string(in_cubes));
  RecordProperty("one", std::to_string(in_one));
  EXPECT_LT(in_layers, 1.5 * in_cubes + 0.001);
  EXPECT_GT(in_one, 2 * in_layers) << "one cube of one layer sees a part only";
}

}  // namespace
}  // namespace pellucid::geocube
