// pellucid compare: bounds that a value must keep, and the object mask.
#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tests/sandbox/pictures.hpp"
#include "tests/sandbox/program.hpp"

namespace pellucid::test {
namespace {

using nlohmann::json;

class CompareBounds : public testing::Test {
 protected:
  Outcome compare(const std::vector<std::string>& more) const {
    std::vector<std::string> words{"compare", reference.string(), test.string(), "-m", "rmse,psnr"};
    words.insert(words.end(), more.begin(), more.end());
    return pellucid(words);
  }

  const TemporaryFolder folder;
  const std::filesystem::path reference = write_png_file(folder / "reference.png", flat(16, 16, 0.2F, 0.2F, 0.2F));
  const std::filesystem::path test = write_png_file(folder / "test.png", flat(16, 16, 0.4F, 0.4F, 0.4F));  // rmse 0.2
};

TEST_F(CompareBounds, AValueBeyondItsBoundIsARegression) {
  EXPECT_EQ(compare({"--fail-above", "rmse=0.21", "--fail-below", "psnr=13.9"}).status, 0);
  const Outcome above = compare({"--fail-above", "psnr=99", "--fail-above", "rmse=0.19"});
  EXPECT_EQ(above.status, 3);
  EXPECT_NE(above.err.find("rmse"), std::string::npos) << above.err;
  EXPECT_EQ(above.err.find("psnr"), std::string::npos) << above.err;
  EXPECT_NE(above.out.find("psnr"), std::string::npos) << above.out;
  const Outcome below = compare({"--fail-below", "psnr=14.1", "--json"});
  EXPECT_EQ(below.status, 3);
  EXPECT_EQ(json::parse(below.out).at("failed"), json({"psnr"}));
}

TEST_F(CompareBounds, RefusesBoundsThatMeanNothing) {
  EXPECT_TRUE(refused(compare({"--fail-above", "rmsee=1"}), 2, {"--fail-above", "'rmsee'", "'rmse'"}));
  EXPECT_TRUE(refused(compare({"--fail-above", "ssim=1"}), 2, {"'ssim'", "not computed"}));
  for (const char* bound : {"rmse", "rmse=", "rmse=high", "rmse=1x", "rmse=nan", "=1"})
    EXPECT_TRUE(refused(compare({"--fail-below", bound}), 2, {"--fail-below", bound}));
}

TEST(CompareMask, TheReferencesLayerIsUsedUnlessToldOtherwise) {
  const TemporaryFolder folder;
  ImageFile file;
  file.image = flat(20, 16, 1, 1, 1);
  Image mask(20, 16, 1), other(20, 16, 1);
  *mask.at(3, 4) = 1;
  *other.at(0, 0) = 1;
  file.layers["mask"] = mask;
  file.layers["lamp"] = other;
  const auto reference = folder / "reference.exr";
  write_exr(reference, file);
  Image picture = flat(20, 16, 1, 1, 1);
  picture.at(3, 4)[0] = 4;  // off by 3 in one of three components
  const auto test = write_exr_file(folder / "test.exr", picture);
  const auto elsewhere = write_exr_file(folder / "mask.exr", mask);
  auto compared = [&](std::vector<std::string> more) {
    std::vector<std::string> words{"compare", reference.string(), test.string(), "-m", "mse", "--json"};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome outcome = pellucid(words);
    EXPECT_TRUE(succeeded(outcome));
    return outcome.status == 0 ? json::parse(outcome.out) : json::object();
  };
  EXPECT_NEAR(compared({}).at("mse").get<double>(), 9.0 / (3 * 20 * 16), 1e-9);
  EXPECT_NEAR(compared({}).at("mse_mask").get<double>(), 3, 1e-6);
  EXPECT_NEAR(compared({"--mask", elsewhere.string()}).at("mse_mask").get<double>(), 3, 1e-6);
  EXPECT_EQ(compared({"--mask", "lamp"}).at("mse_mask"), 0.0);
  EXPECT_FALSE(compared({"--no-mask"}).contains("mse_mask"));
  EXPECT_TRUE(refused(pellucid({"compare", reference.string(), test.string(), "--mask", "lam"}), 2,
                      {"--mask", "lam", "lamp, mask"}));
}

}  // namespace
}  // namespace pellucid::test
