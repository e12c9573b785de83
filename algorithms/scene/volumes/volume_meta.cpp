#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "algorithms/parameters.hpp"
#include "algorithms/scene/volumes/volume_formats.hpp"

/// MetaImage (itk.org/Wiki/ITK/MetaIO/Documentation): lines "Key = value" up to ElementDataFile, which tells where the
/// voxels lie. Ours, because vtkMetaImageReader takes a spacing's magnitude, fills up missing voxels with zeros and
/// reads "0,25" as two numbers.
namespace pellucid {

namespace fs = std::filesystem;

namespace {

struct MetaText {
  std::map<std::string, std::string> values;
  std::uintmax_t bytes = 0;

  bool has(const std::string& key) const { return values.contains(key); }
  std::string text(const std::string& key, std::string otherwise = {}) const {
    const auto found = values.find(key);
    return found == values.end() ? otherwise : found->second;
  }
};

std::string trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return std::string(text.substr(first, text.find_last_not_of(" \t\r") + 1 - first));
}

/// A header may have keys of its writer's own; one that nearly is a key of the format's is a mistake that would matter.
void check_meta_key(const fs::path& path, const std::string& key, int line) {
  static const std::vector<std::string> kRead = {"ObjectType",
                                                 "NDims",
                                                 "DimSize",
                                                 "ElementSpacing",
                                                 "ElementSize",
                                                 "ElementType",
                                                 "ElementNumberOfChannels",
                                                 "ElementByteOrderMSB",
                                                 "BinaryDataByteOrderMSB",
                                                 "BinaryData",
                                                 "CompressedData",
                                                 "HeaderSize",
                                                 "HeaderSizePerSlice",
                                                 "ElementToIntensityFunctionSlope",
                                                 "ElementToIntensityFunctionOffset",
                                                 "ElementDataFile"};
  static const std::vector<std::string> kPassedOver = {"ObjectSubType",
                                                       "ObjectTypeName",
                                                       "ObjectSubTypeName",
                                                       "Comment",
                                                       "TransformType",
                                                       "Name",
                                                       "ID",
                                                       "ParentID",
                                                       "CompressedDataSize",
                                                       "CompressionLevel",
                                                       "Color",
                                                       "Position",
                                                       "Origin",
                                                       "Offset",
                                                       "Orientation",
                                                       "Rotation",
                                                       "TransformMatrix",
                                                       "CenterOfRotation",
                                                       "DistanceUnits",
                                                       "AnatomicalOrientation",
                                                       "Modality",
                                                       "SequenceID",
                                                       "ElementMin",
                                                       "ElementMax",
                                                       "ElementNBits",
                                                       "AcquisitionDate"};
  const auto has = [&](const std::vector<std::string>& keys) {
    return std::find(keys.begin(), keys.end(), key) != keys.end();
  };
  if (has(kRead) || has(kPassedOver)) return;
  if (const std::string near = nearest_name(key, kRead); !near.empty())
    fail_volume(path,
                fmt::format("'{}' in line {} of its header is no key of MetaImage; did you mean {}?", key, line, near));
}

MetaText read_text(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  MetaText text;
  std::string line;
  constexpr std::uintmax_t kLongestHeader = 1 << 20;
  for (int number = 1; text.bytes < kLongestHeader && std::getline(file, line); ++number) {
    text.bytes += line.size() + (file.eof() ? 0 : 1);
    const auto equals = line.find('=');
    if (equals == std::string::npos) {
      if (trimmed(line).empty()) continue;
      fail_volume(path, fmt::format("line {} of its header is no 'key = value'", number));
    }
    const std::string key = trimmed(std::string_view(line).substr(0, equals));
    check_meta_key(path, key, number);
    if (!text.values.emplace(key, trimmed(std::string_view(line).substr(equals + 1))).second)
      fail_volume(path, fmt::format("its header states {} twice", key));
    if (key == "ElementDataFile") return text;
  }
  fail_volume(path, "its header has no ElementDataFile");
}

bool flag(const fs::path& path, const MetaText& text, const std::string& key, bool otherwise) {
  if (!text.has(key)) return otherwise;
  const std::string value = text.text(key);
  if (value == "True" || value == "true" || value == "T" || value == "1") return true;
  if (value == "False" || value == "false" || value == "F" || value == "0") return false;
  fail_volume(path, fmt::format("{} = {} is neither True nor False", key, value));
}

std::vector<std::string> three(const fs::path& path, const MetaText& text, const std::string& key) {
  std::istringstream stream(text.text(key));
  std::vector<std::string> all{std::istream_iterator<std::string>(stream), {}};
  if (all.size() != 3) fail_volume(path, fmt::format("{} has {} values; 3 are needed", key, all.size()));
  return all;
}

VolumeHeader shape_of(const fs::path& path, const MetaText& text) {
  VolumeHeader header;
  if (const std::string type = text.text("ObjectType", "Image"); type != "Image")
    fail_volume(path, fmt::format("its ObjectType is {}; Image is read", type));
  if (const std::string dimensions = text.text("NDims"); dimensions != "3")
    fail_volume(path, fmt::format("its NDims is '{}'; volumes have 3", dimensions));
  const auto sizes = three(path, text, "DimSize");
  // ElementSize is a voxel's extent, which the format takes for the spacing where that is not stated.
  const std::string spacing = text.has("ElementSpacing") ? "ElementSpacing" : "ElementSize";
  const auto spacings = text.has(spacing) ? three(path, text, spacing) : std::vector<std::string>(3, "1");
  for (int c = 0; c < 3; ++c) {
    header.size[c] = header_size(path, "DimSize", sizes[static_cast<std::size_t>(c)]);
    header.spacing[c] = header_number(path, spacing, spacings[static_cast<std::size_t>(c)]);
  }
  header.components = header_size(path, "ElementNumberOfChannels", text.text("ElementNumberOfChannels", "1"));
  return header;
}

VoxelType type_of(const fs::path& path, const std::string& name) {
  // MET_LONG has 4 bytes on every machine.
  static constexpr std::pair<std::string_view, std::pair<VoxelKind, int>> kTypes[] = {
      {"MET_CHAR", {VoxelKind::signed_integer, 8}},       {"MET_UCHAR", {VoxelKind::unsigned_integer, 8}},
      {"MET_SHORT", {VoxelKind::signed_integer, 16}},     {"MET_USHORT", {VoxelKind::unsigned_integer, 16}},
      {"MET_INT", {VoxelKind::signed_integer, 32}},       {"MET_UINT", {VoxelKind::unsigned_integer, 32}},
      {"MET_LONG", {VoxelKind::signed_integer, 32}},      {"MET_ULONG", {VoxelKind::unsigned_integer, 32}},
      {"MET_LONG_LONG", {VoxelKind::signed_integer, 64}}, {"MET_ULONG_LONG", {VoxelKind::unsigned_integer, 64}},
      {"MET_FLOAT", {VoxelKind::floating, 32}},           {"MET_DOUBLE", {VoxelKind::floating, 64}},
  };
  for (const auto& [known, type] : kTypes)
    if (known == name) return voxel_type(type.first, type.second);
  fail_volume(path, fmt::format("voxels of ElementType '{}' are not read", name));
}

}  // namespace

VolumeFile load_meta_image(const fs::path& path) {
  const MetaText text = read_text(path);
  const VolumeHeader header = shape_of(path, text);
  VoxelBytes place;
  place.type = type_of(path, text.text("ElementType"));
  const bool msb = flag(path, text, "ElementByteOrderMSB", flag(path, text, "BinaryDataByteOrderMSB", false));
  place.swapped = msb != (std::endian::native == std::endian::big);
  const bool packed = flag(path, text, "CompressedData", false);
  const bool binary = flag(path, text, "BinaryData", true);
  if (packed && !binary) fail_volume(path, "its header says that its voxels are packed and text");
  place.coding = packed ? VoxelCoding::packed : binary ? VoxelCoding::raw : VoxelCoding::numbers;
  for (const auto& [key, neutral] :
       {std::pair("ElementToIntensityFunctionSlope", 1.0), std::pair("ElementToIntensityFunctionOffset", 0.0),
        std::pair("HeaderSizePerSlice", 0.0)}) {
    if (text.has(key) && header_number(path, key, text.text(key)) != neutral)
      fail_volume(path, fmt::format("{} = {} is not applied; {} is read", key, text.text(key), neutral));
  }
  const std::string name = text.text("ElementDataFile");
  const bool local = name == "LOCAL" || name == "Local" || name == "local";
  place.file = local ? path : data_file(path, name);
  place.offset = local ? text.bytes : 0;
  if (const std::string skip = text.text("HeaderSize", "0"); skip == "-1") {
    place.from_end = true;
  } else if (const int bytes = header_size(path, "HeaderSize", skip); !local || bytes > 0) {
    if (local && static_cast<std::size_t>(bytes) < text.bytes)
      fail_volume(path, fmt::format("HeaderSize = {} lies within its header of {} bytes", bytes, text.bytes));
    place.offset = static_cast<std::uintmax_t>(bytes);
    place.may_follow = text.has("HeaderSize");
  }
  return read_voxels(path, header, place);
}

}  // namespace pellucid
