#include <bit>
#include <cmath>
#include <fstream>
#include <map>
#include <sstream>

#include <fmt/format.h>

#include "algorithms/scene/volumes/volume_formats.hpp"

/// NRRD: lines "field: value" up to an empty one, then the voxels or, detached, their file. Ours, because vtkNrrdReader
/// of VTK 9.1 takes a first axis of up to nine voxels for components and reads only one slice of a packed file.
namespace pellucid {

namespace fs = std::filesystem;

namespace {

using Fields = std::map<std::string, std::string>;

struct NrrdHeader {
  Fields fields;
  std::uintmax_t bytes = 0;  ///< up to the voxels

  std::string text(const std::string& field, std::string otherwise = {}) const {
    const auto found = fields.find(field);
    return found == fields.end() ? otherwise : found->second;
  }
};

NrrdHeader read_header(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  NrrdHeader header;
  std::string line;
  constexpr std::uintmax_t kLongestHeader = 1 << 20;
  for (bool first = true; header.bytes < kLongestHeader && std::getline(file, line); first = false) {
    header.bytes += line.size() + (file.eof() ? 0 : 1);
    if (line.ends_with('\r')) line.pop_back();
    if (first && !line.starts_with("NRRD")) fail_volume(path, "it does not begin with 'NRRD'");
    if (line.empty()) return header;
    const auto colon = line.find(": ");
    if (line.starts_with('#') || colon == std::string::npos) continue;  // also "key:=value", which means nothing to us
    std::string field = line.substr(0, colon);
    std::erase(field, ' ');  // "data file" and "datafile" are the same
    const auto begin = line.find_first_not_of(' ', colon + 2);
    if (begin != std::string::npos) {
      header.fields[field] = line.substr(begin, line.find_last_not_of(" \t") + 1 - begin);
    }
  }
  if (!header.fields.contains("datafile")) fail_volume(path, "its header has no end");
  return header;
}

std::vector<std::string> words(const std::string& text) {
  std::istringstream stream(text);
  return {std::istream_iterator<std::string>(stream), {}};
}

/// "(a,b,c)": the distance between voxels is its length.
double length_of(const fs::path& path, std::string text) {
  if (text.size() < 2 || text.front() != '(' || text.back() != ')') {
    fail_volume(path, fmt::format("'{}' is no vector of space directions", text));
  }
  std::istringstream numbers(text.substr(1, text.size() - 2));
  double square = 0;
  for (std::string number; std::getline(numbers, number, ',');) {
    const double v = header_number(path, "space directions", number);
    square += v * v;
  }
  return std::sqrt(square);
}

VolumeHeader shape_of(const fs::path& path, const NrrdHeader& text) {
  const auto three = [&](const std::string& field, const std::string& shown) {
    std::vector<std::string> all = words(text.text(field));
    if (all.size() != 3) fail_volume(path, fmt::format("{} {} where 3 are needed", all.size(), shown));
    return all;
  };
  VolumeHeader header;
  if (const std::string dimension = text.text("dimension"); dimension != "3") {
    fail_volume(path, fmt::format("its dimension is '{}'; volumes have 3", dimension));
  }
  const auto sizes = three("sizes", "sizes");
  for (int c = 0; c < 3; ++c)
    header.size[c] = header_size(path, "sizes", sizes[static_cast<std::size_t>(c)]);
  if (text.fields.contains("spacings")) {
    const auto spacings = three("spacings", "spacings");
    for (int c = 0; c < 3; ++c)
      header.spacing[c] = header_number(path, "spacings", spacings[static_cast<std::size_t>(c)]);
  } else if (text.fields.contains("spacedirections")) {
    const auto directions = three("spacedirections", "space directions");
    for (int c = 0; c < 3; ++c)
      header.spacing[c] = length_of(path, directions[static_cast<std::size_t>(c)]);
  }
  return header;
}

VoxelType type_of(const fs::path& path, const std::string& name) {
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
    if (type.names.find("," + name + ",") != std::string_view::npos) return voxel_type(type.kind, type.bits);
  }
  fail_volume(path, fmt::format("voxels of type '{}' are not read", name));
}

bool is_swapped(const fs::path& path, const NrrdHeader& header, const VoxelType& type) {
  const std::string endian = header.text("endian");
  if (endian == "little" || endian == "big")
    return (endian == "little") != (std::endian::native == std::endian::little);
  if (type.bytes > 1) fail_volume(path, "its header does not tell the endian of its voxels");
  return false;
}

/// Where the voxels lie: a file and an offset in it.
std::pair<fs::path, std::uintmax_t> data_place(const fs::path& path, const NrrdHeader& header) {
  for (const char* skip : {"lineskip", "byteskip"}) {
    if (header.text(skip, "0") != "0") fail_volume(path, fmt::format("a {} other than 0 is not read", skip));
  }
  const std::string name = header.text("datafile");
  if (name.empty()) return {path, header.bytes};
  if (name.starts_with("LIST") || name.find('%') != std::string::npos) {
    fail_volume(path, "its voxels lie in several files; one is read");
  }
  const fs::path file = path.parent_path() / name;
  std::error_code error;
  if (!fs::is_regular_file(file, error)) fail_volume(path, fmt::format("its data file '{}' is missing", file.string()));
  return {file, 0};
}

}  // namespace

VolumeFile load_nrrd(const fs::path& path) {
  const NrrdHeader text = read_header(path);
  const VolumeHeader header = shape_of(path, text);
  const VoxelType type = type_of(path, text.text("type"));
  const bool swapped = is_swapped(path, text, type);
  const std::string encoding = text.text("encoding");
  const bool packed = encoding == "gzip" || encoding == "gz";
  if (!packed && encoding != "raw") {
    fail_volume(path, fmt::format("its encoding is '{}'; raw and gzip are read", encoding));
  }
  const auto [file, offset] = data_place(path, text);
  const std::uintmax_t bytes = fs::file_size(file) - offset;
  check_header(path, header, bytes);
  const std::size_t promised = header.count() * type.bytes;
  const auto check_bytes = [&](std::uintmax_t found) {
    if (found == promised) return;
    fail_volume(path, fmt::format("{} bytes of voxels where its header promises {}", found, promised));
  };

  std::string raw;
  if (packed) {
    unpack(path, read_behind(file, offset), [&](std::string_view piece) {
      raw += piece;
      if (raw.size() > promised) check_bytes(raw.size());
    });
    check_bytes(raw.size());
  } else {
    check_bytes(bytes);
    raw = read_behind(file, offset);
  }
  VolumeFile volume{header.size, header.spacing, decode_voxels(raw, type, swapped), {}};
  if (file != path) volume.files.push_back(file);
  return volume;
}

}  // namespace pellucid
