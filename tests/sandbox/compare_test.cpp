// pellucid compare.
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tests/sandbox/pictures.hpp"
#include "tests/sandbox/program.hpp"

namespace pellucid::test {
namespace {

using nlohmann::json;

json compared(const std::filesystem::path& reference, const std::filesystem::path& test, const std::string& metrics) {
  const Outcome outcome = pellucid({"compare", reference.string(), test.string(), "-m", metrics, "--json"});
  EXPECT_TRUE(succeeded(outcome));
  return outcome.status == 0 ? json::parse(outcome.out) : json::object();
}

TEST(Compare, AnImageWithItselfHasNoError) {
  const TemporaryFolder folder;
  for (const auto& path :
       {write_exr_file(folder / "a.exr", pattern(48, 32)), write_png_file(folder / "a.png", pattern(48, 32))}) {
    const json metrics = compared(path, path, "mse,rmse,ssim,flip");
    EXPECT_EQ(metrics.at("mse"), 0.0);
    EXPECT_EQ(metrics.at("rmse"), 0.0);
    EXPECT_NEAR(metrics.at("ssim").get<double>(), 1.0, 1e-9);
    EXPECT_EQ(metrics.at("flip_mean"), 0.0);
    EXPECT_EQ(metrics.at("flip_max"), 0.0);
  }
}

TEST(Compare, AConstantDifferenceIsItsOwnRootMeanSquare) {
  const TemporaryFolder folder;
  const auto reference = write_exr_file(folder / "reference.exr", flat(32, 32, 0.5F, 0.5F, 0.5F));
  const auto test = write_exr_file(folder / "test.exr", flat(32, 32, 0.75F, 0.75F, 0.75F));
  const json metrics = compared(reference, test, "mse,rmse,psnr");
  EXPECT_NEAR(metrics.at("mse").get<double>(), 0.0625, 1e-9);
  EXPECT_NEAR(metrics.at("rmse").get<double>(), 0.25, 1e-9);
}

TEST(Compare, FlipOfBlackAndWhiteIsNearOne) {
  const TemporaryFolder folder;
  const auto black = write_png_file(folder / "black.png", flat(40, 40, 0, 0, 0));
  const auto white = write_png_file(folder / "white.png", flat(40, 40, 1, 1, 1));
  const double mean = compared(black, white, "flip").at("flip_mean").get<double>();
  EXPECT_GT(mean, 0.9);
  EXPECT_LE(mean, 1.0);
}

TEST(Compare, PrintsTheMetricsThatWereAskedFor) {
  const TemporaryFolder folder;
  const auto a = write_exr_file(folder / "a.exr", pattern(32, 32));
  const json metrics = compared(a, a, "rmse");
  EXPECT_TRUE(metrics.contains("rmse"));
  EXPECT_FALSE(metrics.contains("flip_mean"));
  const Outcome plain = pellucid({"compare", a.string(), a.string(), "-m", "rmse"});
  ASSERT_TRUE(succeeded(plain));
  EXPECT_NE(plain.out.find("rmse"), std::string::npos) << plain.out;
  EXPECT_EQ(plain.err, "");
}

TEST(Compare, WritesAnErrorMapOfTheSameSize) {
  const TemporaryFolder folder;
  const auto a = write_exr_file(folder / "a.exr", pattern(40, 24));
  const auto b = write_exr_file(folder / "b.exr", flat(40, 24, 0.2F, 0.4F, 0.6F));
  const auto map = folder / "map.png";
  ASSERT_TRUE(succeeded(pellucid({"compare", a.string(), b.string(), "--map", map.string()})));
  const ImageFile written = read_image(map);
  EXPECT_EQ(written.image.width, 40);
  EXPECT_EQ(written.image.height, 24);
  EXPECT_TRUE(
      refused(pellucid({"compare", a.string(), b.string(), "--map", (a / "map.png").string()}), 1, {"map.png"}));
}

TEST(Compare, RefusesWhatCannotBeCompared) {
  const TemporaryFolder folder;
  const auto a = write_exr_file(folder / "a.exr", pattern(32, 24));
  const auto other_size = write_exr_file(folder / "b.exr", pattern(33, 24));
  const auto encoded = write_png_file(folder / "c.png", pattern(32, 24));
  const auto text = write_file(folder / "text.exr", "no picture at all\n");
  const auto empty = write_file(folder / "empty.png", "");
  auto compare = [&](const std::filesystem::path& test) { return pellucid({"compare", a.string(), test.string()}); };
  EXPECT_TRUE(refused(compare(other_size), 2, {"32", "33"}));
  EXPECT_TRUE(refused(compare(encoded), 2, {"c.png"}));
  EXPECT_TRUE(refused(compare(text), 2, {"text.exr"}));
  EXPECT_TRUE(refused(compare(empty), 2, {"empty.png"}));
  EXPECT_TRUE(refused(compare(folder / "nowhere.exr"), 2, {"nowhere.exr"}));
  EXPECT_TRUE(refused(compare(folder.path()), 2, {folder.path().string()}));
  EXPECT_TRUE(refused(pellucid({"compare", a.string(), a.string(), "-m", "rmsee"}), 2, {"rmsee", "'rmse'"}));
  EXPECT_TRUE(refused(pellucid({"compare", a.string()}), 2, {"test"}));
}

TEST(Compare, RefusesImagesCutShortAnywhere) {
  const TemporaryFolder folder;
  for (const auto& whole :
       {write_exr_file(folder / "whole.exr", pattern(64, 64)), write_png_file(folder / "whole.png", pattern(64, 64))}) {
    const std::string bytes = read_file(whole);
    for (const double share : {0.01, 0.2, 0.5, 0.9, 0.999}) {
      const auto length = static_cast<std::size_t>(share * static_cast<double>(bytes.size()));
      const auto cut = write_file(folder / ("cut" + whole.extension().string()), bytes.substr(0, length));
      EXPECT_TRUE(refused(pellucid({"compare", whole.string(), cut.string()}), 2, {cut.string()})) << share;
    }
  }
}

// AddressSanitizer reserves terabytes of address space for itself.
#ifdef PELLUCID_SANITIZE
const std::string kLimit;
#else
const std::string kLimit = "ulimit -v 3000000; ";
#endif

// A header of a hundred bytes can ask for terabytes. With 3 GB of address space, allocating would fail with another
// status than refusing.
TEST(Compare, RefusesHugeImagesBeforeAllocating) {
  const TemporaryFolder folder;
  constexpr int kLowest = std::numeric_limits<int>::min(), kHighest = std::numeric_limits<int>::max();
  const std::vector<std::filesystem::path> huge{
      write_file(folder / "square.exr", exr_header(0, 0, 99'999, 99'999)),
      write_file(folder / "wide.exr", exr_header(0, 0, kHighest - 1, 0)),
      write_file(folder / "overflow.exr", exr_header(kLowest, kLowest, kHighest, kHighest)),
      write_file(folder / "inverted.exr", exr_header(10, 10, 0, 0)),
      write_file(folder / "square.png", png_header(100'000, 100'000)),
      write_file(folder / "highest.png", png_header(0x7FFFFFFFU, 0x7FFFFFFFU)),
      write_file(folder / "nothing.png", png_header(0, 0))};
  for (const auto& path : huge) {
    const std::string words =
        kLimit + "exec '" PELLUCID_PROGRAM "' compare '" + path.string() + "' '" + path.string() + "'";
    EXPECT_TRUE(refused(run({"sh", "-c", words}), 2, {path.filename().string()}));
  }
}

}  // namespace
}  // namespace pellucid::test
