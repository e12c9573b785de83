#include <algorithm>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include "algorithms/scene/volumes/volume_file.hpp"
#include "tests/algorithms/scene/folder_test.hpp"
#include "tests/algorithms/scene/stored_voxels.hpp"

/// Other programs write these: spacings in words of their own, several gzip members, names in capitals, large numbers.
namespace pellucid {
namespace {

class VolumeDialects : public test::FolderTest {
 protected:
  static std::string shorts() {
    std::string bytes;
    for (std::int16_t i = 0; i < 24; ++i)
      bytes.append(reinterpret_cast<const char*>(&i), 2);
    return bytes;
  }
  static std::string nrrd(const std::string& fields) {
    return "NRRD0004\n# by hand\ntype: short\ndimension: 3\nsizes: 4 3 2\nendian: little\n" + fields +
           "encoding: raw\n\n" + shorts();
  }
  static std::string meta(const std::string& fields) {
    return "ObjectType = Image\nNDims = 3\nDimSize = 4 3 2\nElementType = MET_SHORT\n" + fields +
           "ElementDataFile = LOCAL\n" + shorts();
  }
  void expect_spacing(std::string_view name, const std::string& content, const glm::dvec3& spacing) {
    SCOPED_TRACE(content.substr(0, 300));
    const VolumeFile volume = load_volume_file(write(name, content));
    EXPECT_EQ(volume.size, glm::ivec3(4, 3, 2));
    EXPECT_LT(glm::length(volume.spacing - spacing), 1e-9);
    EXPECT_EQ(volume.voxels[23], 23);
    EXPECT_EQ(volume.value_range, glm::dvec2(0, 23));
  }
  std::string error_of(std::string_view name, const std::string& content) {
    const auto path = write(name, content);
    const std::string message = test::message_of([&] { load_volume_file(path); });
    const std::string begin = "cannot read volume '" + path.string() + "': ";
    EXPECT_TRUE(message.starts_with(begin)) << message;
    return message.substr(std::min(begin.size(), message.size()));
  }
};

const glm::dvec3 kSpacing(0.25, 0.5, 1);

TEST_F(VolumeDialects, NrrdSpacings) {
  for (const char* fields :
       {"spacings: 0.25 0.5 1\n", "spacings:0.25 0.5 1\n", "spacings: +0.25 +5.0e-1 1.\n", "Spacings: 0.25 0.5 1\n",
        "space: left-posterior-superior\nspace directions: (0.25, 0, 0) (0, 0.5, 0) (0, 0, 1)\n",
        "space dimension: 3\nspace directions: ( 0.25,0,0 ) ( 0,0.5,0 ) ( 0,0,1 )\n",
        "space: LPS\nspace directions: (0.2,0.15,0) (-0.3,0.4,0) (0,0,-1)\nspace origin: (-100,50,-400.5)\n",
        "space directions: (0.25,0,0)(0,0.5,0)(0,0,1)\n",
        "axis mins: 0 0 0\naxis maxs: 1 1.5 2\ncenters: cell cell cell\n",
        "axis mins: 1 -1 0\naxis maxs: 1.75 0 1\ncenterings: node node node\n",
        "spacings: 0.25 0.5 1\naxis mins: 5 6 7\n",
        "spacings: 0.25 0.5 1\nkinds: domain domain domain\nunits: \"mm\" \"mm\" \"mm\"\nmy key:=0\n"})
    expect_spacing("a.nrrd", nrrd(fields), kSpacing);
  expect_spacing("A.NRRD", nrrd(""), glm::dvec3(1));
}

TEST_F(VolumeDialects, NrrdFieldsThatMatterAreNeverPassedOver) {
  EXPECT_EQ(error_of("a.nrrd", nrrd("spacing: 1 1 2\n")), "'spacing' in line 7 of its header is no field of NRRD");
  EXPECT_EQ(error_of("a.nrrd", nrrd("spacings 1 1 2\n")), "line 7 of its header is no 'field: value'");
  EXPECT_EQ(error_of("a.nrrd", nrrd("spacings: 1 1 2\nspacings: 1 1 3\n")), "its header states 'spacings' twice");
  EXPECT_EQ(error_of("a.nrrd", nrrd("spacings: 1 1 -2\n")), "a voxel spacing of -2 along z; it must be above 0");
  EXPECT_EQ(error_of("a.nrrd", nrrd("axis mins: 0 0 0\naxis maxs: 3 4 6\n")),
            "axis mins and axis maxs tell the spacing only with centers, which its header does not state");
  EXPECT_EQ(error_of("a.nrrd", nrrd("spacings: 1 1 1\naxis mins: 0 0 0\naxis maxs: 8 3 2\ncenters: cell cell cell\n")),
            "its spacings say 1 along x, its axis mins and maxs 2");
  EXPECT_EQ(error_of("a.nrrd", nrrd("spacings: 1 1 1\nspace directions: (1,0,0) (0,2,0) (0,0,1)\n")),
            "its spacings say 1 along y, its space directions 2");
  EXPECT_EQ(error_of("a.nrrd", nrrd("kinds: RGB-color domain domain\n")),
            "an axis of kind 'rgb-color' is none of space");
  EXPECT_EQ(error_of("a.nrrd", nrrd("space directions: none (0,1,0) (0,0,1)\n")),
            "'none (0,1,0) (0,0,1)' is no vector of space directions");
  std::string without = nrrd("");
  without.erase(without.find("dimension: 3\n"), 13);
  EXPECT_EQ(error_of("a.nrrd", without), "its header states no dimension");
}

std::string with_text(std::string file, const std::string& bytes, const std::string& text) {
  return file.replace(file.size() - bytes.size(), bytes.size(), text);
}

TEST_F(VolumeDialects, VoxelsAsText) {
  std::string numbers, digits;
  for (int i = 0; i < 24; ++i) {
    numbers += fmt::format("{}{}{}", i == 3 ? "+" : "", i, i % 4 == 3 ? "\r\n" : i == 5 ? ", " : "\t");
    digits += fmt::format("{:02x}00{}", i, i % 6 == 5 ? "\n" : "");
  }
  const std::string spacings = "spacings: 0.25 0.5 1\n";
  const auto nrrd_of = [&](const std::string& encoding, const std::string& text) {
    std::string file = with_text(nrrd(spacings), shorts(), text);
    return file.replace(file.find("encoding: raw"), 13, "encoding: " + encoding);
  };
  for (const char* encoding : {"ascii", "text", "TXT"})
    expect_spacing("a.nrrd", nrrd_of(encoding, numbers), kSpacing);
  std::string without = nrrd_of("ascii", numbers);
  expect_spacing("a.nrrd", without.erase(without.find("endian"), 15), kSpacing);  // text has none
  expect_spacing("a.nrrd", nrrd_of("hex", digits), kSpacing);
  write("v.txt", "two lines\nof text\n" + numbers);
  std::string detached = nrrd_of("ascii", "");
  detached.replace(detached.find("encoding"), 0, "line skip: 2\ndata file: v.txt\n");
  expect_spacing("a.nhdr", detached, kSpacing);
  const std::string meta_text = "BinaryData = False\nElementSpacing = 0.25 0.5 1\n";
  expect_spacing("a.mha", with_text(meta(meta_text), shorts(), numbers), kSpacing);

  EXPECT_EQ(error_of("a.nrrd", nrrd_of("ascii", numbers + "24")), "more than the 24 voxels that its header promises");
  EXPECT_EQ(error_of("a.nrrd", nrrd_of("ascii", numbers.substr(0, numbers.size() - 4))),
            "23 voxels where its header promises 24");
  EXPECT_EQ(error_of("a.nrrd", nrrd_of("ascii", "1 2 3")), "5 bytes of text hold no 24 voxels");
  for (const char* wrong : {"0,5", "32768", "0.5", "x", "nan", "1e999", "--1"})
    EXPECT_EQ(error_of("a.nrrd", nrrd_of("ascii", wrong + (" " + numbers))),
              fmt::format("voxel 0 is '{}', no number of its type", wrong));
  EXPECT_EQ(error_of("a.nrrd", nrrd_of("hex", digits + "00")), "more than the 48 bytes that its header promises");
  EXPECT_EQ(error_of("a.nrrd", nrrd_of("hex", "0g" + digits.substr(2))),
            "byte 0x67 among its voxels is no hexadecimal digit");
  EXPECT_EQ(error_of("a.nrrd", nrrd_of("hex", digits.substr(0, 50))), "50 digits hold no 48 bytes");
  EXPECT_EQ(error_of("a.mha", with_text(meta(meta_text + "CompressedData = True\n"), shorts(), numbers)),
            "its header says that its voxels are packed and text");
}

TEST_F(VolumeDialects, NrrdSkips) {
  const auto skipping = [&](const std::string& fields, const std::string& before, const std::string& behind = "") {
    return with_text(nrrd("spacings: 0.25 0.5 1\n" + fields), shorts(), before + shorts() + behind);
  };
  expect_spacing("a.nrrd", skipping("byte skip: 3\n", "abc"), kSpacing);
  expect_spacing("a.nrrd", skipping("byte skip: -1\n", "whatever"), kSpacing);
  expect_spacing("a.nrrd", skipping("line skip: 2\nbyte skip: 1\n", "a\n\nb"), kSpacing);
  EXPECT_EQ(error_of("a.nrrd", skipping("byte skip: 3\n", "ab")), "47 bytes of voxels where its header promises 48");
  EXPECT_EQ(error_of("a.nrrd", skipping("byte skip: -2\n", "ab")), "'-2' is no size for byte skip in its header");
  EXPECT_EQ(error_of("a.nrrd", skipping("line skip: 900\n", "a\n")),
            "its file ends before the lines that are to be skipped");
}

TEST_F(VolumeDialects, SeveralGzipMembersAreOneStream) {
  const auto member = [](const std::string& bytes) {
    std::string packed(bytes.size() + 100, '\0');
    z_stream stream{};
    EXPECT_EQ(deflateInit2(&stream, 9, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY), Z_OK);
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
    stream.avail_in = static_cast<uInt>(bytes.size());
    stream.next_out = reinterpret_cast<Bytef*>(packed.data());
    stream.avail_out = static_cast<uInt>(packed.size());
    EXPECT_EQ(deflate(&stream, Z_FINISH), Z_STREAM_END);
    packed.resize(stream.total_out);
    deflateEnd(&stream);
    return packed;
  };
  const std::string head =
      "NRRD0004\ntype: short\ndimension: 3\nsizes: 4 3 2\nspacings: 0.25 0.5 1\nendian: little\nencoding: GZip\n\n";
  const std::string first = member(shorts().substr(0, 20)), rest = member(shorts().substr(20));
  expect_spacing("a.nrrd", head + first + rest, kSpacing);
  expect_spacing("a.nrrd", head + first + rest + std::string(512, '\0'), kSpacing);
  EXPECT_EQ(error_of("a.nrrd", head + first), "20 bytes of voxels where its header promises 48");
  EXPECT_EQ(error_of("a.nrrd", head + first + rest + rest), "76 bytes of voxels where its header promises 48");
}

TEST_F(VolumeDialects, MetaImages) {
  expect_spacing("a.mha", meta("ElementSpacing = 0.25 0.5 1\n"), kSpacing);
  expect_spacing("a.mha", meta("ElementSize = 0.25 0.5 1\n"), kSpacing);
  expect_spacing("a.mha", meta(""), glm::dvec3(1));
  expect_spacing("A.MHA", meta("ElementSpacing = 0.25 0.5 1\nComment = " + std::string(100'000, 'x') + "\n"), kSpacing);
  write("slice%03d.raw", "head" + shorts());
  std::string detached = meta("HeaderSize = -1\nElementSpacing = 0.25 0.5 1\n");
  detached.resize(detached.find("LOCAL"));
  expect_spacing("a.mhd", detached + "slice%03d.raw\n", kSpacing);
  EXPECT_EQ(error_of("a.mhd", detached + "other%03d.raw 1 2 1\n"), "its voxels lie in several files; one is read");

  // Where the voxels are in the header's own file, HeaderSize counts from that file's start.
  const std::string local = meta("HeaderSize = 200\nElementSpacing = 0.25 0.5 1\n");
  const std::string head = local.substr(0, local.find("LOCAL\n") + 6);
  expect_spacing("a.mha", head + std::string(200 - head.size(), ' ') + shorts(), kSpacing);
  EXPECT_EQ(
      error_of("a.mha", meta("HeaderSize = 20\n")),
      fmt::format("HeaderSize = 20 lies within its header of {} bytes", meta("HeaderSize = 20\n").find("LOCAL\n") + 6));
  EXPECT_EQ(error_of("a.mha", meta("HeaderSize = 9999\n")), "0 bytes of voxels where its header promises 48");

  EXPECT_EQ(error_of("a.mha", meta("ElementSpacing = 0.25 0.5 -1\n")),
            "a voxel spacing of -1 along z; it must be above 0");
  EXPECT_EQ(error_of("a.mha", meta("ElementSpacing = 0.25 0.5 0\n")),
            "a voxel spacing of 0 along z; it must be above 0");
  EXPECT_EQ(error_of("a.mha", meta("ElementSpacing = 0,25 0,5 1\n")),
            "'0,25' is no number for ElementSpacing in its header");
  EXPECT_EQ(error_of("a.mha", meta("ElementSpacing = 0.25 0.5\n")), "ElementSpacing has 2 values; 3 are needed");
  EXPECT_EQ(error_of("a.mha", meta("ElementByteOrderMSB = maybe\n")),
            "ElementByteOrderMSB = maybe is neither True nor False");
  EXPECT_EQ(error_of("a.mha", meta("ElementToIntensityFunctionSlope = 2\n")),
            "ElementToIntensityFunctionSlope = 2 is not applied; 1 is read");
  EXPECT_EQ(error_of("a.mha", meta("ElementSpacng = 1 1 2\n")),
            "'ElementSpacng' in line 5 of its header is no key of MetaImage; did you mean ElementSpacing?");
  EXPECT_EQ(error_of("a.mha", meta("elementspacing = 1 1 2\n")),
            "'elementspacing' in line 5 of its header is no key of MetaImage; did you mean ElementSpacing?");
  EXPECT_EQ(error_of("a.mha", meta("ElementSpacing: 1 1 2\n")), "line 5 of its header is no 'key = value'");
  expect_spacing("a.mha", meta("ElementSpacing = 0.25 0.5 1\n\nScanner = ours\nOffset = 1 2 3\n"), kSpacing);
  std::string half = meta("");
  half.replace(half.find("MET_SHORT"), 9, "MET_HALF");
  EXPECT_EQ(error_of("a.mha", half), "voxels of ElementType 'MET_HALF' are not read");
}

std::string vti(const std::string& attributes, const std::string& extent = "0 3 0 2 0 1", const std::string& end = "") {
  return "<VTKFile type=\"ImageData\" version=\"0.1\" byte_order=\"LittleEndian\">\n<ImageData WholeExtent=\"" +
         extent + "\" Origin=\"1e6 0 0\" Spacing=\"0.25 0.5 1\">\n<Piece Extent=\"" + extent + "\">\n" + attributes +
         "</Piece>\n</ImageData>\n</VTKFile>" + end;
}
std::string array(const std::string& name, int count = 24) {
  std::string text = "<DataArray type=\"Int16\" Name=\"" + name + "\" format=\"ascii\">";
  for (int i = 0; i < count; ++i)
    text += std::to_string(i) + " ";
  return text + "</DataArray>\n";
}

TEST_F(VolumeDialects, VtkImageData) {
  expect_spacing("a.vti", vti("<PointData>\n" + array("only") + "</PointData>\n"), kSpacing);
  expect_spacing("A.VTI", vti("<PointData>\n" + array("only") + "</PointData>\n", "-2 1 5 7 10 11", "\n \r\n\n"),
                 kSpacing);
  expect_spacing("a.vti",
                 vti("<PointData Scalars=\"b\">\n" + array("a") + array("b") + "</PointData>\n<CellData>\n" +
                     array("c", 6) + "</CellData>\n"),
                 kSpacing);
  expect_spacing("a.vti", vti("<CellData>\n" + array("cells") + "</CellData>\n", "0 4 0 3 0 2"), kSpacing);
  EXPECT_EQ(error_of("a.vti", vti("<PointData>\n" + array("a") + array("b") + "</PointData>\n")),
            "it has 2 arrays of point data, 'a', 'b', and none of them is the active scalars; one is needed");
  EXPECT_EQ(error_of("a.vti", vti("")), "it has neither point data nor cell data");
  EXPECT_EQ(error_of("a.vti", vti("<PointData>\n" + array("a") + "</PointData>\n", "0 3 0 2 0 1", "junk")),
            "it does not end in '</VTKFile>'");
}

// Numbers that 32-bit floats cannot tell apart.
TEST_F(VolumeDialects, ValuesAreMappedBeforeTheyAreRounded) {
  const auto densities = [&](const std::string& type, const auto& values) {
    std::string bytes;
    for (const auto value : values)
      bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
    const auto path = write("v.nrrd", "NRRD0004\ntype: " + type +
                                          "\ndimension: 3\nsizes: 4 1 1\nendian: little\nencoding: raw\n\n" + bytes);
    return normalise(load_volume_file(path), {});
  };
  const Densities counts = densities("uint", std::vector<std::uint32_t>{16777216, 16777217, 16777218, 16777219});
  EXPECT_EQ(counts.range, glm::dvec2(16777216, 16777219));
  EXPECT_EQ(counts.values, (std::vector<float>{0, 1 / 3.0F, 2 / 3.0F, 1}));
  const Densities offset = densities("double", std::vector<double>{1e6, 1e6 + 0.01, 1e6 + 0.02, 1e6 + 0.03});
  EXPECT_NEAR(offset.values[1], 1 / 3.0F, 1e-6);
  EXPECT_NEAR(offset.values[2], 2 / 3.0F, 1e-6);
  const Densities large = densities("double", std::vector<double>{-1.5e308, 0, 1e39, 1.5e308});
  EXPECT_EQ(large.values, (std::vector<float>{0, 0.5F, 0.5F, 1}));
  const Densities tiny = densities("double", std::vector<double>{0, 1e-310, 2e-310, 4e-310});
  EXPECT_NEAR(tiny.values[2], 0.5F, 1e-6);
  const Densities longs = densities("int64", std::vector<std::int64_t>{-4, -2, 0, 4});
  EXPECT_EQ(longs.values, (std::vector<float>{0, 0.25F, 0.5F, 1}));
}

}  // namespace
}  // namespace pellucid
