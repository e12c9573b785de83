#include "algorithms/scene/volumes/volume_file.hpp"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>
#include <vtkFloatArray.h>
#include <vtkImageData.h>
#include <vtkMetaImageWriter.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkXMLImageDataWriter.h>
#include <zlib.h>

#include "tests/algorithms/scene/folder_test.hpp"
#include "tests/algorithms/scene/stored_voxels.hpp"

namespace pellucid {
namespace {

const std::string kMeta =
    "ObjectType = Image\nNDims = 3\nDimSize = 4 3 2\nElementType = MET_FLOAT\nElementSpacing = 1 2 3\n"
    "ElementByteOrderMSB = False\n";
const std::string kNrrd =
    "NRRD0004\n# a comment\ntype: float\ndimension: 3\nsizes: 4 3 2\nspacings: 1 2 3\nendian: little\n";

/// 4 x 3 x 2 voxels at spacing 1, 2, 3, each its own index.
class VolumeFiles : public test::FolderTest {
 protected:
  static std::vector<float> indices() {
    std::vector<float> values(24);
    for (std::size_t i = 0; i < values.size(); ++i)
      values[i] = static_cast<float>(i);
    return values;
  }
  static std::string raw(const std::vector<float>& values) {
    std::string bytes(values.size() * sizeof(float), '\0');
    std::memcpy(bytes.data(), values.data(), bytes.size());
    return bytes;
  }
  static std::string raw() { return raw(indices()); }
  static std::string swapped(std::string bytes) {
    for (std::size_t i = 0; i < bytes.size(); i += 4)
      std::reverse(bytes.begin() + static_cast<long>(i), bytes.begin() + static_cast<long>(i) + 4);
    return bytes;
  }
  /// zlib's format, or gzip's.
  static std::string pack(std::string bytes, bool gzip) {
    std::string packed(bytes.size() + 100, '\0');
    z_stream stream{};
    EXPECT_EQ(deflateInit2(&stream, 9, Z_DEFLATED, gzip ? 15 + 16 : 15, 8, Z_DEFAULT_STRATEGY), Z_OK);
    stream.next_in = reinterpret_cast<Bytef*>(bytes.data());
    stream.avail_in = static_cast<uInt>(bytes.size());
    stream.next_out = reinterpret_cast<Bytef*>(packed.data());
    stream.avail_out = static_cast<uInt>(packed.size());
    EXPECT_EQ(deflate(&stream, Z_FINISH), Z_STREAM_END);
    packed.resize(stream.total_out);
    deflateEnd(&stream);
    return packed;
  }
  static std::string inr(const std::string& keys) {
    std::string header = "#INRIMAGE-4#{\n" + keys;
    header.resize(252, '\n');
    return header + "##}\n";
  }
  static std::string vti(const std::string& values, const std::string& extent = "0 3 0 2 0 1",
                         const std::string& array = "NumberOfComponents=\"1\" format=\"ascii\"") {
    return "<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\" version=\"0.1\" byte_order=\"LittleEndian\">\n"
           "<ImageData WholeExtent=\"" +
           extent + "\" Origin=\"0 0 0\" Spacing=\"1 2 3\">\n<Piece Extent=\"" + extent +
           "\">\n<PointData Scalars=\"d\">\n<DataArray type=\"Float32\" Name=\"d\" " + array + ">" + values +
           "</DataArray>\n</PointData></Piece>\n</ImageData>\n</VTKFile>\n";
  }
  void expect_indices(std::string_view name, const glm::dvec3& spacing = {1, 2, 3}) {
    SCOPED_TRACE(name);
    const VolumeFile volume = load_volume_file(file(name));
    EXPECT_EQ(volume.size, glm::ivec3(4, 3, 2));
    EXPECT_LT(glm::length(volume.spacing - spacing), 1e-6);
    const std::vector<float> expected = indices();
    EXPECT_EQ(test::values_of(volume), std::vector<double>(expected.begin(), expected.end()));
    EXPECT_EQ(volume.files.front(), file(name));
  }
  /// The message about the file, without its name.
  std::string error_of(std::string_view name, const std::string& content) {
    const std::filesystem::path path = write(name, content);
    testing::internal::CaptureStderr();
    const std::string message = test::message_of([&] { load_volume_file(path); });
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "") << "the library printed";
    const std::string begin = "cannot read volume '" + path.string() + "': ";
    EXPECT_TRUE(message.starts_with(begin)) << message;
    return message.substr(std::min(begin.size(), message.size()));
  }
};

TEST_F(VolumeFiles, NrrdRawPackedDetachedAndSwapped) {
  write("raw.nrrd", kNrrd + "encoding: raw\n\n" + raw());
  expect_indices("raw.nrrd");
  write("packed.nrrd", kNrrd + "encoding: gzip\n\n" + pack(raw(), true));
  expect_indices("packed.nrrd");
  write("lines.nrrd",
        "NRRD0001\r\ntype: float\r\ndimension: 3\r\nsizes: 4 3 2\r\nencoding: raw\r\nendian: big\r\n\r\n" +
            swapped(raw()));
  expect_indices("lines.nrrd", {1, 1, 1});
  write("turned.nrrd",
        "NRRD0004\ntype: float\ndimension: 3\nspace: left-posterior-superior\nsizes: 4 3 2\nspace directions: (0,1,0) "
        "(1.2,0,1.6) (0,0,-3)\nencoding: raw\nendian: little\n\n" +
            raw());
  expect_indices("turned.nrrd");
  write("voxels.raw", raw());
  write("detached.nhdr", kNrrd + "encoding: raw\ndata file: voxels.raw\n");
  expect_indices("detached.nhdr");
  EXPECT_EQ(load_volume_file(file("detached.nhdr")).files,
            (std::vector<std::filesystem::path>{file("detached.nhdr"), file("voxels.raw")}));
  write("bytes.nrrd", "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 1 1\nencoding: raw\n\n\x07\xff");
  EXPECT_EQ(test::values_of(load_volume_file(file("bytes.nrrd"))), (std::vector<double>{7, 255}));
  write("shorts.nrrd",
        "NRRD0004\ntype: short\ndimension: 3\nsizes: 2 1 1\nencoding: raw\nendian: little\n\n\xff\xff\x01\x02");
  EXPECT_EQ(test::values_of(load_volume_file(file("shorts.nrrd"))), (std::vector<double>{-1, 513}));
}

TEST_F(VolumeFiles, NrrdErrors) {
  const std::string end = "encoding: raw\n\n";
  const auto with = [](std::string text, std::string_view from, std::string_view to) {
    return text.replace(text.find(from), from.size(), to);
  };
  EXPECT_EQ(error_of("a.nrrd", "NOPE"), "it does not begin with 'NRRD'");
  EXPECT_EQ(error_of("a.nrrd", ""), "the file is empty");
  EXPECT_EQ(error_of("a.nrrd", kNrrd), "its header has no end");
  EXPECT_EQ(error_of("a.nrrd", kNrrd + end + raw().substr(8)), "88 bytes of voxels where its header promises 96");
  EXPECT_EQ(error_of("a.nrrd", kNrrd + end + raw() + "x"), "97 bytes of voxels where its header promises 96");
  EXPECT_EQ(error_of("a.nrrd", kNrrd + "encoding: gzip\n\n" + pack(raw(), true).substr(0, 30)),
            "its packed voxels end too soon");
  EXPECT_EQ(error_of("a.nrrd", kNrrd + "encoding: gzip\n\n" + raw()), "its packed voxels are damaged");
  EXPECT_EQ(error_of("a.nrrd", kNrrd + "encoding: gzip\n\n" + pack(raw() + raw(), true)),
            "192 bytes of voxels where its header promises 96");
  EXPECT_EQ(error_of("a.nrrd", kNrrd + "encoding: gzip\n\n" + pack(raw(), true) + "junk"),
            "something follows its packed voxels");
  EXPECT_EQ(error_of("a.nrrd", kNrrd + "encoding: bzip2\n\n00"),
            "its encoding is 'bzip2'; raw, gzip, ascii and hex are read");
  EXPECT_EQ(error_of("a.nrrd", with(kNrrd, "4 3 2", "4 3 0") + end), "4 x 3 x 0 voxels; every axis needs at least one");
  EXPECT_EQ(error_of("a.nrrd", with(kNrrd, "4 3 2", "4 -3 2") + end), "'-3' is no size for sizes in its header");
  EXPECT_EQ(error_of("a.nrrd", with(kNrrd, "4 3 2", "4 3") + end), "2 sizes where 3 are needed");
  EXPECT_EQ(error_of("a.nrrd", with(kNrrd, "4 3 2", "2049 3 2") + end),
            "2049 x 3 x 2 voxels; at most 2048 along an axis are read");
  EXPECT_EQ(error_of("a.nrrd", with(kNrrd, "4 3 2", "2048 2048 2048") + end),
            "2048 x 2048 x 2048 voxels; at most 2^30 are read");
  EXPECT_EQ(error_of("a.nrrd", with(kNrrd, "4 3 2", "1000 1000 1000") + end + "x"),
            "its header claims 1000 x 1000 x 1000 voxels, more than 1 bytes can hold");
  EXPECT_EQ(error_of("a.nrrd", with(kNrrd, "dimension: 3", "dimension: 4") + end),
            "its dimension is '4'; volumes have 3");
  EXPECT_EQ(error_of("a.nrrd", with(kNrrd, "1 2 3", "1 nan 3") + end),
            "a voxel spacing of nan along y; it must be above 0");
  EXPECT_EQ(error_of("a.nrrd", with(kNrrd, "1 2 3", "1 2 -3") + end),
            "a voxel spacing of -3 along z; it must be above 0");
  EXPECT_EQ(error_of("a.nrrd", with(kNrrd, "float", "block") + end), "voxels of type 'block' are not read");
  EXPECT_EQ(error_of("a.nrrd", with(kNrrd, "endian: little\n", "") + end + raw()),
            "its header does not tell the endian of its voxels");
  EXPECT_EQ(error_of("a.nrrd", kNrrd + "byte skip: 4\nencoding: gzip\n\n"),
            "a byte skip other than 0 is read of raw voxels only");
  EXPECT_EQ(error_of("a.nhdr", kNrrd + "data file: none.raw\n" + end),
            "its data file '" + file("none.raw").string() + "' is missing");
  EXPECT_EQ(error_of("a.nhdr", kNrrd + "data file: LIST\n" + end), "its voxels lie in several files; one is read");
}

TEST_F(VolumeFiles, MetaImageInOneFileOrTwoAndPacked) {
  write("voxels.raw", raw());
  write("two.mhd", kMeta + "ElementDataFile = voxels.raw\n");
  expect_indices("two.mhd");
  EXPECT_EQ(load_volume_file(file("two.mhd")).files.size(), 2U);
  write("one.mha", kMeta + "ElementDataFile = LOCAL\n" + raw());
  expect_indices("one.mha");
  write("packed.raw", pack(raw(), false));
  write("packed.mhd", kMeta + "CompressedData = True\nElementDataFile = packed.raw\n");
  expect_indices("packed.mhd");
  write("skips.raw", "1234" + raw());
  write("skips.mhd", kMeta + "HeaderSize = 4\nElementDataFile = skips.raw\n");
  expect_indices("skips.mhd");
}

TEST_F(VolumeFiles, MetaImageErrors) {
  write("short.raw", raw().substr(0, 50));
  EXPECT_EQ(error_of("a.mhd", kMeta + "ElementDataFile = short.raw\n"),
            "50 bytes of voxels where its header promises 96");
  EXPECT_EQ(error_of("a.mha", kMeta + "ElementDataFile = LOCAL\n" + raw() + "x"),
            "97 bytes of voxels where its header promises 96");
  write("packed.raw", pack(raw(), false).substr(0, 20));
  EXPECT_EQ(error_of("a.mhd", kMeta + "CompressedData = True\nElementDataFile = packed.raw\n"),
            "its packed voxels end too soon");
  EXPECT_EQ(error_of("a.mhd", kMeta + "ElementDataFile = none.raw\n"),
            "its data file '" + file("none.raw").string() + "' is missing");
  EXPECT_EQ(error_of("a.mhd", kMeta), "its header has no ElementDataFile");
  EXPECT_EQ(error_of("a.mhd", kMeta + "ElementDataFile = LIST\n"), "its voxels lie in several files; one is read");
  EXPECT_EQ(error_of("a.mha", kMeta + "ElementNumberOfChannels = 3\nElementDataFile = LOCAL\n" + raw()),
            "3 values a voxel; one is needed");
  std::string huge = kMeta + "ElementDataFile = short.raw\n";
  huge.replace(huge.find("4 3 2"), 5, "1000 1000 1000");
  EXPECT_EQ(error_of("a.mhd", huge), "its header claims 1000 x 1000 x 1000 voxels, more than 50 bytes can hold");
  EXPECT_NE(error_of("a.mhd", "NDims = x\nElementDataFile = short.raw\n"), "");
}

TEST_F(VolumeFiles, VtkImageDataAsTextAndAsVtkWritesIt) {
  write("text.vti", vti("0 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20 21 22 23"));
  expect_indices("text.vti");
  vtkNew<vtkImageData> image;
  image->SetDimensions(4, 3, 2);
  image->SetSpacing(1, 2, 3);
  image->AllocateScalars(VTK_SHORT, 1);
  auto* voxels = static_cast<short*>(image->GetScalarPointer());
  for (short i = 0; i < 24; ++i)
    voxels[i] = i;
  vtkNew<vtkFloatArray> other;
  other->SetName("other");
  other->SetNumberOfTuples(24);
  other->Fill(5);
  image->GetPointData()->AddArray(other);
  vtkNew<vtkXMLImageDataWriter> writer;
  writer->SetInputData(image);
  for (const char* name : {"ascii.vti", "binary.vti", "appended.vti"}) {
    writer->SetFileName(file(name).c_str());
    writer->SetDataMode(name[0] == 'b' ? vtkXMLWriter::Binary : vtkXMLWriter::Appended);
    if (name[1] == 's') writer->SetDataModeToAscii();
    ASSERT_EQ(writer->Write(), 1);
    expect_indices(name);
  }
  const std::string whole = content(file("appended.vti"));
  EXPECT_EQ(error_of("cut.vti", whole.substr(0, whole.size() * 3 / 4)), "it does not end in '</VTKFile>'");
  vtkNew<vtkMetaImageWriter> meta;
  meta->SetInputData(image);
  meta->SetFileName(file("vtk.mhd").c_str());
  meta->SetRAWFileName(file("vtk.raw").c_str());
  meta->Write();
  expect_indices("vtk.mhd");
}

TEST_F(VolumeFiles, VtkImageDataErrors) {
  EXPECT_EQ(error_of("a.vti", "hello"), "it does not end in '</VTKFile>'");
  EXPECT_EQ(error_of("a.vti", "hello</VTKFile>"), "it is malformed, or of another format than its name says");
  EXPECT_EQ(error_of("a.vti", vti("1 2 3")), "Error reading extent 0 3 0 2 0 1 from piece 0");
  EXPECT_EQ(error_of("a.vti", vti("1", "0 999 0 999 0 999")),
            "its header claims 1000 x 1000 x 1000 voxels, more than 355 bytes can hold");
  EXPECT_EQ(error_of("a.vti", vti("1 2", "0 0 0 0 0 0", "NumberOfComponents=\"2\" format=\"ascii\"")),
            "2 values a voxel; one is needed");
  // 96 bytes promised in base64, 66 there: VTK reads them without a word.
  std::string base64 = "YAAAAAAAAAAAAIA/AAAAQAAAQEAAAIBAAACgQAAAwEAAAOBAAAAAQQAAEEEAACBBAAAwQQAAQEEAAFBBAABgQQAA";
  EXPECT_TRUE(error_of("a.vti", vti(base64, "0 3 0 2 0 1", "format=\"binary\"")).starts_with("the value at voxel "));
  std::string cells = vti("1 2 3 4 5 6", "0 3 0 2 0 1");
  for (auto at = cells.find("PointData"); at != std::string::npos; at = cells.find("PointData"))
    cells.replace(at, 9, "CellData");
  EXPECT_EQ(load_volume_file(write("cells.vti", cells)).size, glm::ivec3(3, 2, 1)) << "between 4 x 3 x 2 points";
}

TEST_F(VolumeFiles, InrInEitherByteOrder) {
  const std::string shape = "XDIM=4\nYDIM=3\nZDIM=2\nVDIM=1\nVX=1.0\nVY=2.0\nVZ=3.0\n";
  write("little.inr", inr(shape + "TYPE=float\nPIXSIZE=32 bits\nCPU=decm\n") + raw());
  expect_indices("little.inr");
  write("big.inr", inr(shape + "TYPE=float\nPIXSIZE=32 bits\nCPU=sun\n") + swapped(raw()));
  expect_indices("big.inr");
  std::string bytes;
  for (char i = 0; i < 24; ++i)
    bytes += i;
  write("bytes.inr", inr(shape + "TYPE=unsigned fixed\nPIXSIZE=8 bits\nCPU=pc\n") + bytes);
  expect_indices("bytes.inr");
}

TEST_F(VolumeFiles, InrErrors) {
  const std::string shape = "XDIM=4\nYDIM=3\nZDIM=2\nVDIM=1\nTYPE=float\nPIXSIZE=32 bits\n";
  EXPECT_EQ(error_of("a.inr", "hello"), "it does not begin with '#INRIMAGE-4#{'");
  EXPECT_EQ(error_of("a.inr", "#INRIMAGE-4#{\nXDIM=4\n"), "its header has no end");
  EXPECT_EQ(error_of("a.inr", inr(shape + "CPU=decm\n") + raw().substr(4)),
            "92 bytes of voxels where its header promises 96");
  EXPECT_EQ(error_of("a.inr", inr(shape) + raw()), "CPU= is none of decm, alpha, pc, sun and sgi");
  EXPECT_EQ(error_of("a.inr", inr("YDIM=3\nZDIM=2\n")), "'' is no number for XDIM in its header");
  EXPECT_EQ(error_of("a.inr", inr("XDIM=4\nYDIM=3\nZDIM=2\nTYPE=packed\nPIXSIZE=32 bits\nCPU=pc\n") + raw()),
            "voxels of TYPE=packed and PIXSIZE=32 are not read");
  EXPECT_EQ(error_of("a.inr", inr("XDIM=4\nYDIM=3\nZDIM=2\nVDIM=3\nTYPE=float\nPIXSIZE=32 bits\nCPU=pc\n") + raw()),
            "3 values a voxel; one is needed");
  EXPECT_EQ(error_of("a.inr", inr(shape + "CPU=decm\nVZZ=2\n") + raw()), "'VZZ' in its header is no key of INRIMAGE-4");
  EXPECT_EQ(error_of("a.inr", inr(shape + "CPU=decm\nXDIM=4\n") + raw()), "its header states XDIM twice");
  EXPECT_EQ(error_of("a.inr", inr(shape + "CPU=decm\nSCALE=2**-8\n") + raw()),
            "SCALE=2**-8 is not applied; 2**0 is read");
}

TEST_F(VolumeFiles, ValuesThatAreNotFiniteAreFound) {
  std::vector<float> values = indices();
  values[4 * 3 + 4 + 2] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(error_of("a.nrrd", kNrrd + "encoding: raw\n\n" + raw(values)), "the value at voxel (2, 1, 1) is nan");
  values[3] = -std::numeric_limits<float>::infinity();
  EXPECT_EQ(error_of("a.mha", kMeta + "ElementDataFile = LOCAL\n" + raw(values)),
            "the value at voxel (3, 0, 0) is -inf");
  write("voxels.raw", raw(values));
  EXPECT_EQ(error_of("a.mhd", kMeta + "ElementDataFile = voxels.raw\n"), "the value at voxel (3, 0, 0) is -inf");
  EXPECT_EQ(
      error_of("a.inr", inr("XDIM=4\nYDIM=3\nZDIM=2\nVDIM=1\nTYPE=float\nPIXSIZE=32 bits\nCPU=decm\n") + raw(values)),
      "the value at voxel (3, 0, 0) is -inf");
  EXPECT_EQ(error_of("a.vti", vti("0 1 2 3 4 5 6 7 8 9 10 11 12 nan 14 15 16 17 18 19 20 21 22 23")),
            "the value at voxel (1, 0, 1) is nan");
}

// In every format, before anything is allocated: were it not, the test would not have the memory.
TEST_F(VolumeFiles, MoreVoxelsThanAreReadAreRefusedInEveryFormat) {
  const auto errors = [&](int x, int y, int z) {
    const std::string n[3] = {std::to_string(x), std::to_string(y), std::to_string(z)};
    const std::string sizes = n[0] + " " + n[1] + " " + n[2];
    std::string meta = kMeta + "ElementDataFile = LOCAL\n" + raw();
    meta.replace(meta.find("4 3 2"), 5, sizes);
    std::string nrrd = kNrrd + "encoding: raw\n\n" + raw();
    nrrd.replace(nrrd.find("4 3 2"), 5, sizes);
    const std::string extent =
        "0 " + std::to_string(x - 1) + " 0 " + std::to_string(y - 1) + " 0 " + std::to_string(z - 1);
    return std::vector<std::string>{error_of("a.mha", meta), error_of("a.nrrd", nrrd),
                                    error_of("a.vti", vti("1", extent)),
                                    error_of("a.inr", inr("XDIM=" + n[0] + "\nYDIM=" + n[1] + "\nZDIM=" + n[2] +
                                                          "\nTYPE=float\nPIXSIZE=32 bits\nCPU=decm\n") +
                                                          raw())};
  };
  for (const std::string& error : errors(1, 2049, 1))
    EXPECT_EQ(error, "1 x 2049 x 1 voxels; at most 2048 along an axis are read");
  for (const std::string& error : errors(2048, 2048, 257))
    EXPECT_EQ(error, "2048 x 2048 x 257 voxels; at most 2^30 are read");
  for (const std::string& error : errors(2147483647, 2147483647, 2147483647))
    EXPECT_EQ(error, "2147483647 x 2147483647 x 2147483647 voxels; at most 2048 along an axis are read");
}

TEST_F(VolumeFiles, OtherNamesAndMissingFiles) {
  EXPECT_EQ(error_of("a.dcm", "x"), "'.dcm' is none of .vti, .mhd, .mha, .nrrd, .nhdr and .inr");
  EXPECT_EQ(test::message_of([&] { load_volume_file(file("none.vti")); }),
            "cannot read volume '" + file("none.vti").string() + "': there is no such file");
}

TEST_F(VolumeFiles, ValuesAreNormalisedToARangeOrTheirOwn) {
  VolumeFile volume;
  volume.size = {4, 1, 1};
  test::store(volume, {-2, 0, 3, 8});
  const Densities own = normalise(volume, {});
  EXPECT_EQ(own.range, glm::dvec2(-2, 8));
  EXPECT_EQ(own.values, (std::vector<float>{0, 0.2F, 0.5F, 1}));
  const Densities ranged = normalise(volume, glm::dvec2(0, 4));
  EXPECT_EQ(ranged.range, glm::dvec2(0, 4));
  EXPECT_EQ(ranged.values, (std::vector<float>{0, 0, 0.75F, 1}));
  VolumeFile same;
  test::store(same, {3, 3});
  EXPECT_EQ(test::message_of([&] { normalise(same, {}); }),
            "its values are all 3; state what shall be 0 and 1: range = [low, high]");
}

}  // namespace
}  // namespace pellucid
