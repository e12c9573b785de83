#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace pellucid {

enum class PlyType { int8, uint8, int16, uint16, int32, uint32, float32, float64 };
std::size_t bytes_of(PlyType);
bool is_integer(PlyType);

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::float32;
  std::optional<PlyType> count_type;  ///< of a list
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;

  /// The position of the first property called one of `names`.
  std::optional<std::size_t> find(std::initializer_list<std::string_view> names) const;
  /// The fewest bytes that one of it takes; of text a digit and what parts it from the next.
  std::uint64_t least_bytes(bool text) const;
};

enum class PlyFormat { text, little_endian, big_endian };

struct PlyHeader {
  PlyFormat format = PlyFormat::text;
  std::vector<PlyElement> elements;
  std::size_t bytes = 0;  ///< up to the first byte of the data
  std::size_t lines = 0;
};

/// Turk, "The PLY Polygon File Format" (1994). Lines end as the first one does, so that data that begin with 0x0A or
/// 0x0D stay whole. Throws InputError: a word that the format does not know, or data that promise more than the file
/// can hold.
PlyHeader read_ply_header(const std::filesystem::path&, std::string_view content);

}  // namespace pellucid
