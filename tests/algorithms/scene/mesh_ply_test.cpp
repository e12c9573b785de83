#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "tests/algorithms/scene/mesh_formats.hpp"

namespace pellucid {
namespace {

class PlyFiles : public test::MeshFormats {
 protected:
  static std::string header(const std::string& format, const std::string& ending = "\n",
                            const std::string& coordinate = "float", const std::string& index = "int", int faces = 6) {
    std::string text = "ply\nformat " + format + " 1.0\ncomment a box\nobj_info none\nelement vertex 8\nproperty " +
                       coordinate + " x\nproperty " + coordinate + " y\nproperty " + coordinate + " z\nelement face " +
                       std::to_string(faces) + "\nproperty list uchar " + index + " vertex_indices\nend_header\n";
    for (auto at = text.find('\n'); ending != "\n" && at != std::string::npos; at = text.find('\n', at + ending.size()))
      text.replace(at, 1, ending);
    return text;
  }
  template <class Coordinate = float, class Index = std::int32_t>
  static std::string binary(bool swapped = false, double first_x = -0.5) {
    std::string bytes;
    const auto add = [&](auto value) {
      std::string one;
      append(one, value);
      if (swapped) std::reverse(one.begin(), one.end());
      bytes += one;
    };
    for (const glm::dvec3& p : test::kBoxCorners) {
      add(static_cast<Coordinate>(&p == test::kBoxCorners.data() ? first_x : p.x));
      add(static_cast<Coordinate>(p.y));
      add(static_cast<Coordinate>(p.z));
    }
    for (const std::vector<int>& side : test::kBoxSides) {
      add(static_cast<std::uint8_t>(4));
      for (const int corner : side)
        add(static_cast<Index>(corner));
    }
    return bytes;
  }
  static std::string text(int faces = 6) {
    std::string out;
    for (const glm::dvec3& p : test::kBoxCorners)
      out += fmt::format("{} {} {}\n", p.x, p.y, p.z);
    for (int f = 0; f < faces; ++f)
      out += fmt::format("4 {}\n", fmt::join(test::kBoxSides[static_cast<std::size_t>(f)], " "));
    return out;
  }
};

TEST_F(PlyFiles, TextAndBinaryInEitherByteOrderAndEveryLineEnding) {
  expect_box("text.ply", header("ascii") + text());
  for (const std::string ending : {"\n", "\r\n", "\r"}) {
    expect_box("little.ply", header("binary_little_endian", ending) + binary());
    expect_box("big.ply", header("binary_big_endian", ending) + binary(true));
  }
  expect_box("double.ply", header("binary_little_endian", "\n", "double", "uchar") + binary<double, std::uint8_t>());
  expect_box("short.ply", header("binary_little_endian", "\n", "float32", "uint16") + binary<float, std::uint16_t>());
}

// The data's first byte looks like the header's end.
TEST_F(PlyFiles, DataThatBeginWithALineEndStayWhole) {
  for (const std::uint32_t byte : {0x0AU, 0x0DU}) {
    std::uint32_t bits = 0;
    const float half = -0.5F;
    std::memcpy(&bits, &half, 4);
    bits |= byte;
    float first = 0;
    std::memcpy(&first, &bits, 4);
    for (const std::string ending : {"\n", "\r\n"})
      expect_box("first.ply",
                 header("binary_little_endian", ending, "float", "uchar") +
                     binary<float, std::uint8_t>(false, static_cast<double>(first)),
                 2e-6);
  }
}

TEST_F(PlyFiles, TriangleStrips) {
  std::string content = header("ascii");
  content.replace(content.find("element face 6"), 14, "element tristrips 1");
  std::string strip;
  int count = 0;
  for (const std::vector<int>& s : test::kBoxSides) {  // a quad 0 1 2 3 is the strip 0 1 3 2
    strip += fmt::format(" {} {} {} {} -1", s[0], s[1], s[3], s[2]);
    count += 5;
  }
  content.replace(content.find("uchar int"), 9, "int int");
  expect_box("strips.ply", content + text(0) + std::to_string(count) + strip + "\n");
  // Repeated corners turn the strip around and make no triangles.
  const std::string turned =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement "
      "tristrips 1\nproperty list int int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n6 0 1 2 2 2 3\n";
  const Mesh mesh = load_mesh_file(write("turned.ply", turned), 60).mesh;
  ASSERT_EQ(mesh.triangles.size(), 1U);
}

TEST_F(PlyFiles, PropertiesAndElementsThatAreNotUsedArePassedOver) {
  std::string content = header("ascii");
  content.replace(content.find("element face"), 12, "property uchar flags\nelement face");
  content.replace(content.find("property list"), 13,
                  "property int id\nproperty list uchar float texcoord\nproperty list");
  content.replace(content.find("end_header"), 10, "element edge 1\nproperty int a\nproperty int b\nend_header");
  std::string body;
  for (const glm::dvec3& p : test::kBoxCorners)
    body += fmt::format("{} {} {} 1\n", p.x, p.y, p.z);
  for (const std::vector<int>& s : test::kBoxSides)
    body += fmt::format("7 2 0.5 0.5 4 {}\n", fmt::join(s, " "));
  expect_box("more.ply", content + body + "0 1\n");
}

TEST_F(PlyFiles, DamagedFilesAreRefusedInOneLine) {
  EXPECT_EQ(refusal("a.ply", header("ascii") + text(5) + "0 \n"), "face 5 has no corners");
  EXPECT_EQ(refusal("a.ply", header("ascii") + text(5)), "it ends at face 5 of 6");
  EXPECT_EQ(refusal("a.ply", header("binary_little_endian") + binary().substr(0, 181)), "it ends at face 5 of 6");
  EXPECT_EQ(refusal("a.ply", header("binary_little_endian") + binary().substr(0, 180)),
            "face 4 has a list that ends too soon");
  EXPECT_EQ(refusal("a.ply", header("ascii") + text(5) + "4 0 1 3\n"), "face 5 has a list that ends too soon");
  EXPECT_EQ(refusal("a.ply", header("ascii") + text(5) + "4 0 1 3 8\n"), "a face names vertex 8 of 8");
  EXPECT_EQ(refusal("a.ply", header("ascii") + text(5) + "4 0 1 3 x\n"), "face 5 has 'x' for a number in line 25");
  EXPECT_EQ(refusal("a.ply", header("ascii") + text(5) + "4 0 1 3 2 7\n"),
            "face 5 has more numbers than its header says, in line 25");
  EXPECT_EQ(refusal("a.ply", header("ascii") + text() + "4 0 1 3 2\n"),
            "something follows the elements that its header promises");
  EXPECT_EQ(refusal("a.ply", header("binary_little_endian") + binary() + "x"),
            "something follows the elements that its header promises");
  EXPECT_EQ(refusal("a.ply", "ply\nformat ascii 1.0\nelement vertex 3\n"), "its header has no end");
  EXPECT_EQ(refusal("a.ply", "ply\nformat ascii 2.0\nend_header\n"), "version '2.0' is not 1.0 in line 2");
  EXPECT_EQ(refusal("a.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty half x\nend_header\n0\n"),
            "type 'half' is not one of PLY in line 4");
  EXPECT_EQ(refusal("a.ply", "plyformat\n"), "it does not begin with the line 'ply'");
  std::string many = header("binary_little_endian");
  many.replace(many.find("vertex 8"), 8, "vertex 18446744073709551615");
  EXPECT_NE(refusal("a.ply", many + binary()), "");
}

TEST_F(PlyFiles, ColoursAreSharesOrBytes) {
  const auto with = [&](const std::string& type, const std::string& value) {
    return "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty " +
           type + " red\nproperty " + type + " green\nproperty " + type +
           " blue\nelement face 1\nproperty list uchar int vertex_index\nend_header\n0 0 0 0 0 0\n1 0 0 0 0 0\n0 1 0 0 "
           "0 " +
           value + "\n3 0 1 2\n";
  };
  const auto brightest = [&](const std::string& type, const std::string& value) {
    float most = 0;
    for (const glm::vec3& c : load_mesh_file(write("c.ply", with(type, value)), 60).mesh.colors)
      most = std::max(most, c.z);
    return most;
  };
  EXPECT_EQ(brightest("float", "1"), 1);
  EXPECT_EQ(brightest("uchar", "255"), 1);
  EXPECT_EQ(brightest("ushort", "65535"), 1);
  EXPECT_NEAR(brightest("int", "51"), 0.2F, 1e-6);
  EXPECT_EQ(refusal("c.ply", with("float", "255")), "vertex 2 has a colour of 255, out of [0, 1]");
  EXPECT_EQ(refusal("c.ply", with("float", "-1")), "vertex 2 has a colour of -1, out of [0, 1]");
  EXPECT_EQ(refusal("c.ply", with("float", "nan")), "vertex 2 has a colour of nan, out of [0, 1]");
}

TEST_F(PlyFiles, PointsWithoutAPlaceThatNoFaceUsesAreDropped) {
  std::string content = header("ascii");
  content.replace(content.find("vertex 8"), 8, "vertex 9");
  std::string body = text();
  body.insert(body.find("4 0"), "nan nan nan\n");
  EXPECT_EQ(expect_box("nan.ply", content + body).mesh.positions.size(), 24U);
}

}  // namespace
}  // namespace pellucid
