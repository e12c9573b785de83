#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <ios>
#include <iterator>
#include <limits>
#include <map>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "algorithms/scene/volumes/volume_formats.hpp"

/// NRRD (teem.sourceforge.net/nrrd/format.html): lines "field: value" up to an empty one, then the voxels or, detached,
/// their file. Ours, because vtkNrrdReader of VTK 9.1 takes a first axis of up to nine voxels for components and reads
/// only one slice of a packed file. A field that the format does not know is an error: it may be one that matters.
namespace pellucid {

namespace fs = std::filesystem;

namespace {

/// Every field of the format, without blanks ("data file" and "datafile" are the same) and in lower case.
constexpr std::array kFields = {"dimension",
                                "type",
                                "blocksize",
                                "encoding",
                                "endian",
                                "content",
                                "min",
                                "max",
                                "oldmin",
                                "oldmax",
                                "datafile",
                                "lineskip",
                                "byteskip",
                                "number",
                                "sampleunits",
                                "sizes",
                                "spacings",
                                "thicknesses",
                                "axismins",
                                "axismaxs",
                                "centers",
                                "centerings",
                                "labels",
                                "units",
                                "kinds",
                                "space",
                                "spacedimension",
                                "spaceunits",
                                "spaceorigin",
                                "spacedirections",
                                "measurementframe"};

struct NrrdHeader {
  std::map<std::string, std::string> fields;
  std::uintmax_t bytes = 0;  ///< up to the voxels

  bool has(const std::string& field) const { return fields.contains(field); }
  std::string text(const std::string& field, std::string otherwise = {}) const {
    const auto found = fields.find(field);
    return found == fields.end() ? otherwise : found->second;
  }
};

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

void read_field(const fs::path& path, const std::string& line, int number, NrrdHeader& header) {
  if (line.starts_with('#')) return;
  const auto colon = line.find(':');
  if (colon == std::string::npos) fail_volume(path, fmt::format("line {} of its header is no 'field: value'", number));
  if (line.compare(colon, 2, ":=") == 0) return;  // key and value of the user's
  const std::string shown = line.substr(0, colon);
  std::string field = lower(shown);
  std::erase(field, ' ');
  if (std::find(kFields.begin(), kFields.end(), field) == kFields.end())
    fail_volume(path, fmt::format("'{}' in line {} of its header is no field of NRRD", shown, number));
  const auto begin = line.find_first_not_of(" \t", colon + 1);
  const std::string value =
      begin == std::string::npos ? "" : line.substr(begin, line.find_last_not_of(" \t") + 1 - begin);
  if (!header.fields.emplace(field, value).second)
    fail_volume(path, fmt::format("its header states '{}' twice", shown));
}

NrrdHeader read_nrrd_header(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  NrrdHeader header;
  std::string line;
  constexpr std::uintmax_t kLongestHeader = 1 << 20;
  for (int number = 1; header.bytes < kLongestHeader && std::getline(file, line); ++number) {
    header.bytes += line.size() + (file.eof() ? 0 : 1);
    if (line.ends_with('\r')) line.pop_back();
    if (number == 1) {
      if (!line.starts_with("NRRD")) fail_volume(path, "it does not begin with 'NRRD'");
      continue;
    }
    if (line.empty()) return header;
    read_field(path, line, number, header);
  }
  if (!header.has("datafile")) fail_volume(path, "its header has no end");
  return header;
}

std::vector<std::string> words(const std::string& text) {
  std::istringstream stream(text);
  return {std::istream_iterator<std::string>(stream), {}};
}

std::vector<std::string> three(const fs::path& path, const NrrdHeader& text, const std::string& field,
                               std::string_view shown) {
  std::vector<std::string> all = words(text.text(field));
  if (all.size() != 3) fail_volume(path, fmt::format("{} {} where 3 are needed", all.size(), shown));
  return all;
}

glm::dvec3 three_numbers(const fs::path& path, const NrrdHeader& text, const std::string& field,
                         std::string_view shown) {
  const std::vector<std::string> all = three(path, text, field, shown);
  return {header_number(path, shown, all[0]), header_number(path, shown, all[1]), header_number(path, shown, all[2])};
}

/// "(a, b, c)" three times; the distance between voxels is the vector's length.
glm::dvec3 lengths_of_directions(const fs::path& path, const std::string& text) {
  std::vector<double> lengths;
  std::size_t at = 0;
  while ((at = text.find_first_not_of(" \t", at)) != std::string::npos) {
    const std::size_t end = text.find(')', at);
    if (text[at] != '(' || end == std::string::npos)
      fail_volume(path, fmt::format("'{}' is no vector of space directions", text.substr(at)));
    std::istringstream numbers(text.substr(at + 1, end - at - 1));
    double square = 0;
    for (std::string number; std::getline(numbers, number, ',');) {
      const std::vector<std::string> word = words(number);
      const double v = header_number(path, "space directions", word.size() == 1 ? word[0] : number);
      square += v * v;
    }
    lengths.push_back(std::sqrt(square));
    at = end + 1;
  }
  if (lengths.size() != 3) fail_volume(path, fmt::format("{} space directions where 3 are needed", lengths.size()));
  return {lengths[0], lengths[1], lengths[2]};
}

/// The spacing that the ends of the axes imply; what that is depends on whether they lie in or between voxels.
std::optional<glm::dvec3> spacing_of_ends(const fs::path& path, const NrrdHeader& text, const glm::ivec3& size) {
  if (!text.has("axismins") || !text.has("axismaxs")) return std::nullopt;
  const std::string field = text.has("centers") ? "centers" : "centerings";
  if (!text.has(field))
    fail_volume(path, "axis mins and axis maxs tell the spacing only with centers, which its header does not state");
  const std::vector<std::string> centers = three(path, text, field, "centers");
  const glm::dvec3 low = three_numbers(path, text, "axismins", "axis mins");
  const glm::dvec3 high = three_numbers(path, text, "axismaxs", "axis maxs");
  glm::dvec3 spacing(1.0);
  for (int c = 0; c < 3; ++c) {
    const std::string center = lower(centers[static_cast<std::size_t>(c)]);
    if (center != "cell" && center != "node")
      fail_volume(path,
                  fmt::format("'{}' of its centers is neither cell nor node", centers[static_cast<std::size_t>(c)]));
    spacing[c] = (high[c] - low[c]) / std::max(center == "cell" ? size[c] : size[c] - 1, 1);
  }
  return spacing;
}

void check_agreement(const fs::path& path, const glm::dvec3& stated, const glm::dvec3& implied, std::string_view of,
                     std::string_view other) {
  for (int c = 0; c < 3; ++c) {
    if (std::abs(stated[c] - implied[c]) <= 1e-3 * std::abs(stated[c])) continue;
    fail_volume(path, fmt::format("its {} say {} along {}, its {} {}", of, stated[c], "xyz"[c], other, implied[c]));
  }
}

glm::dvec3 spacing_of(const fs::path& path, const NrrdHeader& text, const glm::ivec3& size) {
  std::optional<glm::dvec3> spacings, directions;
  if (text.has("spacings")) spacings = three_numbers(path, text, "spacings", "spacings");
  if (text.has("spacedirections")) directions = lengths_of_directions(path, text.text("spacedirections"));
  if (spacings && directions) check_agreement(path, *spacings, *directions, "spacings", "space directions");
  const std::optional<glm::dvec3> stated = spacings ? spacings : directions;
  const std::optional<glm::dvec3> ends = spacing_of_ends(path, text, size);
  if (stated && ends) check_agreement(path, *stated, *ends, "spacings", "axis mins and maxs");
  return stated ? *stated : ends.value_or(glm::dvec3(1.0));
}

VolumeHeader shape_of(const fs::path& path, const NrrdHeader& text) {
  VolumeHeader header;
  if (!text.has("dimension")) fail_volume(path, "its header states no dimension");
  if (const std::string dimension = text.text("dimension"); dimension != "3") {
    fail_volume(path, fmt::format("its dimension is '{}'; volumes have 3", dimension));
  }
  const auto sizes = three(path, text, "sizes", "sizes");
  for (int c = 0; c < 3; ++c)
    header.size[c] = header_size(path, "sizes", sizes[static_cast<std::size_t>(c)]);
  for (const std::string& kind : words(lower(text.text("kinds")))) {
    if (kind != "domain" && kind != "space" && kind != "???" && kind != "none")
      fail_volume(path, fmt::format("an axis of kind '{}' is none of space", kind));
  }
  header.spacing = spacing_of(path, text, header.size);
  return header;
}

VoxelType nrrd_type(const fs::path& path, const std::string& name) {
  struct Named {
    VoxelKind kind;
    int bits;
    std::string_view names;  ///< between commas
  };
  constexpr Named kTypes[] = {
      {VoxelKind::floating, 32, ",float,"},
      {VoxelKind::floating, 64, ",double,"},
      {VoxelKind::signed_integer, 8, ",signed char,int8,int8_t,"},
      {VoxelKind::unsigned_integer, 8, ",uchar,unsigned char,uint8,uint8_t,"},
      {VoxelKind::signed_integer, 16, ",short,short int,signed short,signed short int,int16,int16_t,"},
      {VoxelKind::unsigned_integer, 16, ",ushort,unsigned short,unsigned short int,uint16,uint16_t,"},
      {VoxelKind::signed_integer, 32, ",int,signed int,int32,int32_t,"},
      {VoxelKind::unsigned_integer, 32, ",uint,unsigned int,uint32,uint32_t,"},
      {VoxelKind::signed_integer, 64,
       ",longlong,long long,long long int,signed long long,signed long long int,int64,int64_t,"},
      {VoxelKind::unsigned_integer, 64, ",ulonglong,unsigned long long,unsigned long long int,uint64,uint64_t,"},
  };
  for (const Named& type : kTypes) {
    if (type.names.find(fmt::format(",{},", lower(name))) != std::string_view::npos)
      return voxel_type(type.kind, type.bits);
  }
  fail_volume(path, fmt::format("voxels of type '{}' are not read", name));
}

VoxelCoding nrrd_coding(const fs::path& path, const std::string& encoding) {
  const std::string name = lower(encoding);
  if (name == "raw") return VoxelCoding::raw;
  if (name == "gzip" || name == "gz") return VoxelCoding::packed;
  if (name == "ascii" || name == "text" || name == "txt") return VoxelCoding::numbers;
  if (name == "hex") return VoxelCoding::hexadecimal;
  fail_volume(path, fmt::format("its encoding is '{}'; raw, gzip, ascii and hex are read", encoding));
}

/// "line skip" lines, then "byte skip" bytes lie before the voxels; a byte skip of −1 puts them at the file's end.
void skip_nrrd(const fs::path& path, const NrrdHeader& header, VoxelBytes& place) {
  std::ifstream file(place.file, std::ios::binary);
  file.seekg(static_cast<std::streamoff>(place.offset));
  for (int lines = header_size(path, "line skip", header.text("lineskip", "0")); lines > 0; --lines) {
    file.ignore(std::numeric_limits<std::streamsize>::max(), '\n');
    if (file.gcount() == 0) fail_volume(path, "its file ends before the lines that are to be skipped");
    place.offset += static_cast<std::uintmax_t>(file.gcount());
  }
  const std::string bytes = header.text("byteskip", "0");
  if (bytes != "0" && place.coding != VoxelCoding::raw)
    fail_volume(path, "a byte skip other than 0 is read of raw voxels only");
  place.from_end = bytes == "-1";
  if (!place.from_end) place.offset += static_cast<std::uintmax_t>(header_size(path, "byte skip", bytes));
}

bool is_swapped(const fs::path& path, const NrrdHeader& header, const VoxelBytes& place) {
  const std::string endian = lower(header.text("endian"));
  if (endian == "little" || endian == "big")
    return (endian == "little") != (std::endian::native == std::endian::little);
  if (place.type.bytes > 1 && place.coding != VoxelCoding::numbers)
    fail_volume(path, "its header does not tell the endian of its voxels");
  return false;
}

}  // namespace

VolumeFile load_nrrd(const fs::path& path) {
  const NrrdHeader text = read_nrrd_header(path);
  const VolumeHeader header = shape_of(path, text);
  VoxelBytes place;
  place.type = nrrd_type(path, text.text("type"));
  place.coding = nrrd_coding(path, text.text("encoding"));
  place.swapped = is_swapped(path, text, place);
  const std::string name = text.text("datafile");
  place.file = name.empty() ? path : data_file(path, name);
  place.offset = name.empty() ? text.bytes : 0;
  skip_nrrd(path, text, place);
  return read_voxels(path, header, place);
}

}  // namespace pellucid
