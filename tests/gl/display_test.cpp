#include "gl/display/display.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "gl/display/display_config.hpp"
#include "gl/display/tabulated_curves.hpp"
#include "tests/gl/gl_fixture.hpp"

namespace OCIO = OCIO_NAMESPACE;

namespace pellucid::gl::test {
namespace {

constexpr int kSize = 48;

/// RGBA pixels over 20 stops, a fifth of them negative, with the corner cases first.
std::vector<float> hdr_pixels() {
  std::vector<float> pixels;
  std::uint32_t state = 12345;
  const auto random = [&] {
    state = state * 1664525U + 1013904223U;
    return static_cast<float>(state >> 8) / 16777216.0F;
  };
  for (int i = 0; i < kSize * kSize; ++i) {
    for (int c = 0; c < 3; ++c) {
      const float value = std::exp2(20.0F * random() - 12.0F);
      pixels.push_back(random() < 0.2F ? -value : value);
    }
    pixels.push_back(random());
  }
  const float corner_cases[] = {0.0F, 0.18F, 1.0F, -1.0F, 1000.0F};
  for (std::size_t i = 0; i < std::size(corner_cases); ++i)
    for (std::size_t c = 0; c < 3; ++c)
      pixels[4 * i + c] = corner_cases[i];
  return pixels;
}

std::vector<float> draw(const DisplayTransform& transform, const std::vector<float>& pixels, float exposure_ev) {
  Texture source = Texture::make_2d("scene", Format::rgba32f, kSize, kSize);
  source.upload(pixels);
  const Texture shown = Texture::make_2d("shown", Format::rgba32f, kSize, kSize);
  const Framebuffer framebuffer("shown", {&shown});
  framebuffer.bind();
  transform.draw(source, exposure_ev);
  return shown.read();
}

void expect_cpu_and_gpu_agree(const DisplayTransform& transform, float exposure_ev = 0) {
  const std::vector<float> pixels = hdr_pixels();
  const std::vector<float> gpu = draw(transform, pixels, exposure_ev);
  std::vector<float> cpu = pixels;
  for (std::size_t i = 0; i < cpu.size(); ++i)
    if (i % 4 != 3) cpu[i] *= std::exp2(exposure_ev);
  transform.apply(cpu, 4);
  int wrong = 0;
  double spread = 0;
  for (std::size_t i = 0; i < cpu.size() && wrong < 5; ++i) {
    if (i % 4 == 3) {
      EXPECT_EQ(cpu[i], pixels[i]) << "alpha is kept";
      continue;
    }
    const float tolerance = 1e-4F * std::max(1.0F, std::abs(cpu[i]));
    if (!(std::abs(gpu[i] - cpu[i]) <= tolerance)) {
      ++wrong;
      ADD_FAILURE() << transform.view() << ": scene " << pixels[i] << " shows as " << cpu[i] << " by CPU, " << gpu[i]
                    << " by GPU";
    }
    spread = std::max(spread, static_cast<double>(std::abs(cpu[i] - cpu[0])));
  }
  EXPECT_GT(spread, 0.3) << "the transform shows everything alike";
}

class DisplayTest : public GlTest {
 protected:
  void SetUp() override {
    GlTest::SetUp();
    unsetenv("OCIO");
  }
};

TEST_F(DisplayTest, DefaultsToTheFilmView) {
  const DisplayTransform transform;
  EXPECT_EQ(transform.display(), "sRGB");
  EXPECT_EQ(transform.view(), "Film");
  const std::vector<std::pair<std::string, std::string>> wanted = {{"sRGB", "Film"}, {"sRGB", "sRGB"}};
  EXPECT_EQ(transform.views(), wanted);
}

TEST_F(DisplayTest, CpuAndGpuAgreeInEveryView) {
  for (const auto& [display, view] : DisplayTransform().views()) {
    const DisplayTransform transform(display, view);
    expect_cpu_and_gpu_agree(transform);
    expect_cpu_and_gpu_agree(transform, -1.5F);
  }
}

/// A processor from the display config's working space, and its shader.
struct Processed {
  OCIO::ConstConfigRcPtr config;
  OCIO::ConstProcessorRcPtr processor;
  explicit Processed(const OCIO::ConstTransformRcPtr& transform) {
    std::istringstream text{std::string(kDisplayConfig)};
    config = OCIO::Config::CreateFromStream(text);
    processor = config->getProcessor(transform);
  }
};

std::string shader_of(const OCIO::ConstProcessorRcPtr& processor) {
  OCIO::GpuShaderDescRcPtr shader = OCIO::GpuShaderDesc::CreateShaderDesc();
  shader->setLanguage(OCIO::GPU_LANGUAGE_GLSL_4_0);
  processor->getDefaultGPUProcessor()->extractGpuShaderInfo(shader);
  return shader->getShaderText();
}

TEST_F(DisplayTest, ToneCurvesAreDrawnFromOneTable) {
  const OCIO::DisplayViewTransformRcPtr film = OCIO::DisplayViewTransform::Create();
  film->setSrc("lin_rec709");
  film->setDisplay("sRGB");
  film->setView("Film");
  const Processed aces(film);
  const OCIO::ConstProcessorRcPtr tabulated = with_tabulated_curves(aces.config, aces.processor);
  EXPECT_NE(shader_of(aces.processor).find("BSpline"), std::string::npos);
  EXPECT_EQ(shader_of(tabulated).find("BSpline"), std::string::npos);
  // A hundredth of the step between two codes of 8 bits.
  std::vector<float> exact = hdr_pixels();
  const auto apply = [](const OCIO::ConstProcessorRcPtr& processor, std::vector<float>& pixels) {
    OCIO::PackedImageDesc image(pixels.data(), kSize, kSize, 4);
    processor->getOptimizedCPUProcessor(OCIO::OPTIMIZATION_LOSSLESS)->apply(image);
  };
  std::vector<float> table = exact;
  apply(aces.processor, exact);
  apply(tabulated, table);
  for (std::size_t i = 0; i < exact.size(); ++i)
    EXPECT_NEAR(table[i], exact[i], 4e-5F);
}

TEST_F(DisplayTest, ACurveThatGoesOnBeyondItsEndsIsNoTable) {
  const OCIO::GradingRGBCurveTransformRcPtr rising = OCIO::GradingRGBCurveTransform::Create(OCIO::GRADING_LOG);
  const OCIO::GradingRGBCurveRcPtr curves = OCIO::GradingRGBCurve::Create(OCIO::GRADING_LOG);
  const OCIO::GradingBSplineCurveRcPtr master = curves->getCurve(OCIO::RGB_MASTER);
  master->setNumControlPoints(3);
  master->getControlPoint(0) = {-1.0F, -2.0F};
  master->getControlPoint(1) = {0.0F, 0.0F};
  master->getControlPoint(2) = {1.0F, 1.0F};
  rising->setValue(curves);
  const Processed graded(rising);
  EXPECT_EQ(with_tabulated_curves(graded.config, graded.processor), graded.processor);
}

float srgb_curve(float linear) {
  return linear <= 0.0031308F ? 12.92F * linear : 1.055F * std::pow(linear, 1.0F / 2.4F) - 0.055F;
}

TEST_F(DisplayTest, TheSrgbViewIsTheSrgbCurve) {
  const DisplayTransform transform({}, "sRGB");
  for (const int channels : {3, 4}) {
    std::vector<float> pixels;
    for (int i = 0; i <= 100; ++i) {
      const float v = static_cast<float>(i) / 100.0F;
      pixels.insert(pixels.end(), {v, v * v, 1.0F - v});
      if (channels == 4) pixels.push_back(0.25F);
    }
    std::vector<float> shown = pixels;
    transform.apply(shown, channels);
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      const bool alpha = channels == 4 && i % 4 == 3;
      EXPECT_NEAR(shown[i], alpha ? 0.25F : srgb_curve(pixels[i]), 2e-5F) << i;
    }
  }
}

TEST_F(DisplayTest, TheFilmViewCompressesHighlightsAndKeepsGreysGrey) {
  const DisplayTransform transform;
  float before = -1;
  for (const float scene : {0.001F, 0.01F, 0.18F, 1.0F, 4.0F, 16.0F}) {
    std::vector<float> pixel(3, scene);
    transform.apply(pixel, 3);
    EXPECT_NEAR(pixel[0], pixel[1], 2e-3F);
    EXPECT_NEAR(pixel[1], pixel[2], 2e-3F);
    EXPECT_GT(pixel[0], before);
    EXPECT_LE(pixel[0], 1.001F);
    before = pixel[0];
  }
  std::vector<float> grey(3, 0.18F);
  transform.apply(grey, 3);
  // ACES puts 18 % grey at 10 % of the display's luminance: sRGB encodes 0.1 as 0.349.
  EXPECT_NEAR(grey[1], 0.35F, 0.02F);
}

TEST_F(DisplayTest, DrawLeavesRasterStateAsItWas) {
  glEnable(GL_DEPTH_TEST);
  glDisable(GL_BLEND);
  draw(DisplayTransform(), hdr_pixels(), 0);
  EXPECT_TRUE(glIsEnabled(GL_DEPTH_TEST));
  EXPECT_FALSE(glIsEnabled(GL_BLEND));
  glDisable(GL_DEPTH_TEST);
}

TEST_F(DisplayTest, AMovedFromTransformIsEmpty) {
  DisplayTransform first;
  const DisplayTransform second = std::move(first);
  EXPECT_EQ(second.view(), "Film");
  EXPECT_EQ(first.view(), "");  // NOLINT(bugprone-use-after-move): moved-from means empty
  EXPECT_TRUE(first.views().empty());
}

TEST_F(DisplayTest, UnknownNamesShowWhatThereIs) {
  const std::string display = message_of<InputError>([] { const DisplayTransform none("cinema"); });
  EXPECT_TRUE(contains(display, "'cinema'") && contains(display, "'sRGB'")) << display;
  const std::string view = message_of<InputError>([] { const DisplayTransform none("sRGB", "film"); });
  EXPECT_TRUE(contains(view, "'film'") && contains(view, "'Film'")) << view;
}

/// A config whose views go through LUT files of every kind that OpenColorIO makes textures of.
class LutConfig {
 public:
  LutConfig() {
    std::string cube = "LUT_3D_SIZE 17\n", spi3d = "SPILUT 1.0\n3 3\n9 9 9\n";
    for (int b = 0; b < 17; ++b)
      for (int g = 0; g < 17; ++g)
        for (int r = 0; r < 17; ++r) {
          const double x = r / 16.0, y = g / 16.0, z = b / 16.0;
          cube += fmt::format("{:.7f} {:.7f} {:.7f}\n", 0.9 * std::sqrt(x) + 0.1 * y, 0.8 * y * y + 0.2 * x * z,
                              std::cbrt(z));
        }
    for (int r = 0; r < 9; ++r)
      for (int g = 0; g < 9; ++g)
        for (int b = 0; b < 9; ++b)
          spi3d +=
              fmt::format("{} {} {} {:.6f} {:.6f} {:.6f}\n", r, g, b, std::sqrt(r / 8.0), g / 8.0, 0.5 * (b + r) / 8.0);
    folder_.write("film.cube", cube);
    folder_.write("film.spi3d", spi3d);
    folder_.write("curve.spi1d", curve(1024));
    folder_.write("long_curve.spi1d", curve(40000));  // longer than a texture is wide: becomes a 2D texture
    config_ = folder_.write("config.ocio", R"(ocio_profile_version: 2
search_path: .
strictparsing: true
roles: {default: lin, scene_linear: lin}
file_rules:
  - !<Rule> {name: Default, colorspace: default}
displays:
  test:
    - !<View> {name: tetrahedral, colorspace: tetrahedral}
    - !<View> {name: trilinear, colorspace: trilinear}
    - !<View> {name: curve, colorspace: curve}
    - !<View> {name: long curve, colorspace: long curve}
    - !<View> {name: both, colorspace: both}
    - !<View> {name: missing, colorspace: missing}
active_displays: []
active_views: []
colorspaces:
  - !<ColorSpace> {name: lin}
  - !<ColorSpace> {name: tetrahedral, from_reference: !<FileTransform> {src: film.cube, interpolation: tetrahedral}}
  - !<ColorSpace> {name: trilinear, from_reference: !<FileTransform> {src: film.cube, interpolation: linear}}
  - !<ColorSpace> {name: curve, from_reference: !<FileTransform> {src: curve.spi1d, interpolation: linear}}
  - !<ColorSpace> {name: long curve, from_reference: !<FileTransform> {src: long_curve.spi1d, interpolation: linear}}
  - !<ColorSpace>
    name: both
    from_reference: !<GroupTransform>
      children:
        - !<FileTransform> {src: curve.spi1d, interpolation: linear}
        - !<FileTransform> {src: film.spi3d, interpolation: linear}
  - !<ColorSpace> {name: missing, from_reference: !<FileTransform> {src: nowhere.cube}}
)");
  }
  const std::string& path() const { return config_; }

 private:
  static std::string curve(int length) {
    std::string text = fmt::format("Version 1\nFrom -0.5 8.0\nLength {}\nComponents 1\n{{\n", length);
    for (int i = 0; i < length; ++i) {
      const double x = -0.5 + 8.5 * i / (length - 1);
      text += fmt::format("{:.7f}\n", std::copysign(std::pow(std::abs(x), 1 / 2.2), x));
    }
    return text + "}\n";
  }
  TemporaryFolder folder_;
  std::string config_;
};

TEST_F(DisplayTest, CpuAndGpuAgreeOnConfigsWithLuts) {
  const LutConfig config;
  const ScopedEnvironment ocio("OCIO", config.path());
  for (const char* view : {"tetrahedral", "trilinear", "curve", "long curve", "both"}) {
    SCOPED_TRACE(view);
    expect_cpu_and_gpu_agree(DisplayTransform("test", view));
  }
}

TEST_F(DisplayTest, OcioIsHonouredAndItsFirstViewIsTheDefault) {
  const LutConfig config;
  const ScopedEnvironment ocio("OCIO", config.path());
  const DisplayTransform transform;
  EXPECT_EQ(transform.display(), "test");
  EXPECT_EQ(transform.view(), "tetrahedral");
  EXPECT_EQ(transform.views().size(), 6U);
  const std::string message = message_of<InputError>([] { const DisplayTransform none({}, "Film"); });
  EXPECT_TRUE(contains(message, config.path())) << message;
}

TEST_F(DisplayTest, ALookActsOnScenelinearPixelsBeforeTheView) {
  TemporaryFolder folder;
  std::string text(kDisplayConfig);
  text += R"(
looks:
  - !<Look>
    name: dim
    process_space: lin_rec709
    transform: !<MatrixTransform> {matrix: [0.25, 0, 0, 0, 0, 0.25, 0, 0, 0, 0, 0.25, 0, 0, 0, 0, 1]}
)";
  const ScopedEnvironment ocio("OCIO", folder.write("look.ocio", text).string());
  const DisplayTransform plain, dim({}, {}, "dim");
  EXPECT_EQ(plain.look(), "");
  EXPECT_EQ(dim.look(), "dim");
  EXPECT_EQ(plain.looks(), std::vector<std::string>{"dim"});
  std::vector<float> bright{4, 2, 0.4F}, quarter{1, 0.5F, 0.1F};
  dim.apply(bright, 3);
  plain.apply(quarter, 3);
  for (std::size_t i = 0; i < bright.size(); ++i)
    EXPECT_NEAR(bright[i], quarter[i], 1e-5);
  const std::string message = message_of<InputError>([] { const DisplayTransform none({}, {}, "dimm"); });
  EXPECT_TRUE(contains(message, "dim")) << message;
  expect_cpu_and_gpu_agree(dim);
}

TEST_F(DisplayTest, EntersAConfigThroughItsInterchangeRole) {
  std::string text(kDisplayConfig);
  for (std::size_t at = 0; (at = text.find("lin_rec709", at)) != std::string::npos;)
    text.replace(at, 10, "renamed");
  // Were `scene_linear` taken instead, AP0 would be read as Rec. 709 and red would come out far less saturated.
  text.replace(text.find("scene_linear: renamed"), 21, "scene_linear: ACES2065-1");
  const TemporaryFolder folder;
  std::vector<float> wanted = hdr_pixels(), got = wanted;
  DisplayTransform("sRGB", "sRGB").apply(wanted, 4);
  const ScopedEnvironment ocio("OCIO", folder.write("renamed.ocio", text));
  DisplayTransform("sRGB", "sRGB").apply(got, 4);
  for (std::size_t i = 0; i < got.size(); ++i)
    EXPECT_NEAR(got[i], wanted[i], 1e-4F * std::max(1.0F, std::abs(wanted[i]))) << i;
}

TEST_F(DisplayTest, ABadConfigIsAnInputErrorThatNamesTheFile) {
  const TemporaryFolder folder;
  const LutConfig luts;
  const std::string no_entry = R"(ocio_profile_version: 2
roles: {default: x}
file_rules:
  - !<Rule> {name: Default, colorspace: default}
displays: {d: [!<View> {name: v, colorspace: x}]}
colorspaces: [!<ColorSpace> {name: x}]
)";
  const std::vector<std::string> files = {folder / "nowhere.ocio", folder.write("broken.ocio", "roles: ["),
                                          folder.write("empty.ocio", ""), folder.path(),
                                          folder.write("no_role.ocio", no_entry)};
  for (const std::string& file : files) {
    const ScopedEnvironment ocio("OCIO", file);
    const std::string message = message_of<InputError>([] { const DisplayTransform none; });
    EXPECT_TRUE(contains(message, file)) << message;
    EXPECT_FALSE(contains(message, "\n")) << message;
  }
  const ScopedEnvironment ocio("OCIO", luts.path());
  const std::string message = message_of<InputError>([] { const DisplayTransform none("test", "missing"); });
  EXPECT_TRUE(contains(message, luts.path()) && contains(message, "nowhere.cube")) << message;
}

}  // namespace
}  // namespace pellucid::gl::test
