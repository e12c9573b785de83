// pellucid render, reference.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "algorithms/scene/images/image.hpp"
#include "tests/sandbox/program.hpp"

namespace pellucid::test {
namespace {

using nlohmann::json;
using Words = std::vector<std::string>;

class Render : public testing::Test {
 protected:
  TemporaryFolder folder;
  std::string scene = write_small_scene(folder).string();

  Outcome render(const std::filesystem::path& output, const Words& more = {}, const Setting& setting = {}) const {
    Words words{"render", scene, "-t", "sampling_hulls", "--size", "64x48", "-o", output.string()};
    words.insert(words.end(), more.begin(), more.end());
    return pellucid(words, setting);
  }
  ImageFile rendered(const std::string& name, const Words& more = {}) const {
    EXPECT_TRUE(succeeded(render(folder / name, more)));
    return read_image(folder / name);
  }
};

double largest_difference(const Image& a, const Image& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i)
    largest = std::max(largest, std::abs(static_cast<double>(a.pixels[i]) - static_cast<double>(b.pixels[i])));
  return largest;
}

TEST_F(Render, WritesAnExrThatCarriesWhatMadeIt) {
  const ImageFile file = rendered("out.exr", {"-s", "hulls=3", "-s", "samples=5"});
  EXPECT_EQ(file.image.width, 64);
  EXPECT_EQ(file.image.height, 48);
  EXPECT_EQ(file.image.channels, 4);
  EXPECT_GT(*std::max_element(file.image.pixels.begin(), file.image.pixels.end()), 0.0F);
  const json recipe = json::parse(file.attributes.at("pellucid.recipe"));
  EXPECT_EQ(recipe.at("technique"), "sampling_hulls");
  EXPECT_EQ(recipe.at("parameters").at("hulls"), 3);
  EXPECT_EQ(recipe.at("parameters").at("samples"), 5);
  const json provenance = json::parse(file.attributes.at("pellucid.provenance"));
  for (const char* field : {"commit", "device", "driver", "scene_hash", "argv"})
    EXPECT_TRUE(provenance.contains(field)) << field;
}

TEST_F(Render, PrintsWhatItDidAsJson) {
  const Outcome outcome = render(folder / "out.exr", {"--json", "-s", "hulls=2"});
  ASSERT_TRUE(succeeded(outcome));
  const json done = json::parse(outcome.out);
  EXPECT_EQ(done.at("width"), 64);
  EXPECT_EQ(done.at("height"), 48);
  EXPECT_EQ(done.at("parameters").at("hulls"), 2);
  EXPECT_GT(done.at("gpu_bytes").get<double>(), 64 * 48 * 8);
  EXPECT_GT(done.at("peak_rss_bytes").get<double>(), 1e6);
  EXPECT_LT(done.at("peak_rss_bytes").get<double>(), 1024.0 * 1024 * 1024);
  EXPECT_FALSE(done.at("pass_ms").empty());
  EXPECT_EQ(outcome.err, "");
}

TEST_F(Render, WritesNothingToStandardOutputUnasked) {
  const Outcome outcome = render(folder / "out.png");
  ASSERT_TRUE(succeeded(outcome));
  EXPECT_EQ(outcome.out, "");
}

TEST_F(Render, WritesAnOpaquePicture) {
  const ImageFile file = rendered("out.png");
  EXPECT_TRUE(file.display_encoded);
  EXPECT_EQ(file.image.width, 64);
  EXPECT_EQ(file.image.height, 48);
  const auto [darkest, brightest] = std::minmax_element(file.image.pixels.begin(), file.image.pixels.end());
  EXPECT_LT(*darkest, *brightest);
}

TEST_F(Render, ExposureBrightensThePicture) {
  auto sum = [](const Image& image) {
    double total = 0;
    for (const float value : image.pixels)
      total += static_cast<double>(value);
    return total;
  };
  EXPECT_GT(sum(rendered("bright.png", {"--exposure", "1"}).image), sum(rendered("plain.png").image));
}

TEST_F(Render, TheSameWordsGiveTheSamePicture) {
  EXPECT_EQ(largest_difference(rendered("a.exr").image, rendered("b.exr").image), 0.0);
}

TEST_F(Render, ParametersChangeThePicture) {
  const Image fine = rendered("fine.exr", {"-s", "hulls=8", "-s", "samples=8"}).image;
  EXPECT_GT(largest_difference(fine, rendered("coarse.exr", {"-s", "hulls=1", "-s", "samples=1"}).image), 0.0);
  EXPECT_GT(largest_difference(fine, rendered("view.exr", {"--view", "side"}).image), 0.0);
  EXPECT_GT(largest_difference(fine, rendered("dense.exr", {"-s", "scene.density=2"}).image), 0.0);
}

TEST_F(Render, FineHullsAndSlicesAgreeWithTheReference) {
  const auto truth = folder / "truth.exr";
  const Outcome made =
      pellucid({"reference", scene, "--surfaces", "raster", "--size", "64x48", "-o", truth.string(), "--json"});
  ASSERT_TRUE(succeeded(made));
  const json errors = json::parse(made.out);
  EXPECT_LE(errors.at("step_error_max").get<double>(), 1e-3);
  auto rmse = [&](const char* technique, const Words& settings) {
    Words words{"render", scene, "-t", technique, "--size", "64x48", "-o", (folder / "test.exr").string()};
    words.insert(words.end(), settings.begin(), settings.end());
    EXPECT_TRUE(succeeded(pellucid(words)));
    const Outcome compared =
        pellucid({"compare", truth.string(), (folder / "test.exr").string(), "-m", "rmse", "--json"});
    EXPECT_TRUE(succeeded(compared));
    return json::parse(compared.out).at("rmse").get<double>();
  };
  const double coarse = rmse("sampling_hulls", {"-s", "hulls=1", "-s", "samples=2"});
  const double fine = rmse("sampling_hulls", {"-s", "hulls=8", "-s", "samples=32", "-s", "frame.format=single"});
  EXPECT_LT(fine, coarse / 2);
  EXPECT_LT(fine, 5e-3);
  EXPECT_LT(rmse("volume_slices", {"-s", "slices=512", "-s", "frame.format=single"}), 1e-2);
}

TEST_F(Render, ReferenceCarriesItsMaskAndItsError) {
  const auto truth = folder / "truth.exr";
  ASSERT_TRUE(succeeded(pellucid({"reference", scene, "--size", "48x36", "-o", truth.string()})));
  const ImageFile file = read_image(truth);
  EXPECT_EQ(file.image.width, 48);
  ASSERT_TRUE(file.layers.contains("mask"));
  const auto& mask = file.layers.at("mask").pixels;
  EXPECT_EQ(*std::min_element(mask.begin(), mask.end()), 0.0F);
  EXPECT_EQ(*std::max_element(mask.begin(), mask.end()), 1.0F);
  EXPECT_TRUE(json::parse(file.attributes.at("pellucid.reference_error")).contains("step_error_max"));
}

TEST_F(Render, EmbeddedScenesRenderWithoutAnySourceTree) {
  const Outcome outcome =
      pellucid({"render", "fog_forest", "-t", "sampling_hulls", "-o", "out.exr", "--json"}, {.folder = folder.path()});
  ASSERT_TRUE(succeeded(outcome));
  EXPECT_EQ(json::parse(outcome.out).at("width"), 720);
  EXPECT_EQ(json::parse(outcome.out).at("height"), 540);
  EXPECT_LT(json::parse(outcome.out).at("peak_rss_bytes").get<double>(), 1024.0 * 1024 * 1024);
}

// ---- what is refused ----

TEST_F(Render, RefusesUnknownNamesWithTheNearest) {
  const auto out = folder / "out.exr";
  EXPECT_TRUE(refused(render(out, {"-s", "hull=4"}), 2, {"'hull'", "'hulls'"}));
  EXPECT_TRUE(refused(render(out, {"-s", "scene.densty=1"}), 2, {"densty", "density"}));
  EXPECT_TRUE(refused(render(out, {"-s", "frame.fromat=half"}), 2, {"fromat", "format"}));
  EXPECT_TRUE(refused(render(out, {"-s", "qqqqqq=4"}), 2, {"qqqqqq", "hulls", "samples"}));
  EXPECT_TRUE(refused(render(out, {"--view", "sied"}), 2, {"sied", "side"}));
  EXPECT_TRUE(refused(pellucid({"render", scene, "-t", "sampling_hull", "-o", out.string()}), 2, {"'sampling_hulls'"}));
  EXPECT_TRUE(refused(pellucid({"render", "fog_forst", "-t", "sampling_hulls", "-o", out.string()}), 2,
                      {"fog_forst", "fog_forest"}));
  EXPECT_TRUE(refused(pellucid({"render", (folder / "none.toml").string(), "-t", "sampling_hulls", "-o", out.string()}),
                      2, {"none.toml"}));
  EXPECT_FALSE(std::filesystem::exists(out));
}

TEST_F(Render, RefusesValuesOutOfRangeOrOfTheWrongType) {
  const auto out = folder / "out.exr";
  EXPECT_TRUE(refused(render(out, {"-s", "hulls=65"}), 2, {"hulls", "65", "[1, 64]"}));
  EXPECT_TRUE(refused(render(out, {"-s", "hulls=0"}), 2, {"hulls", "[1, 64]"}));
  EXPECT_TRUE(refused(render(out, {"-s", "samples=-8"}), 2, {"samples", "-8", "[1, 256]"}));
  EXPECT_TRUE(refused(render(out, {"-s", "hulls=99999999999999999999"}), 2, {"hulls"}));
  EXPECT_TRUE(refused(render(out, {"-s", "hulls=4.5"}), 2, {"hulls", "4.5", "integer"}));
  EXPECT_TRUE(refused(render(out, {"-s", "hulls=four"}), 2, {"hulls", "four", "integer"}));
  EXPECT_TRUE(refused(render(out, {"-s", "hulls="}), 2, {"hulls"}));
  EXPECT_TRUE(refused(render(out, {"-s", "hulls=4x"}), 2, {"hulls", "4x"}));
  EXPECT_TRUE(refused(render(out, {"-s", "sample_offset=nan"}), 2, {"sample_offset"}));
  EXPECT_TRUE(refused(render(out, {"-s", "sample_offset=inf"}), 2, {"sample_offset"}));
  EXPECT_TRUE(refused(render(out, {"-s", "frame.format=hlaf"}), 2, {"format", "hlaf", "half", "single"}));
  EXPECT_TRUE(refused(render(out, {"-s", "hulls"}), 2, {"hulls", "name=value"}));
  EXPECT_TRUE(refused(render(out, {"-s", "=4"}), 2, {"name=value"}));
  EXPECT_TRUE(refused(render(out, {"-s"}), 2, {"-s"}));
  EXPECT_TRUE(refused(render(out, {"--exposure", "bright"}), 2, {"bright"}));
  EXPECT_TRUE(refused(render(out, {"--device", "99"}), 2, {"99"}));
  EXPECT_FALSE(std::filesystem::exists(out));
}

TEST_F(Render, RefusesSizesBeforeAllocating) {
  for (const char* size : {"100000x100000", "16385x1", "0x48", "64x0", "-64x48", "64", "64x", "x48", "64x48x3", "wide",
                           "64.5x48", "99999999999999999999x1"}) {
    const auto out = (folder / "out.exr").string();
    EXPECT_TRUE(refused(pellucid({"render", scene, "-t", "sampling_hulls", "--size", size, "-o", out}), 2, {"--size"}))
        << size;
    EXPECT_TRUE(refused(pellucid({"reference", scene, "--size", size, "-o", out}), 2, {"--size"})) << size;
  }
}

TEST_F(Render, NeedsToKnowWhatAndWhere) {
  const auto out = (folder / "out.exr").string();
  EXPECT_TRUE(refused(pellucid({"render", "-t", "sampling_hulls", "-o", out}), 2, {"scene"}));
  EXPECT_TRUE(refused(pellucid({"render", scene, "-o", out}), 2, {"--technique"}));
  EXPECT_TRUE(refused(pellucid({"render", scene, "-t", "sampling_hulls"}), 2, {"--output"}));
  EXPECT_TRUE(refused(render(folder / "out.jpg"), 2, {"out.jpg", ".exr", ".png"}));
  EXPECT_TRUE(refused(render(folder / "out"), 2, {".exr", ".png"}));
}

TEST_F(Render, TellsWhenTheOutputCannotBeWritten) {
  const auto file = write_file(folder / "file", "not a folder");
  EXPECT_TRUE(refused(render(file / "out.exr"), 1, {"out.exr"}));
  EXPECT_TRUE(refused(render(folder / "nowhere/out.png"), 1, {"out.png"}));
  EXPECT_TRUE(refused(render("/proc/out.exr"), 1, {"/proc/out.exr"}));
  EXPECT_TRUE(refused(render("/proc/out.png"), 1, {"/proc/out.png"}));
  std::filesystem::create_directory(folder / "taken.exr");
  EXPECT_TRUE(refused(render(folder / "taken.exr"), 1, {"taken.exr"}));
  EXPECT_TRUE(
      refused(pellucid({"reference", scene, "--size", "8x8", "-o", (file / "out.exr").string()}), 1, {"out.exr"}));
}

// A file that may not grow stands for a full disk.
TEST_F(Render, AFailedWriteLeavesWhatWasThere) {
  for (const char* name : {"out.exr", "out.png"}) {
    const auto out = folder / name;
    ASSERT_TRUE(succeeded(render(out)));
    const std::string before = read_file(out);
    const Outcome outcome = run({"sh", "-c",
                                 "trap '' XFSZ; ulimit -f 1; exec '" PELLUCID_PROGRAM "' render '" + scene +
                                     "' -t volume_slices --size 256x192 -o '" + out.string() + "'"});
    EXPECT_TRUE(refused(outcome, 1, {name}));
    EXPECT_EQ(read_file(out), before);
  }
  for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
    const std::string name = entry.path().filename().string();
    EXPECT_TRUE(name == "out.exr" || name == "out.png" || name.ends_with(".toml")) << name;
  }
}

TEST_F(Render, ReadsAnotherColourConfigAndRefusesABrokenOne) {
  const Outcome missing = render(folder / "out.png", {}, {.environment = {{"OCIO", (folder / "none.ocio").string()}}});
  EXPECT_TRUE(refused(missing, 2, {"none.ocio"}));
  const auto broken = write_file(folder / "broken.ocio", "ocio_profile_version: 2\nroles: [\n");
  EXPECT_TRUE(
      refused(render(folder / "out.png", {}, {.environment = {{"OCIO", broken.string()}}}), 2, {"broken.ocio"}));
  // OpenColorIO's own warnings are lines of ours, without what a terminal obeys.
  const auto odd = write_file(folder / "odd.ocio",
                              "ocio_profile_version: 2\nroles: {default: raw}\ndisplays:\n  sRGB:\n"
                              "    - !<View> {name: Raw, colorspace: raw, \"odd\\ekey\": 1}\n"
                              "colorspaces:\n  - !<ColorSpace> {name: raw}\n");
  const Outcome warned = render(folder / "out.png", {}, {.environment = {{"OCIO", odd.string()}}});
  EXPECT_NE(warned.err.find("warning: OpenColorIO: At line 5, unknown key 'odd\\x1bkey' in 'View'"), std::string::npos)
      << warned.err;
  // An EXR stays scene-linear: nobody needs the config.
  EXPECT_TRUE(succeeded(render(folder / "out.exr", {}, {.environment = {{"OCIO", broken.string()}}})));
}

TEST_F(Render, TellsThatGlassShowsABlackEnvironment) {
  const auto draw = [&](const std::string& of, const std::string& technique) {
    return pellucid({"render", of, "-t", technique, "--size", "8x8", "-o", (folder / "o.exr").string()});
  };
  // A room without a sky: a technique that sees the environment alone draws its ball black, one that sees the room does
  // not.
  const Outcome black = draw("glass_room", "front_refraction"), room = draw("glass_room", "environment_map");
  ASSERT_TRUE(succeeded(black) && succeeded(room));
  EXPECT_NE(black.err.find("warning: front_refraction shows the environment alone"), std::string::npos) << black.err;
  EXPECT_EQ(room.err.find("warning"), std::string::npos) << room.err;
}

TEST_F(Render, AShaderOverriddenFromDiskIsUsedAndItsErrorsNameTheLine) {
  const auto overrides = folder / "shaders";
  std::filesystem::create_directories(overrides / "algorithms/shaders");
  std::filesystem::copy(PELLUCID_SOURCE_DIR "/algorithms/shaders", overrides / "algorithms/shaders",
                        std::filesystem::copy_options::recursive | std::filesystem::copy_options::overwrite_existing);
  const Setting setting{.environment = {{"PELLUCID_SHADER_PATH", overrides.string()}}};
  ASSERT_TRUE(succeeded(render(folder / "out.exr", {}, setting)));
  const auto shader = overrides / "algorithms/shaders/background.frag.glsl";
  write_file(shader, read_file(shader) + "\nvoid broken() { undeclared_name = 1; }\n");
  const Outcome outcome = render(folder / "out.exr", {}, setting);
  EXPECT_NE(outcome.status, 0);
  EXPECT_NE(outcome.err.find("background.frag.glsl:"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("undeclared_name"), std::string::npos) << outcome.err;
}

TEST_F(Render, SceneErrorsNameFileLineAndColumn) {
  const std::string good = read_file(scene);
  auto with = [&](const std::string& text) {
    const auto path = write_file(folder / "bad.toml", text);
    return pellucid(
        {"render", path.string(), "-t", "sampling_hulls", "--size", "8x8", "-o", (folder / "o.exr").string()});
  };
  const std::string line = "bad.toml:" + std::to_string(std::count(good.begin(), good.end(), '\n') + 1) + ":";
  EXPECT_TRUE(refused(with(good + "[volume\n"), 2, {line}));
  EXPECT_TRUE(refused(with(good + "[volumme]\n"), 2, {line, "volumme", "volume"}));
  EXPECT_TRUE(refused(with("titel = \"x\"\n" + good), 2, {"bad.toml:1:1", "titel", "title"}));
  EXPECT_TRUE(refused(with("title = 4\n"), 2, {"bad.toml:1:", "title"}));
  EXPECT_TRUE(refused(with(""), 2, {"bad.toml"}));
  EXPECT_TRUE(refused(with(std::string("\0\xff\xfe", 3)), 2, {"bad.toml:1:"}));
}

}  // namespace
}  // namespace pellucid::test
