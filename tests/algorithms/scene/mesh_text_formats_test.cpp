#include <cstddef>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "tests/algorithms/scene/mesh_formats.hpp"

/// OFF and OBJ.
namespace pellucid {
namespace {

class TextMeshes : public test::MeshFormats {
 protected:
  static std::string off(const std::string& head, const std::string& behind_vertex = "",
                         const std::string& behind_face = "", const std::string& between = "") {
    std::string out = head;
    for (const glm::dvec3& p : test::kBoxCorners)
      out += between + fmt::format("{} {} {}{}\n", p.x, p.y, p.z, behind_vertex);
    for (const std::vector<int>& side : test::kBoxSides)
      out += between + fmt::format("4 {}{}\n", fmt::join(side, " "), behind_face);
    return out;
  }
  static std::string obj(const std::string& before_faces, const std::vector<std::string>& corner_formats) {
    std::string out;
    for (const glm::dvec3& p : test::kBoxCorners)
      out += fmt::format("v {} {} {}\n", p.x, p.y, p.z);
    out += before_faces;
    for (std::size_t s = 0; s < 6; ++s) {
      out += "f";
      for (const int corner : test::kBoxSides[s])
        out += " " + fmt::format(fmt::runtime(corner_formats[s % corner_formats.size()]), corner + 1, s + 1);
      out += "\n";
    }
    return out;
  }
};

TEST_F(TextMeshes, OffInItsDialects) {
  for (const char* head : {"OFF\n8 6 0\n", "OFF 8 6 12\n", "OFF8 6 0\n", "8 6 0\n", "OFF\n8\n6\n0\n",
                           "# by hand\nOFF # here\n\n8 6 0 # counts\n", "OFF\r\n8 6 0\r\n"})
    expect_box("a.off", off(head));
  expect_box("a.off", off("OFF\n8 6 0\n", "", "", "# next\n\n"));
  expect_box("a.off", off("OFF\n8 6 0\n", " # corner", "  # side"));
  expect_box("a.off", off("OFF\n8 6 0\n", "", " 0.9 0.2 0.1"));
  const Mesh colored = expect_box("a.off", off("COFF\n8 6 0\n", " 255 128 0 255")).mesh;
  EXPECT_NEAR(colored.colors.at(0).y, 128 / 255.0F, 1e-6);
  EXPECT_EQ(expect_box("a.off", off("COFF\n8 6 0\n", " 1 0.5 0")).mesh.colors.at(0), glm::vec3(1, 0.5F, 0));
  const Mesh mapped = expect_box("a.off", off("STCOFF\n8 6 0\n", " 0 1 0 1 0.25 0.75")).mesh;
  EXPECT_EQ(mapped.uvs.at(0), glm::vec2(0.25F, 0.75F));
}

TEST_F(TextMeshes, DamagedOffIsRefused) {
  EXPECT_EQ(refusal("a.off", "OFF BINARY\n8 6 0\n"), "binary OFF is not read; OFF as text is");
  EXPECT_EQ(refusal("a.off", off("4OFF\n8 6 0\n")),
            "points of four or n dimensions (4OFF, nOFF) are not read; OFF, COFF, NOFF and STOFF are, as text");
  EXPECT_EQ(refusal("a.off", off("OFF\n8 6 0\n", " 1 2 3")),
            "vertex 0 has more numbers than its keyword says in line 3");
  EXPECT_EQ(refusal("a.off", off("OFF\n8 6 0\n") + "4 0 1 3 2\n"),
            "something follows the 6 faces that its header promises in line 17");
  EXPECT_EQ(refusal("a.off", off("COFF\n8 6 0\n", " 300 0 0")),
            "its vertex colours are neither all in [0, 1] nor all whole numbers up to 255");
  EXPECT_EQ(refusal("a.off", off("OFF\n8 7 0\n")), "it ends at face 6 of 7");
}

// A face of a concave outline: an L, whose first corner does not see all others.
TEST_F(TextMeshes, ConcaveFacesKeepTheirOutline) {
  const std::string outlines[] = {"OFF\n6 1 0\n0 0 0\n2 0 0\n2 1 0\n1 1 0\n1 2 0\n0 2 0\n6 ",
                                  "OFF\n4 1 0\n0 0 0\n2 0 0\n0.5 0.5 0\n0 2 0\n4 "};
  const double areas[] = {3, 1};
  for (int shape = 0; shape < 2; ++shape) {
    const int n = shape == 0 ? 6 : 4;
    for (int first = 0; first < n; ++first) {
      std::string face = outlines[shape];
      for (int i = 0; i < n; ++i)
        face += std::to_string((first + i) % n) + " ";
      const Mesh mesh = load_mesh_file(write("l.off", face + "\n"), 60).mesh;
      double area = 0;
      for (const glm::uvec3& t : mesh.triangles) {
        const double doubled = glm::cross(glm::dvec3(mesh.positions[t.y] - mesh.positions[t.x]),
                                          glm::dvec3(mesh.positions[t.z] - mesh.positions[t.x]))
                                   .z;
        EXPECT_GE(doubled, 0);
        area += doubled / 2;
      }
      EXPECT_NEAR(area, areas[shape], 1e-6) << "from corner " << first;
    }
  }
}

const std::string kNormals = "vn -1 0 0\nvn 1 0 0\nvn 0 -1 0\nvn 0 1 0\nvn 0 0 -1\nvn 0 0 1\n";

TEST_F(TextMeshes, ObjInItsDialects) {
  expect_box("a.obj", obj("", {"{}"}));
  expect_box("a.obj", obj("", {"{}/"}));
  expect_box("a.obj", obj(kNormals, {"{0}//{1}"}));
  expect_box("a.obj", obj(kNormals, {"{0}//0"}));
  expect_box("a.obj", obj("vt 0 0\ng side\nusemtl red\ns 1\n", {"{}/1"}));
  const MeshFile mixed = expect_box("a.obj", obj(kNormals, {"{0}//{1}", "{}"}));
  EXPECT_EQ(mixed.warnings, std::vector<std::string>{"6 of its 12 triangles have no normals; they are made"});
  std::string relative = obj("", {"{}"});
  for (int i = 1; i <= 8; ++i) {
    for (auto at = relative.find(" " + std::to_string(i), relative.find("f ")); at != std::string::npos;
         at = relative.find(" " + std::to_string(i), at + 1))
      if (relative[at - 1] != 'v') relative.replace(at, 2, " " + std::to_string(i - 9));
  }
  expect_box("a.obj", relative);
  std::string joined = obj("", {"{}"});
  joined.replace(joined.find("f 1 2"), 5, "f 1 \\\n2");
  expect_box("a.obj", joined);
}

TEST_F(TextMeshes, NormalsWithoutADirectionAreMade) {
  EXPECT_EQ(expect_box("a.obj", obj("vn 0 0 0\n", {"{0}//1"})).warnings.size(), 1U);
  EXPECT_EQ(expect_box("a.obj", obj("vn nan 0 0\n", {"{0}//1"})).warnings.size(), 1U);
}

TEST_F(TextMeshes, DamagedObjIsRefused) {
  EXPECT_EQ(refusal("a.obj", obj("", {"{0}0"})), "a face names vertex 10 of 8 in line 9");
  EXPECT_EQ(refusal("a.obj", "v 0 0 0\nf 0 1 1\n"), "a face names vertex 0 of 1 in line 2");
  EXPECT_EQ(refusal("a.obj", "v 0 0\n"), "v needs 3 numbers in line 1");
  EXPECT_EQ(refusal("a.obj", "v 0 0 0\nf 1/1 1 1\n"), "a face names texture vertex 1 of 0 in line 2");
  EXPECT_EQ(refusal("a.obj", "surf 0 1 0 1 1 2\n"), "'surf': free-form geometry and calls are not read, in line 1");
  // The end of the file is the end of a line only where all of a face is there.
  const std::string box = obj("", {"{}"});
  expect_box("a.obj", box.substr(0, box.size() - 1));
  for (const char* cut : {"f", "f ", "f 1", "f 1 2", "f 1 2 "})
    EXPECT_EQ(refusal("a.obj", box + cut), "the file ends inside a face, in line 15") << cut;
  EXPECT_EQ(refusal("a.obj", obj("vt 0 0\n", {"{}/1"}) + "f 1/1 2/1 3/"), "the file ends inside a face, in line 16");
  EXPECT_EQ(expect_box("a.obj", box + "f 1 2\n").warnings,
            std::vector<std::string>{"1 face of fewer than three corners is left out"});
  EXPECT_EQ(refusal("a.obj", "hello\n"), "'hello' is no statement of OBJ in line 1");
}

// In 32 bits the box of a survey at 5.4e6 m becomes 1 x 0.6 x 0.5.
TEST_F(TextMeshes, FarCoordinatesAreShiftedBeforeTheyAreRounded) {
  std::string text;
  for (const glm::dvec3& p : test::kBoxCorners)
    text += fmt::format("v {:.6f} {:.6f} {:.6f}\n", p.x + 448262.331, p.y + 243.127, p.z + 5411932.678);
  for (const std::vector<int>& side : test::kBoxSides)
    text += fmt::format("f {} {} {} {}\n", side[0] + 1, side[1] + 1, side[2] + 1, side[3] + 1);
  MeshFile file = expect_box("utm.obj", text, 2e-6);
  EXPECT_GT(file.origin.z, 5.4e6);
  restore_origin(file);
  ASSERT_EQ(file.warnings.size(), 1U);
  EXPECT_NE(file.warnings[0].find("so far from the origin"), std::string::npos);
  MeshFile near = load_mesh_file(write("near.obj", obj("", {"{}"})), 60);
  EXPECT_EQ(near.origin, glm::dvec3(0));
  restore_origin(near);
  EXPECT_TRUE(near.warnings.empty());
}

}  // namespace
}  // namespace pellucid
