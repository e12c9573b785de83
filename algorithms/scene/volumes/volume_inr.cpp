#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "algorithms/scene/volumes/volume_formats.hpp"

/// INRIMAGE-4: a header of 256-byte blocks of lines "KEY=value" that ends in "##}", then the voxels. A key that is none
/// of the format's is an error: it may be one that matters.
namespace pellucid {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view kMagic = "#INRIMAGE-4#{";
constexpr std::size_t kBlock = 256;

struct InrHeader {
  std::map<std::string, std::string> values;
  std::size_t bytes = 0;

  std::string text(const std::string& key, std::string otherwise = {}) const {
    const auto found = values.find(key);
    return found == values.end() ? otherwise : found->second;
  }
};

/// Sizes, voxels and spacing; origin, rotation and offset, which are left aside.
constexpr std::array<std::string_view, 20> kInrKeys = {"XDIM", "YDIM", "ZDIM", "VDIM", "TYPE", "PIXSIZE", "SCALE",
                                                       "CPU",  "VX",   "VY",   "VZ",   "TX",   "TY",      "TZ",
                                                       "RX",   "RY",   "RZ",   "XO",   "YO",   "ZO"};

void read_inr_line(const fs::path& path, const std::string& line, InrHeader& header) {
  const auto equals = line.find('=');
  if (line.starts_with('#') || equals == std::string::npos) return;
  const std::string key = line.substr(0, equals);
  if (std::find(kInrKeys.begin(), kInrKeys.end(), key) == kInrKeys.end())
    fail_volume(path, fmt::format("'{}' in its header is no key of INRIMAGE-4", key));
  if (!header.values.emplace(key, line.substr(equals + 1)).second)
    fail_volume(path, fmt::format("its header states {} twice", key));
}

InrHeader read_inr_header(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::string text;
  while (text.size() < 64 * kBlock) {
    std::string block(kBlock, '\0');
    const bool whole = static_cast<bool>(file.read(block.data(), kBlock));
    text += block;
    if (!text.starts_with(kMagic)) fail_volume(path, fmt::format("it does not begin with '{}'", kMagic));
    if (!whole) break;
    if (!text.ends_with("##}\n")) continue;
    InrHeader header;
    header.bytes = text.size();
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);)
      read_inr_line(path, line, header);
    return header;
  }
  fail_volume(path, "its header has no end");
}

VoxelType inr_type(const fs::path& path, const InrHeader& header) {
  const std::string kind = header.text("TYPE");
  std::string bits = header.text("PIXSIZE");
  if (bits.ends_with(" bits")) bits.resize(bits.size() - 5);
  VoxelType type;
  if (kind == "float") type = voxel_type(VoxelKind::floating, header_size(path, "PIXSIZE", bits));
  if (kind == "unsigned fixed") type = voxel_type(VoxelKind::unsigned_integer, header_size(path, "PIXSIZE", bits));
  if (kind == "signed fixed") type = voxel_type(VoxelKind::signed_integer, header_size(path, "PIXSIZE", bits));
  if (type.bytes == 0) fail_volume(path, fmt::format("voxels of TYPE={} and PIXSIZE={} are not read", kind, bits));
  return type;
}

bool is_swapped(const fs::path& path, const InrHeader& header) {
  const std::string cpu = header.text("CPU");
  const bool little = cpu == "decm" || cpu == "alpha" || cpu == "pc";
  const bool big = cpu == "sun" || cpu == "sgi";
  if (!little && !big) fail_volume(path, fmt::format("CPU={} is none of decm, alpha, pc, sun and sgi", cpu));
  return little != (std::endian::native == std::endian::little);
}

}  // namespace

VolumeFile load_inr(const fs::path& path) {
  const InrHeader text = read_inr_header(path);
  VolumeHeader header;
  for (int c = 0; c < 3; ++c) {
    const std::string letter(1, "XYZ"[c]);
    header.size[c] = header_size(path, letter + "DIM", text.text(letter + "DIM"));
    header.spacing[c] = header_number(path, "V" + letter, text.text("V" + letter, "1"));
  }
  header.components = header_size(path, "VDIM", text.text("VDIM", "1"));
  if (const std::string scale = text.text("SCALE", "2**0"); scale != "2**0")
    fail_volume(path, fmt::format("SCALE={} is not applied; 2**0 is read", scale));
  const VoxelType type = inr_type(path, text);
  const bool swapped = is_swapped(path, text);
  return read_voxels(path, header, {.file = path, .offset = text.bytes, .type = type, .swapped = swapped});
}

}  // namespace pellucid
