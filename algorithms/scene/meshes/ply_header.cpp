#include "algorithms/scene/meshes/ply_header.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

#include <fmt/format.h>

#include "algorithms/scene/meshes/raw_mesh.hpp"
#include "algorithms/scene/meshes/text_lines.hpp"

namespace pellucid {

namespace fs = std::filesystem;

namespace {

constexpr std::pair<std::string_view, PlyType> kTypes[] = {
    {"char", PlyType::int8},      {"int8", PlyType::int8},       {"uchar", PlyType::uint8},
    {"uint8", PlyType::uint8},    {"short", PlyType::int16},     {"int16", PlyType::int16},
    {"ushort", PlyType::uint16},  {"uint16", PlyType::uint16},   {"int", PlyType::int32},
    {"int32", PlyType::int32},    {"uint", PlyType::uint32},     {"uint32", PlyType::uint32},
    {"float", PlyType::float32},  {"float32", PlyType::float32}, {"double", PlyType::float64},
    {"float64", PlyType::float64}};

class HeaderReader {
 public:
  HeaderReader(const fs::path& path, std::string_view content) : path_(path), content_(content) {
    const auto end = content.find_first_of("\r\n");
    if (content.substr(0, end) != "ply" || end == std::string_view::npos) fail("it does not begin with the line 'ply'");
    ending_ = content.substr(end).starts_with("\r\n") ? "\r\n" : std::string(1, content[end]);
  }

  PlyHeader read() {
    bool has_format = false;
    line();
    for (;;) {
      const std::string_view text = line();
      TextLines words(text, false, header_.lines);
      if (!words.next()) continue;
      const std::string_view word = words.word();
      if (word == "comment" || word == "obj_info") continue;
      if (word == "format") {
        format(words);
        has_format = true;
      } else if (word == "element") {
        element(words);
      } else if (word == "property") {
        property(words);
      } else if (word == "end_header") {
        break;
      } else {
        fail_line(fmt::format("'{}' is no word of a PLY header", word));
      }
      if (!words.at_end_of_line()) fail_line(fmt::format("'{}' is too much", words.line()));
    }
    if (!has_format) fail("its header states no format");
    header_.bytes = at_;
    check_size();
    return header_;
  }

 private:
  [[noreturn]] void fail(std::string_view reason) const { throw unreadable_mesh(path_, reason); }
  [[noreturn]] void fail_line(std::string_view reason) const {
    fail(fmt::format("{} in line {}", reason, header_.lines));
  }

  std::string_view line() {
    constexpr std::size_t kLongestHeader = 1 << 20;
    const auto end = content_.find(ending_, at_);
    if (end == std::string_view::npos || end > kLongestHeader) fail("its header has no end");
    const std::string_view text = content_.substr(at_, end - at_);
    at_ = end + ending_.size();
    ++header_.lines;
    return text;
  }

  void format(TextLines& words) {
    const std::string_view name = words.word(), version = words.word();
    if (name == "ascii")
      header_.format = PlyFormat::text;
    else if (name == "binary_little_endian")
      header_.format = PlyFormat::little_endian;
    else if (name == "binary_big_endian")
      header_.format = PlyFormat::big_endian;
    else
      fail_line(fmt::format("format '{}' is not read", name));
    if (version != "1.0") fail_line(fmt::format("version '{}' is not 1.0", version));
  }

  void element(TextLines& words) {
    PlyElement& element = header_.elements.emplace_back();
    element.name = words.word();
    if (element.name.empty() || !words.number(element.count)) fail_line("malformed element");
  }

  PlyType type(std::string_view name) const {
    for (const auto& [known, found] : kTypes)
      if (known == name) return found;
    fail_line(fmt::format("type '{}' is not one of PLY", name));
  }

  void property(TextLines& words) {
    if (header_.elements.empty()) fail_line("a property before any element");
    PlyProperty property;
    std::string_view name = words.word();
    if (name == "list") {
      property.count_type = type(words.word());
      if (!is_integer(*property.count_type)) fail_line("a list's length is no integer");
      name = words.word();
    }
    property.type = type(name);
    property.name = words.word();
    if (property.name.empty()) fail_line("a property without a name");
    constexpr std::size_t kMostProperties = 1000;
    if (header_.elements.back().properties.size() >= kMostProperties) fail_line("too many properties");
    header_.elements.back().properties.push_back(property);
  }

  void check_size() const {
    const std::uint64_t left = content_.size() - header_.bytes;
    std::uint64_t vertices = 0, faces = 0;
    for (const PlyElement& element : header_.elements) {
      if (element.name == "vertex") vertices = element.count;
      if (element.name == "face") faces = element.count;
    }
    check_mesh_size(path_, vertices, faces);
    std::uint64_t least = 0;
    for (const PlyElement& element : header_.elements) {
      const std::uint64_t one = element.least_bytes(header_.format == PlyFormat::text);
      // The file's last line may lack its end.
      if (one > 0 && element.count > (left + 1) / one) least = left + 2;
      least += element.count * one;
      if (least <= left + 1) continue;
      fail(fmt::format("its header claims {} vertices and {} faces, more than {} bytes can hold", vertices, faces,
                       content_.size()));
    }
  }

  const fs::path& path_;
  std::string_view content_;
  std::string ending_;
  std::size_t at_ = 0;
  PlyHeader header_;
};

}  // namespace

std::size_t bytes_of(PlyType type) {
  switch (type) {
    case PlyType::int8:
    case PlyType::uint8:
      return 1;
    case PlyType::int16:
    case PlyType::uint16:
      return 2;
    case PlyType::int32:
    case PlyType::uint32:
    case PlyType::float32:
      return 4;
    case PlyType::float64:
      return 8;
  }
  return 0;
}

bool is_integer(PlyType type) {
  return type != PlyType::float32 && type != PlyType::float64;
}

std::optional<std::size_t> PlyElement::find(std::initializer_list<std::string_view> names) const {
  for (std::size_t i = 0; i < properties.size(); ++i)
    if (std::find(names.begin(), names.end(), properties[i].name) != names.end()) return i;
  return std::nullopt;
}

std::uint64_t PlyElement::least_bytes(bool text) const {
  std::uint64_t bytes = 0;
  for (const PlyProperty& property : properties)
    bytes += text ? 2 : bytes_of(property.count_type.value_or(property.type));
  return bytes;
}

PlyHeader read_ply_header(const fs::path& path, std::string_view content) {
  return HeaderReader(path, content).read();
}

}  // namespace pellucid
