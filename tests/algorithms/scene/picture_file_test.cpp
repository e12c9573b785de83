#include "algorithms/scene/images/picture_file.hpp"

#include <cmath>
#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <ImfChannelList.h>
#include <ImfDeepFrameBuffer.h>
#include <ImfDeepScanLineOutputPart.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIntAttribute.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfStandardAttributes.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <png.h>

#include "algorithms/scene/images/chromaticities.hpp"
#include "tests/algorithms/scene/folder_test.hpp"
#include "tests/expect_near.hpp"

namespace pellucid {
namespace {

using Channels = std::vector<std::pair<std::string, float>>;

class PictureFiles : public test::FolderTest {
 protected:
  static Imf::Header header_of(const Imath::Box2i& display, const Imath::Box2i& data, const Channels& channels) {
    Imf::Header header(display, data);
    for (const auto& [name, value] : channels)
      header.channels().insert(name, Imf::Channel(Imf::FLOAT));
    return header;
  }
  /// Each channel has one value everywhere, plus the pixel's x + 100 y where `places` says so.
  static Imf::FrameBuffer planes_of(const Imath::Box2i& data, const Channels& channels, bool places,
                                    std::vector<std::vector<float>>& planes) {
    Imf::FrameBuffer frame;
    planes.reserve(planes.size() + channels.size());
    for (const auto& [name, value] : channels) {
      std::vector<float>& plane = planes.emplace_back();
      for (int y = data.min.y; y <= data.max.y; ++y)
        for (int x = data.min.x; x <= data.max.x; ++x)
          plane.push_back(value + (places ? static_cast<float>(x + 100 * y) : 0.0F));
      frame.insert(name, Imf::Slice::Make(Imf::FLOAT, plane.data(), data));
    }
    return frame;
  }
  std::filesystem::path write_exr_of(const std::string& name, const Imath::Box2i& display, const Imath::Box2i& data,
                                     const Channels& channels, const std::function<void(Imf::Header&)>& change = {}) {
    Imf::Header header = header_of(display, data, channels);
    if (change) change(header);
    std::vector<std::vector<float>> planes;
    Imf::OutputFile out(file(name).c_str(), header);
    out.setFrameBuffer(planes_of(data, channels, !change, planes));
    out.writePixels(data.max.y - data.min.y + 1);
    return file(name);
  }
  std::filesystem::path write_parts(const std::string& name,
                                    const std::vector<std::pair<std::string, Channels>>& parts) {
    const Imath::Box2i window({0, 0}, {7, 5});
    std::vector<Imf::Header> headers;
    for (const auto& [part, channels] : parts) {
      headers.push_back(header_of(window, window, channels));
      headers.back().setName(part);
      headers.back().setType(Imf::SCANLINEIMAGE);
      if (part == "left" || part == "right") headers.back().setView(part);
    }
    Imf::MultiPartOutputFile out(file(name).c_str(), headers.data(), static_cast<int>(headers.size()));
    for (std::size_t i = 0; i < parts.size(); ++i) {
      std::vector<std::vector<float>> planes;
      Imf::OutputPart part(out, static_cast<int>(i));
      part.setFrameBuffer(planes_of(window, parts[i].second, false, planes));
      part.writePixels(6);
    }
    return file(name);
  }
};

const Channels kRgb{{"R", 1.0F}, {"G", 2.0F}, {"B", 3.0F}};
const Imath::Box2i kDisplay({10, 20}, {25, 31});  // 16 x 12

float expected(int x, int y, const Imath::Box2i& data) {
  const int px = x + kDisplay.min.x, py = y + kDisplay.min.y;
  return data.intersects(Imath::V2i(px, py)) ? 1.0F + static_cast<float>(px + 100 * py) : 0.0F;
}

// A crop, a larger one (overscan), one half outside, one wholly outside: the picture is always the display window.
TEST_F(PictureFiles, AnExrsPictureIsItsDisplayWindow) {
  for (const Imath::Box2i& data : {kDisplay, Imath::Box2i({12, 22}, {14, 25}), Imath::Box2i({-5, -7}, {40, 50}),
                                   Imath::Box2i({20, 28}, {60, 30}), Imath::Box2i({-30, 0}, {-20, 100})}) {
    const PictureFile read =
        read_picture(write_exr_of("a.exr", kDisplay, data, {{"R", 1}, {"G", 1}, {"B", 1}, {"mask", 1}}));
    ASSERT_EQ(read.image.width, 16);
    ASSERT_EQ(read.image.height, 12);
    ASSERT_TRUE(read.layers.contains("mask"));
    for (int y = 0; y < 12; ++y) {
      for (int x = 0; x < 16; ++x) {
        EXPECT_EQ(read.image.at(x, y)[1], expected(x, y, data)) << x << " " << y;
        EXPECT_EQ(read.layers.at("mask").at(x, y)[0], expected(x, y, data));
      }
    }
  }
  EXPECT_EQ(size_text(read_picture(write_exr_of("a.exr", kDisplay, {{12, 22}, {14, 25}}, kRgb))),
            "16x12 pixels (display window (10, 20)-(25, 31), data window (12, 22)-(14, 25))");
  EXPECT_EQ(size_text(read_picture(write_exr_of("a.exr", kDisplay, kDisplay, kRgb))), "16x12 pixels");
}

TEST_F(PictureFiles, ADisplayWindowTooLargeIsRefusedBeforeAllocating) {
  const auto path = write_exr_of("a.exr", {{0, 0}, {99999, 99999}}, {{0, 0}, {3, 3}}, kRgb);
  EXPECT_NE(test::message_of([&] { read_picture(path); }).find("100000x100000 pixels is out of range"),
            std::string::npos);
}

// Sixteen pixels are no reason to take 2 GB, though each side is within its range.
TEST_F(PictureFiles, AnEmptyPictureOfGreatSizeIsRefusedBeforeAllocating) {
  const auto path = write_exr_of("a.exr", {{0, 0}, {13999, 11999}}, {{0, 0}, {3, 3}}, kRgb);
  EXPECT_NE(test::message_of([&] { read_picture(path); }).find("3 channels of 14000x12000 pixels are too much to read"),
            std::string::npos);
  const auto below = write_exr_of("b.exr", {{0, 0}, {1399, 1199}}, {{1300, 1100}, {1303, 1103}}, kRgb);
  EXPECT_EQ(read_picture(below).image.at(1303, 1103)[0], 1 + 1303 + 100 * 1103);
}

TEST_F(PictureFiles, ManyChannelsAndOnlyThoseThatAreWanted) {
  Channels channels = kRgb;
  for (int i = 0; i < 300; ++i)
    channels.emplace_back(fmt::format("aov{:03}.X", i), static_cast<float>(i));
  const auto path = write_exr_of("a.exr", kDisplay, kDisplay, channels);
  const PictureFile read = read_picture(path, [](const std::string& layer) { return layer == "aov007"; });
  EXPECT_EQ(read.layer_names.size(), 300U);
  ASSERT_EQ(read.layers.size(), 1U);
  EXPECT_EQ(read.layers.at("aov007").at(0, 0)[0], 7 + 10 + 2000);
  EXPECT_TRUE(read_picture(path, no_layer).layers.empty());
}

TEST_F(PictureFiles, ThePictureIsThePartWithColours) {
  const auto depth_first = write_parts("d.exr", {{"depth", {{"Z", 7}}}, {"beauty", kRgb}});
  EXPECT_EQ(read_picture(depth_first).image.at(3, 3)[2], 3);
  EXPECT_TRUE(read_picture(depth_first).layers.contains("Z"));
  const auto stereo = write_parts("s.exr", {{"left", kRgb}, {"right", {{"R", 4}, {"G", 5}, {"B", 6}}}});
  EXPECT_EQ(read_picture(stereo).image.at(0, 0)[0], 1);
  EXPECT_EQ(read_picture(stereo).layers.at("right").at(0, 0)[0], 4);
  const auto luminance = write_parts("y.exr", {{"depth", {{"Z", 7}}}, {"grey", {{"Y", 5}}}});
  EXPECT_EQ(read_picture(luminance).image.channels, 1);
  EXPECT_EQ(test::message_of([&] {
              read_picture(write_parts("z.exr", {{"depth", {{"Z", 7}}}, {"n", {{"N.X", 7}}}}));
            }),
            "cannot read image '" + file("z.exr").string() +
                "': no channels R, G, B or Y; it has Z in part 'depth'; N.X in part 'n'");
}

TEST_F(PictureFiles, TheOnlyLayerOfColoursIsThePicture) {
  const auto one =
      write_exr_of("a.exr", kDisplay, kDisplay, {{"v.R", 1}, {"v.G", 2}, {"v.B", 3}, {"v.Z", 9}, {"Z", 8}});
  const PictureFile read = read_picture(one);
  EXPECT_EQ(read.image.channels, 3);
  EXPECT_EQ(read.notes.size(), 1U);
  const auto two = write_exr_of("a.exr", kDisplay, kDisplay,
                                {{"v.R", 1}, {"v.G", 2}, {"v.B", 3}, {"w.R", 1}, {"w.G", 2}, {"w.B", 3}});
  EXPECT_NE(test::message_of([&] { read_picture(two); }).find("R, G and B lie in the layers v, w"), std::string::npos);
}

TEST_F(PictureFiles, DeepPartsArePassedOver) {
  const Imath::Box2i window({0, 0}, {3, 1});
  const auto write_deep = [&](const std::string& name, bool with_flat) {
    std::vector<Imf::Header> headers{header_of(window, window, {{"Z", 0.0F}}), header_of(window, window, kRgb)};
    headers[0].setName("deep");
    headers[0].setType(Imf::DEEPSCANLINE);
    headers[0].setVersion(1);
    headers[0].insert("maxSamplesPerPixel", Imf::IntAttribute(1));
    headers[0].compression() = Imf::ZIPS_COMPRESSION;
    headers[1].setName("flat");
    headers[1].setType(Imf::SCANLINEIMAGE);
    Imf::MultiPartOutputFile out(file(name).c_str(), headers.data(), with_flat ? 2 : 1);
    std::vector<unsigned> counts(8, 1);
    std::vector<float> depths(8, 5.0F);
    std::vector<float*> pointers;
    for (float& depth : depths)
      pointers.push_back(&depth);
    Imf::DeepFrameBuffer deep;
    deep.insertSampleCountSlice(
        Imf::Slice(Imf::UINT, reinterpret_cast<char*>(counts.data()), sizeof(unsigned), 4 * sizeof(unsigned)));
    deep.insert("Z", Imf::DeepSlice(Imf::FLOAT, reinterpret_cast<char*>(pointers.data()), sizeof(float*),
                                    4 * sizeof(float*), sizeof(float)));
    Imf::DeepScanLineOutputPart part(out, 0);
    part.setFrameBuffer(deep);
    part.writePixels(2);
    if (!with_flat) return;
    std::vector<std::vector<float>> planes;
    Imf::OutputPart flat(out, 1);
    flat.setFrameBuffer(planes_of(window, kRgb, false, planes));
    flat.writePixels(2);
  };
  write_deep("both.exr", true);
  const PictureFile read = read_picture(file("both.exr"));
  EXPECT_EQ(read.image.at(3, 1)[2], 3);
  EXPECT_EQ(read.notes, std::vector<std::string>{"its deep parts are not read"});
  write_deep("deep.exr", false);
  EXPECT_EQ(
      test::message_of([&] { read_picture(file("deep.exr")); }),
      "cannot read image '" + file("deep.exr").string() + "': it has nothing but deep data; flat images are read");
}

// ---- colours ----

const Chromaticities kXyz{{1, 0}, {0, 1}, {0, 0}, {1.0 / 3, 1.0 / 3}};
const Chromaticities kRec2020{{0.708, 0.292}, {0.170, 0.797}, {0.131, 0.046}, {0.3127, 0.3290}};
const Chromaticities kAcescg{{0.713, 0.293}, {0.165, 0.830}, {0.128, 0.044}, {0.32168, 0.33767}};

using test::expect_near;

TEST(Chromaticities, KnownMatrices) {
  // IEC 61966-2-1, amendment 1: XYZ to linear sRGB, to the digits that it gives.
  const glm::dmat3 xyz = to_rec709(kXyz);
  expect_near(xyz * glm::dvec3(1, 0, 0), {3.2406, -0.9689, 0.0557}, 6e-4);
  expect_near(xyz * glm::dvec3(0, 1, 0), {-1.5372, 1.8758, -0.2040}, 6e-4);
  // ITU-R BT.2087: BT.2020 to BT.709.
  const glm::dmat3 wide = to_rec709(kRec2020);
  expect_near(wide * glm::dvec3(1, 0, 0), {1.6605, -0.1246, -0.0182}, 2e-4);
  expect_near(wide * glm::dvec3(0, 0, 1), {-0.0728, -0.0083, 1.1187}, 2e-4);
  // White stays white where it is adapted (ACEScg's is near D60).
  for (const Chromaticities& space : {kRec2020, kAcescg})
    expect_near(to_rec709(space) * glm::dvec3(1), glm::dvec3(1), 1e-9);
  // ACES 1.3, ACEScg to linear Rec. 709 with Bradford.
  expect_near(to_rec709(kAcescg) * glm::dvec3(1, 0, 0), {1.70505, -0.13026, -0.02400}, 2e-3);
  EXPECT_THROW(to_rec709({{0.3, 0.3}, {0.3, 0.3}, {0.1, 0.1}, {0.3, 0.3}}), InputError);
}

TEST_F(PictureFiles, OtherPrimariesAreConvertedAndRec709IsLeftAlone) {
  const auto with = [&](const Chromaticities& c) {
    return [c](Imf::Header& header) {
      const auto v = [](const glm::dvec2& xy) {
        return Imath::V2f(static_cast<float>(xy.x), static_cast<float>(xy.y));
      };
      Imf::addChromaticities(header, {v(c.red), v(c.green), v(c.blue), v(c.white)});
    };
  };
  const PictureFile plain = read_picture(write_exr_of("p.exr", kDisplay, kDisplay, kRgb, with({})));
  EXPECT_EQ(plain.image.at(0, 0)[2], 3);
  EXPECT_TRUE(plain.notes.empty());
  const PictureFile wide = read_picture(write_exr_of("w.exr", kDisplay, kDisplay, kRgb, with(kRec2020)));
  const glm::dvec3 right = to_rec709(kRec2020) * glm::dvec3(1, 2, 3);
  expect_near({wide.image.at(0, 0)[0], wide.image.at(0, 0)[1], wide.image.at(0, 0)[2]}, right, 1e-5);
  ASSERT_EQ(wide.notes.size(), 1U);
  EXPECT_TRUE(wide.notes[0].starts_with("converted to Rec. 709 from primaries (0.708, 0.292)")) << wide.notes[0];
}

/// A grey PNG of 1x1 with a chunk of colour information.
void write_png_of(const std::filesystem::path& path, const std::function<void(png_structp, png_infop)>& say) {
  std::FILE* out = std::fopen(path.c_str(), "wb");
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_init_io(png, out);
  png_set_IHDR(png, info, 1, 1, 8, PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  say(png, info);
  png_write_info(png, info);
  const png_byte row = 51;  // 0.2
  png_write_row(png, &row);
  png_write_end(png, info);
  png_destroy_write_struct(&png, &info);
  std::fclose(out);
}

TEST_F(PictureFiles, APngsGammaIsFollowedAndTheRestIsTold) {
  const auto read = [&](const std::function<void(png_structp, png_infop)>& say) {
    write_png_of(file("a.png"), say);
    PictureFile picture = read_picture(file("a.png"));
    EXPECT_NEAR(picture.image.pixels[0], 0.2F, 1e-6) << "as encoded";
    encode_as_srgb(picture);
    return picture;
  };
  EXPECT_TRUE(read([](png_structp, png_infop) {}).notes.empty());
  EXPECT_TRUE(read([](png_structp p, png_infop i) {
                png_set_sRGB_gAMA_and_cHRM(p, i, PNG_sRGB_INTENT_PERCEPTUAL);
              }).notes.empty());
  EXPECT_TRUE(read([](png_structp p, png_infop i) { png_set_gAMA(p, i, 0.45455); }).notes.empty());
  const PictureFile linear = read([](png_structp p, png_infop i) { png_set_gAMA(p, i, 1.0); });
  EXPECT_NEAR(linear.image.pixels[0], 0.48453F, 1e-4) << "sRGB's code of light 0.2";
  EXPECT_EQ(linear.notes.size(), 1U);
  const PictureFile old = read([](png_structp p, png_infop i) { png_set_gAMA(p, i, 1 / 1.8); });
  EXPECT_NEAR(old.image.pixels[0], 1.055 * std::pow(std::pow(0.2, 1.8), 1 / 2.4) - 0.055, 1e-4);
  EXPECT_EQ(read([](png_structp p, png_infop i) {
              png_set_cHRM(p, i, 0.3127, 0.329, 0.708, 0.292, 0.17, 0.797, 0.131, 0.046);
            }).notes.size(),
            1U);
}

// One bit a pixel packs 1032-fold and becomes three numbers of 32 bits.
TEST_F(PictureFiles, APngThatUnpacksToGigabytesIsRefusedBeforeAllocating) {
  constexpr png_uint_32 kWidth = 16384, kHeight = 8192;
  std::FILE* out = std::fopen(file("a.png").c_str(), "wb");
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_init_io(png, out);
  png_set_IHDR(png, info, kWidth, kHeight, 1, PNG_COLOR_TYPE_PALETTE, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  const png_color black{};
  png_set_PLTE(png, info, &black, 1);
  png_set_compression_level(png, 1);
  png_write_info(png, info);
  const std::vector<png_byte> row(kWidth / 8);
  for (png_uint_32 y = 0; y < kHeight; ++y)
    png_write_row(png, row.data());
  png_write_end(png, info);
  png_destroy_write_struct(&png, &info);
  std::fclose(out);
  EXPECT_NE(test::message_of([&] {
              read_picture(file("a.png"));
            }).find("3 channels of 16384x8192 pixels are too much to read: 1536 MiB"),
            std::string::npos);
}

TEST(ExactPixel, IsHalfWhereHalfHoldsEveryValue) {
  Image image(2, 1, 3);
  image.pixels = {0, 0.5F, 65504, -2, 1.0F / 1024, 3};
  EXPECT_EQ(exact_pixel(image), ExrPixel::half);
  image.pixels[1] = 0.1F;
  EXPECT_EQ(exact_pixel(image), ExrPixel::single);
  image.pixels[1] = 65510;
  EXPECT_EQ(exact_pixel(image), ExrPixel::single);
}

}  // namespace
}  // namespace pellucid
