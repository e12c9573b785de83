#include "algorithms/scene/images/image.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <initializer_list>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfTileDescription.h>
#include <ImfTiledOutputFile.h>
#include <gtest/gtest.h>
#include <png.h>

#include "tests/algorithms/scene/folder_test.hpp"

namespace pellucid {
namespace {

using test::message_of;

/// Values that half precision holds exactly.
Image ramp(int width, int height, int channels) {
  Image image(width, height, channels);
  for (std::size_t i = 0; i < image.pixels.size(); ++i)
    image.pixels[i] = static_cast<float>(i % 2048) / 64.0F - 4.0F;
  return image;
}

class ExrTest : public test::FolderTest {
 protected:
  /// One part of float channels, all with the value of their position in the list.
  void write_channels(const std::string& name, std::initializer_list<const char*> channels,
                      Imf::Compression compression, const Imath::Box2i& window = {{0, 0}, {15, 7}}) {
    Imf::Header header(window, window);
    header.compression() = compression;
    std::vector<std::vector<float>> planes;
    Imf::FrameBuffer frame;
    const auto count = static_cast<std::size_t>((window.max.x - window.min.x + 1) * (window.max.y - window.min.y + 1));
    planes.reserve(channels.size());
    for (const char* channel : channels) {
      header.channels().insert(channel, Imf::Channel(Imf::FLOAT));
      planes.emplace_back(count, static_cast<float>(planes.size()));
      frame.insert(channel, Imf::Slice::Make(Imf::FLOAT, planes.back().data(), window));
    }
    Imf::OutputFile out(file(name).c_str(), header);
    out.setFrameBuffer(frame);
    out.writePixels(window.max.y - window.min.y + 1);
  }
};
class PngTest : public test::FolderTest {};

TEST_F(ExrTest, RoundTripKeepsPixelsLayersAndAttributes) {
  ImageFile written;
  written.image = ramp(37, 21, 4);
  written.layers["mask"] = ramp(37, 21, 1);
  written.layers["normal"] = ramp(37, 21, 3);
  written.attributes = {{"pellucid.argv", "pellucid render a.toml"}, {"pellucid.title", "Nebel über Bäumen"}};
  for (const ExrPixel pixel : {ExrPixel::half, ExrPixel::single}) {
    write_exr(file("a.exr"), written, pixel);
    const ImageFile read = read_image(file("a.exr"));
    EXPECT_EQ(read.image.width, 37);
    EXPECT_EQ(read.image.height, 21);
    EXPECT_EQ(read.image.channels, 4);
    EXPECT_EQ(read.image.pixels, written.image.pixels);
    ASSERT_EQ(read.layers.size(), 2U);
    EXPECT_EQ(read.layers.at("mask").pixels, written.layers.at("mask").pixels);
    EXPECT_EQ(read.layers.at("normal").channels, 3);
    EXPECT_EQ(read.layers.at("normal").pixels, written.layers.at("normal").pixels);
    EXPECT_EQ(read.attributes, written.attributes);
    EXPECT_FALSE(read.display_encoded);
  }
  EXPECT_EQ(files(), 1U) << "a temporary file was left behind";
}

TEST_F(ExrTest, HalfRoundsToElevenBitsAndSingleDoesNot) {
  ImageFile written;
  written.image = Image(1, 1, 3);
  written.image.pixels = {0.1F, 1.0F / 3.0F, 1000.3F};
  write_exr(file("half.exr"), written, ExrPixel::half);
  write_exr(file("single.exr"), written, ExrPixel::single);
  const Image half = read_image(file("half.exr")).image;
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NE(half.pixels[i], written.image.pixels[i]);
    EXPECT_NEAR(half.pixels[i] / written.image.pixels[i], 1.0F, 1.0F / 2048.0F);
  }
  EXPECT_EQ(read_image(file("single.exr")).image.pixels, written.image.pixels);
}

TEST_F(ExrTest, ValuesBeyondHalfAreKept) {
  ImageFile written;
  written.image = Image(2, 1, 3);
  written.image.pixels = {1e6F, 0, -2e5F, std::numeric_limits<float>::infinity(), 1, 2};
  write_exr(file("a.exr"), written, ExrPixel::half);
  EXPECT_EQ(read_image(file("a.exr")).image.pixels, written.image.pixels);
}

TEST_F(ExrTest, ReadsEveryCompression) {
  for (const Imf::Compression compression :
       {Imf::NO_COMPRESSION, Imf::RLE_COMPRESSION, Imf::ZIPS_COMPRESSION, Imf::ZIP_COMPRESSION, Imf::PIZ_COMPRESSION,
        Imf::PXR24_COMPRESSION, Imf::B44_COMPRESSION, Imf::B44A_COMPRESSION, Imf::DWAA_COMPRESSION,
        Imf::DWAB_COMPRESSION}) {
    write_channels("a.exr", {"B", "G", "R"}, compression);
    const Image image = read_image(file("a.exr")).image;
    ASSERT_EQ(image.channels, 3);
    for (int x = 0; x < image.width; ++x) {
      EXPECT_NEAR(image.at(x, 5)[0], 2, 0.01);
      EXPECT_NEAR(image.at(x, 5)[1], 1, 0.01);
      EXPECT_NEAR(image.at(x, 5)[2], 0, 0.01);
    }
  }
}

TEST_F(ExrTest, ADataWindowAwayFromTheOriginIsRead) {
  write_channels("a.exr", {"B", "G", "R"}, Imf::ZIP_COMPRESSION, {{-100, 200}, {-90, 240}});
  const Image image = read_image(file("a.exr")).image;
  EXPECT_EQ(image.width, 11);
  EXPECT_EQ(image.height, 41);
  EXPECT_EQ(image.at(10, 40)[0], 2);
}

TEST_F(ExrTest, LuminanceGivesOneChannelAndOthersAreLayers) {
  write_channels("y.exr", {"Y", "Z"}, Imf::ZIP_COMPRESSION);
  const ImageFile read = read_image(file("y.exr"));
  EXPECT_EQ(read.image.channels, 1);
  EXPECT_EQ(read.image.pixels.front(), 0);
  ASSERT_TRUE(read.layers.contains("Z"));
  EXPECT_EQ(read.layers.at("Z").pixels.front(), 1);
}

TEST_F(ExrTest, LayerChannelsComeAsColourThenByName) {
  write_channels("l.exr", {"B", "G", "R", "a.b.B", "a.b.G", "a.b.R", "v.x", "v.y"}, Imf::ZIP_COMPRESSION);
  const ImageFile read = read_image(file("l.exr"));
  ASSERT_EQ(read.layers.size(), 2U);
  const Image& color = read.layers.at("a.b");
  EXPECT_EQ((std::array{color.pixels[0], color.pixels[1], color.pixels[2]}), (std::array{5.0F, 4.0F, 3.0F}));
  EXPECT_EQ(read.layers.at("v").pixels[1], 7);
}

TEST_F(ExrTest, PartsAfterTheFirstBecomeLayers) {
  const Imath::Box2i window({0, 0}, {3, 1});
  std::vector<Imf::Header> headers;
  for (const char* name : {"beauty", "albedo"}) {
    Imf::Header header(window, window);
    header.setName(name);
    header.setType(Imf::SCANLINEIMAGE);
    for (const char* channel : {"R", "G", "B"})
      header.channels().insert(channel, Imf::Channel(Imf::FLOAT));
    headers.push_back(header);
  }
  {
    Imf::MultiPartOutputFile out(file("m.exr").c_str(), headers.data(), 2);
    for (int part = 0; part < 2; ++part) {
      std::vector<float> plane(8, static_cast<float>(part + 1));
      Imf::FrameBuffer frame;
      for (const char* channel : {"R", "G", "B"})
        frame.insert(channel, Imf::Slice::Make(Imf::FLOAT, plane.data(), window));
      Imf::OutputPart output(out, part);
      output.setFrameBuffer(frame);
      output.writePixels(2);
    }
  }
  const ImageFile read = read_image(file("m.exr"));
  EXPECT_EQ(read.image.pixels, std::vector<float>(24, 1.0F));
  ASSERT_TRUE(read.layers.contains("albedo"));
  EXPECT_EQ(read.layers.at("albedo").pixels, std::vector<float>(24, 2.0F));
}

TEST_F(ExrTest, TiledFilesAreRead) {
  Imf::Header header(50, 30);
  for (const char* channel : {"R", "G", "B"})
    header.channels().insert(channel, Imf::Channel(Imf::FLOAT));
  header.setTileDescription({16, 16, Imf::ONE_LEVEL});
  std::vector<float> plane(50 * 30, 0.25F);
  Imf::FrameBuffer frame;
  for (const char* channel : {"R", "G", "B"}) {
    frame.insert(channel, Imf::Slice::Make(Imf::FLOAT, plane.data(), header.dataWindow()));
  }
  {
    Imf::TiledOutputFile out(file("t.exr").c_str(), header);
    out.setFrameBuffer(frame);
    out.writeTiles(0, out.numXTiles() - 1, 0, out.numYTiles() - 1);
  }
  EXPECT_EQ(read_image(file("t.exr")).image.pixels, std::vector<float>(50 * 30 * 3, 0.25F));
  // A tile is memory whether the picture fills it or not.
  std::string damaged = content(file("t.exr"));
  const auto at = damaged.find(std::string("tiledesc\0", 9)) + 9 + 4;
  damaged.replace(at, 8, std::string("\x20\x4e\0\0\x20\x4e\0\0", 8));  // 20,000 a side
  EXPECT_EQ(message_of([&] { read_image(write("d.exr", damaged)); }),
            "cannot read image '" + file("d.exr").string() +
                "': its tiles of 20000x20000 pixels are too large for its 50x30 pixels");
}

TEST_F(ExrTest, AnyTruncationIsAnInputError) {
  ImageFile written;
  written.image = ramp(64, 48, 3);
  write_exr(file("a.exr"), written);
  const std::string whole = content(file("a.exr"));
  for (std::size_t keep = 0; keep < whole.size(); keep += keep < 600 ? 13 : 257) {
    const auto path = write("cut.exr", whole.substr(0, keep));
    EXPECT_THROW(read_image(path), InputError) << keep << " of " << whole.size() << " bytes";
  }
  EXPECT_THROW(read_image(write("cut.exr", whole.substr(0, whole.size() - 1))), InputError);
  EXPECT_EQ(message_of([&] { read_image(write("cut.exr", whole.substr(0, whole.size() / 2))); }),
            "cannot read image '" + file("cut.exr").string() + "': the OpenEXR file is truncated or damaged");
}

TEST_F(ExrTest, DamagedBytesNeverCrash) {
  ImageFile written;
  written.image = ramp(40, 40, 3);
  write_exr(file("a.exr"), written);
  const std::string whole = content(file("a.exr"));
  int refused = 0;
  for (std::size_t at = 0; at < whole.size(); at += 7) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x5a);
    try {
      read_image(write("d.exr", damaged));
    } catch (const InputError&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 0);
}

/// Replaces the data window in the header of `file` by one of the given corners.
std::string with_data_window(std::string exr, std::array<std::int32_t, 4> corners) {
  const std::string key("dataWindow\0box2i\0", 17);
  const auto at = exr.find(key);
  EXPECT_NE(at, std::string::npos);
  exr.replace(at + key.size() + 4, sizeof corners, reinterpret_cast<const char*>(corners.data()), sizeof corners);
  return exr;
}

TEST_F(ExrTest, AHeaderThatClaimsTooMuchIsRefusedBeforeAllocating) {
  ImageFile written;
  written.image = ramp(8, 8, 3);
  write_exr(file("a.exr"), written);
  const std::string whole = content(file("a.exr"));
  const std::string refusal = "cannot read image '" + file("big.exr").string() + "': ";
  EXPECT_EQ(message_of([&] {
              read_image(write("big.exr", with_data_window(whole, {0, 0, 99999, 99999})));
            }),
            refusal + "100000x100000 pixels is out of range; width and height must be in [1, 16384]");
  // As large as allowed, but the file holds nothing of it.
  EXPECT_EQ(message_of([&] {
              read_image(write("big.exr", with_data_window(whole, {0, 0, 16383, 16383})));
            }),
            refusal + "the OpenEXR file is truncated or damaged");
  // Each chunk lies within the file, and none can hold so much.
  written.image = ramp(8, 4096, 3);
  write_exr(file("tall.exr"), written);
  const std::string tall = with_data_window(content(file("tall.exr")), {0, 0, 16383, 4095});
  EXPECT_NE(message_of([&] { read_image(write("big.exr", tall)); }).find("16384x4096 pixels of 6 bytes cannot lie in"),
            std::string::npos);
  for (const auto& corners : {std::array<std::int32_t, 4>{5, 5, 4, 4},
                              {0, 0, -1, 7},
                              {-2147483647 - 1, 0, 2147483647, 7},
                              {0, 0, 2147483647, 2147483647}}) {
    EXPECT_THROW(read_image(write("big.exr", with_data_window(whole, corners))), InputError);
  }
}

// The C++ library reads a value by its type, and what follows by the size that is stated.
TEST_F(ExrTest, AnAttributeOfAnotherSizeThanItsTypeIsRefused) {
  write_channels("a.exr", {"R", "G", "B"}, Imf::NO_COMPRESSION);
  const std::string whole = content(file("a.exr"));
  for (const std::string_view key :
       {std::string_view("compression\0compression\0", 24), std::string_view("\0chlist\0", 8)}) {
    for (const char size : {'\0', '\2', '\x7f'}) {
      std::string damaged = whole;
      damaged.at(damaged.find(key) + key.size()) = size;
      EXPECT_EQ(message_of([&] { read_image(write("b.exr", damaged)); }),
                "cannot read image '" + file("b.exr").string() + "': the OpenEXR file is truncated or damaged");
    }
  }
}

TEST_F(ExrTest, ChannelsWithoutColourAreNamed) {
  write_channels("z.exr", {"N.x", "Z"}, Imf::ZIP_COMPRESSION);
  EXPECT_EQ(message_of([&] { read_image(file("z.exr")); }),
            "cannot read image '" + file("z.exr").string() + "': no channels R, G, B or Y; it has N.x, Z");
}

TEST_F(ExrTest, WhatIsNoImageSaysSo) {
  const auto refusal = [&](std::string_view name) { return "cannot read image '" + file(name).string() + "': "; };
  EXPECT_EQ(message_of([&] { read_image(file("none.exr")); }), refusal("none.exr") + "No such file or directory");
  EXPECT_EQ(message_of([&] { read_image(write("e.exr", "")); }), refusal("e.exr") + "the file is empty");
  EXPECT_EQ(message_of([&] { read_image(write("t.exr", "title = 1")); }), refusal("t.exr") + "neither OpenEXR nor PNG");
  EXPECT_EQ(message_of([&] { read_image(folder_.path()); }),
            "cannot read image '" + folder_.path().string() + "': not a regular file");
}

TEST_F(ExrTest, AFailedWriteNamesTheReasonAndKeepsTheOldFile) {
  ImageFile image;
  image.image = ramp(64, 64, 3);
  EXPECT_EQ(message_of<RuntimeError>([&] { write_exr(file("no/such/a.exr"), image); }),
            "cannot write '" + file("no/such/a.exr").string() + "': No such file or directory");
  EXPECT_EQ(message_of<RuntimeError>([&] { write_exr("/dev/full", image); }),
            "cannot write '/dev/full': No space left on device");
  EXPECT_EQ(message_of<RuntimeError>([&] { write_exr(folder_.path(), image); }),
            "cannot write '" + folder_.path().string() + "': Is a directory");
  EXPECT_EQ(message_of<RuntimeError>([&] { write_png("/dev/full", image.image); }),
            "cannot write '/dev/full': No space left on device");
  write("old.exr", "old");
  image.attributes["compression"] = "an attribute of another type in every file";
  EXPECT_THROW(write_exr(file("old.exr"), image), RuntimeError);
  EXPECT_EQ(content(file("old.exr")), "old");
  EXPECT_EQ(files(), 1U) << "a temporary file was left behind";
}

TEST_F(ExrTest, ALinkIsFollowed) {
  ImageFile image;
  image.image = ramp(4, 4, 3);
  write("real.exr", "old");
  std::filesystem::create_symlink(file("real.exr"), file("link.exr"));
  write_exr(file("link.exr"), image);
  EXPECT_TRUE(std::filesystem::is_symlink(file("link.exr")));
  EXPECT_EQ(read_image(file("real.exr")).image.pixels, image.image.pixels);
}

TEST_F(PngTest, RoundTripKeepsBytesAndTexts) {
  for (const int channels : {1, 3, 4}) {
    Image image(19, 11, channels);
    for (std::size_t i = 0; i < image.pixels.size(); ++i)
      image.pixels[i] = static_cast<float>(i % 256) / 255.0F;
    const Attributes texts = {{"pellucid.scene", "Nebel über Bäumen"}, {"pellucid.commit", "0123"}};
    write_png(file("a.png"), image, texts);
    const ImageFile read = read_image(file("a.png"));
    EXPECT_EQ(read.image.channels, channels);
    EXPECT_EQ(read.image.pixels, image.pixels);
    EXPECT_EQ(read.attributes, texts);
    EXPECT_TRUE(read.display_encoded);
  }
  EXPECT_EQ(files(), 1U);
}

TEST_F(PngTest, ValuesAreClampedAndRounded) {
  Image image(2, 1, 3);
  image.pixels = {-1.0F, 2.0F, 0.5F, 0.4999F / 255.0F, 0.5001F / 255.0F, std::numeric_limits<float>::quiet_NaN()};
  write_png(file("a.png"), image);
  const std::vector<float> expected = {0, 1, 128.0F / 255.0F, 0, 1.0F / 255.0F, 0};
  EXPECT_EQ(read_image(file("a.png")).image.pixels, expected);
}

/// A 2×1 PNG of any layout, by libpng's own hand.
void write_raw_png(const std::filesystem::path& path, int type, int depth, std::vector<png_byte> row) {
  std::FILE* out = std::fopen(path.c_str(), "wb");
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_init_io(png, out);
  png_set_IHDR(png, info, 2, 1, depth, type, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  const png_color palette[2] = {{255, 0, 0}, {0, 51, 255}};
  if (type == PNG_COLOR_TYPE_PALETTE) png_set_PLTE(png, info, palette, 2);
  png_write_info(png, info);
  png_write_row(png, row.data());
  png_write_end(png, info);
  png_destroy_write_struct(&png, &info);
  std::fclose(out);
}

TEST_F(PngTest, SixteenBitsPalettesAndGrayAlphaAreRead) {
  write_raw_png(file("16.png"), PNG_COLOR_TYPE_GRAY, 16, {0x12, 0x34, 0xff, 0xff});
  EXPECT_EQ(read_image(file("16.png")).image.pixels, (std::vector<float>{0x1234 / 65535.0F, 1.0F}));
  write_raw_png(file("p.png"), PNG_COLOR_TYPE_PALETTE, 1, {0x40});
  EXPECT_EQ(read_image(file("p.png")).image.pixels, (std::vector<float>{1, 0, 0, 0, 0.2F, 1}));
  write_raw_png(file("ga.png"), PNG_COLOR_TYPE_GRAY_ALPHA, 8, {51, 255, 255, 0});
  EXPECT_EQ(read_image(file("ga.png")).image.pixels, (std::vector<float>{0.2F, 0.2F, 0.2F, 1, 1, 1, 1, 0}));
}

TEST_F(PngTest, AnyTruncationOrDamageIsAnInputError) {
  write_png(file("a.png"), ramp(32, 32, 3), {{"pellucid.scene", "s"}});
  const std::string whole = content(file("a.png"));
  for (std::size_t keep = 0; keep < whole.size(); keep += 11) {
    EXPECT_THROW(read_image(write("cut.png", whole.substr(0, keep))), InputError) << keep;
  }
  for (std::size_t at = 8; at + 12 < whole.size(); at += 5) {  // each byte is under some chunk's checksum
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x5a);
    EXPECT_THROW(read_image(write("d.png", damaged)), InputError) << at;
  }
}

TEST_F(PngTest, AChunkBeyondTheEndIsRefused) {
  write_png(file("a.png"), ramp(8, 8, 3), {{"pellucid.scene", "s"}});
  std::string whole = content(file("a.png"));
  whole.at(whole.find("iTXt") - 4) = '\x30';  // of 800 MB
  EXPECT_EQ(message_of([&] { read_image(write("b.png", whole)); }),
            "cannot read image '" + file("b.png").string() + "': the PNG file is truncated or damaged");
}

TEST_F(PngTest, AHugeHeaderIsRefused) {
  std::FILE* out = std::fopen(file("big.png").c_str(), "wb");
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_init_io(png, out);
  png_set_IHDR(png, info, 100000, 100000, 8, PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  png_write_info(png, info);
  const png_byte data[] = {0x78, 0x9c};
  png_write_chunk(png, reinterpret_cast<png_const_bytep>("IDAT"), data, sizeof data);
  png_write_chunk(png, reinterpret_cast<png_const_bytep>("IEND"), nullptr, 0);
  png_destroy_write_struct(&png, &info);
  std::fclose(out);
  EXPECT_EQ(message_of([&] { read_image(file("big.png")); }),
            "cannot read image '" + file("big.png").string() +
                "': 100000x100000 pixels is out of range; width and height must be in [1, 16384]");
}

TEST(ImageSize, IsBounded) {
  EXPECT_NO_THROW(check_image_size(1, 16384, "x"));
  EXPECT_EQ(test::message_of([] { check_image_size(0, 5, "--size"); }),
            "--size: 0x5 pixels is out of range; width and height must be in [1, 16384]");
  EXPECT_THROW(check_image_size(16385, 1, "x"), InputError);
  EXPECT_THROW(check_image_size(-3, 1, "x"), InputError);
}

}  // namespace
}  // namespace pellucid
