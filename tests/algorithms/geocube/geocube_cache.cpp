#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "algorithms/geocube/cache.hpp"
#include "algorithms/scene/files/cache_file.hpp"
#include "tests/algorithms/geocube/geocube_solids.hpp"
#include "tests/algorithms/scene/folder_test.hpp"

namespace pellucid::geocube {
namespace {

class GeocubeCache : public test::FolderTest {
 protected:
  GeocubeCache() : mesh_(make_torus(1.0F, 0.35F, 24)), solid_(mesh_) {}

  CubeSet get(const CubeOptions& options) { return cached_cubes(solid_, mesh_, centers_, options, file("cache")); }
  std::filesystem::path only_file() { return std::filesystem::directory_iterator(file("cache"))->path(); }
  static std::size_t count(const std::filesystem::path& folder) {
    std::size_t n = 0;
    for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder))
      ++n;
    return n;
  }

  Mesh mesh_;
  Solid solid_;
  std::vector<glm::dvec3> centers_{{1, 0, 0}, {-1, 0, 0.1}};
};

void expect_same(const CubeSet& a, const CubeSet& b) {
  ASSERT_EQ(a.cubes.size(), b.cubes.size());
  EXPECT_EQ(a.diagonal, b.diagonal);
  EXPECT_EQ(a.first_cube, b.first_cube);
  EXPECT_EQ(a.unseen_share, b.unseen_share);
  for (std::size_t i = 0; i < a.cubes.size(); ++i) {
    EXPECT_EQ(a.cubes[i].center, b.cubes[i].center);
    EXPECT_EQ(a.cubes[i].sphere, b.cubes[i].sphere);
    ASSERT_EQ(a.cubes[i].layers.size(), b.cubes[i].layers.size());
    for (std::size_t k = 0; k < a.cubes[i].layers.size(); ++k) {
      EXPECT_EQ(a.cubes[i].layers[k].bounds, b.cubes[i].layers[k].bounds);
      EXPECT_EQ(a.cubes[i].layers[k].planes, b.cubes[i].layers[k].planes);
      EXPECT_EQ(a.cubes[i].layers[k].inners, b.cubes[i].layers[k].inners);
    }
  }
}

TEST_F(GeocubeCache, KeepsWhatWasBuilt) {
  const CubeOptions options{.resolution = 12, .layers = 2};
  const CubeSet built = get(options), read = get(options);
  expect_same(built, read);
  EXPECT_EQ(built.build_s, read.build_s) << "the time of building, not of reading";
  EXPECT_EQ(read.options.resolution, 12);
  EXPECT_EQ(count(file("cache")), 1U);
  get({.resolution = 12, .layers = 2, .epsilon = 0.01});
  EXPECT_EQ(count(file("cache")), 2U) << "other options are other cubes";
}

TEST_F(GeocubeCache, TheKeyFollowsTheContent) {
  const std::string key = cache_key(mesh_, centers_, {});
  EXPECT_EQ(cache_key(mesh_, centers_, {}), key);
  EXPECT_NE(cache_key(mesh_, centers_, {.ior = 1.4}), key);
  EXPECT_NE(cache_key(mesh_, centers_, {.use_a = false}), key);
  EXPECT_NE(cache_key(mesh_, std::vector{centers_[0]}, {}), key);
  Mesh moved = mesh_;
  moved.positions[3].x += 1e-6F;
  EXPECT_NE(cache_key(moved, centers_, {}), key);
}

TEST_F(GeocubeCache, DamagedFilesAreNoticedAndBuiltAgain) {
  const CubeOptions options{.resolution = 8};
  const CubeSet built = get(options);
  const std::string whole = content(only_file());
  const auto damage = [&](const std::string& changed, const std::string& reason) {
    std::ofstream(only_file(), std::ios::binary) << changed;
    ::testing::internal::CaptureStderr();
    const CubeSet again = get(options);
    const std::string warning = ::testing::internal::GetCapturedStderr();
    EXPECT_NE(warning.find(reason), std::string::npos) << warning;
    expect_same(built, again);
    EXPECT_EQ(content(only_file()).size(), whole.size()) << "written anew";
  };
  std::string flipped = whole;
  flipped[whole.size() / 2] = static_cast<char>(flipped[whole.size() / 2] ^ 1);
  damage(flipped, "its checksum is wrong");
  damage(whole.substr(0, whole.size() - 7), "its checksum is wrong");
  damage(whole.substr(0, 20), "it holds something else");
  damage("", "it holds something else");
}

TEST_F(GeocubeCache, AFolderThatCannotBeMadeCostsAWarning) {
  write("cache", "a file where the folder should be");
  ::testing::internal::CaptureStderr();
  const CubeSet set = get({.resolution = 8});
  EXPECT_NE(::testing::internal::GetCapturedStderr().find("warning: the geocube is not cached"), std::string::npos);
  EXPECT_EQ(set.cubes.size(), 2U);
  EXPECT_EQ(cached_cubes(solid_, mesh_, centers_, {.resolution = 8}, {}).cubes.size(), 2U) << "no folder, no file";
}

TEST_F(GeocubeCache, PlacesAreKeptToo) {
  const PlacementOptions options{.cubes = 3, .candidates = 60, .samples = 200};
  const Placement found = cached_placement(solid_, mesh_, options, file("cache"));
  const Placement read = cached_placement(solid_, mesh_, options, file("cache"));
  EXPECT_EQ(found.centers, read.centers);
  EXPECT_EQ(found.unseen, read.unseen);
  EXPECT_EQ(count(file("cache")), 1U);
}

TEST(GeocubeCacheFolder, FollowsTheEnvironment) {
  const auto with = [](const char* value) {
    ::setenv("PELLUCID_CACHE", value, 1);
    return cache_folder("geocube");
  };
  const char* before = std::getenv("PELLUCID_CACHE");
  const std::string kept = before != nullptr ? before : "";
  EXPECT_EQ(with("/some/place"), std::filesystem::path("/some/place/geocube"));
  EXPECT_TRUE(with("off").empty());
  if (before != nullptr) {
    ::setenv("PELLUCID_CACHE", kept.c_str(), 1);
  } else {
    ::unsetenv("PELLUCID_CACHE");
  }
}

}  // namespace
}  // namespace pellucid::geocube
