#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "gl/error.hpp"
#include "sweeps/measure/reference_cache.hpp"
#include "tests/sweeps/fake_known_names.hpp"

namespace pellucid::sweeps {
namespace {

using test::TemporaryFolder;

Reference example() {
  Reference reference;
  reference.image = Image(16, 8, 4);
  reference.mask = Image(16, 8, 1);
  for (std::size_t i = 0; i < reference.image.pixels.size(); ++i)
    reference.image.pixels[i] = 1.0F / static_cast<float>(i + 3);
  for (std::size_t i = 0; i < reference.mask.pixels.size(); i += 3)
    reference.mask.pixels[i] = 1;
  reference.step_error_max = 1.0 / 3;
  reference.step_error_mean = 1e-17;
  reference.unconverged_share = 0.25;
  reference.surfaces.samples = 64;
  reference.surfaces.rays = (std::uint64_t{1} << 40) + 1;
  reference.surfaces.standard_error_max = 1.0 / 7;
  reference.surfaces.cut_weight_mean = 3e-9;
  reference.surfaces.trace_s = 0.1;
  return reference;
}

TEST(ReferenceFiles, KeepEveryBit) {
  const TemporaryFolder folder;
  const ReferenceFiles files(folder / "references");
  EXPECT_EQ(files.read("key"), nullptr);
  const Reference reference = example();
  files.write("key", reference);
  const auto read = files.read("key");
  ASSERT_NE(read, nullptr);
  EXPECT_EQ(read->image.pixels, reference.image.pixels);
  EXPECT_EQ(read->mask.pixels, reference.mask.pixels);
  EXPECT_EQ(read->step_error_max, reference.step_error_max);
  EXPECT_EQ(read->step_error_mean, reference.step_error_mean);
  EXPECT_EQ(read->unconverged_share, reference.unconverged_share);
  EXPECT_EQ(read->surfaces.samples, 64);
  EXPECT_EQ(read->surfaces.rays, reference.surfaces.rays);
  EXPECT_EQ(read->surfaces.standard_error_max, reference.surfaces.standard_error_max);
  EXPECT_EQ(read->surfaces.cut_weight_mean, reference.surfaces.cut_weight_mean);
  EXPECT_EQ(read->surfaces.trace_s, reference.surfaces.trace_s);
}

TEST(ReferenceFiles, DamageIsNoticed) {
  const TemporaryFolder folder;
  const ReferenceFiles files(folder / "references");
  files.write("key", example());
  const auto size = std::filesystem::file_size(files.path("key"));

  std::filesystem::resize_file(files.path("key"), size / 2);  // truncated
  EXPECT_EQ(files.read("key"), nullptr);

  files.write("key", example());
  ASSERT_NE(files.read("key"), nullptr);
  std::filesystem::copy_file(files.path("key"), files.path("other"));  // someone else's
  EXPECT_EQ(files.read("other"), nullptr);

  Reference altered = example();
  altered.image.pixels[5] += 1e-6F;
  files.write("altered", altered);
  EXPECT_NE(files.read("altered")->image.pixels, example().image.pixels);

  std::ofstream(files.path("text")) << "not an image";
  EXPECT_EQ(files.read("text"), nullptr);
}

TEST(ReferenceFiles, AnUnwritableFolderIsARuntimeError) {
  EXPECT_THROW(ReferenceFiles("/proc/nowhere").write("key", example()), RuntimeError);
}

}  // namespace
}  // namespace pellucid::sweeps
