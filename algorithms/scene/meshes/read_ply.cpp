#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "algorithms/scene/meshes/ply_header.hpp"
#include "algorithms/scene/meshes/raw_mesh.hpp"
#include "algorithms/scene/meshes/text_lines.hpp"

/// PLY. Ours, because Assimp 5.2 drops triangle strips, takes a first data byte of 0x0A for the header's end, and hangs
/// or crashes on damaged files.
namespace pellucid {

namespace fs = std::filesystem;

namespace {

/// The numbers behind the header, one after another.
class Numbers {
 public:
  Numbers(const fs::path& path, const PlyHeader& header, std::string_view data)
      : path_(path), format_(header.format), data_(data), lines_(data, false, header.lines + 1) {}

  /// Each of an element's instances begins a line of text.
  void begin(const PlyElement& element, std::uint64_t i) {
    element_ = &element;
    instance_ = i;
    if (format_ == PlyFormat::text && !element.properties.empty() && !lines_.next()) throw ends();
  }
  void end() const {
    if (format_ == PlyFormat::text && !lines_.at_end_of_line())
      throw fail(fmt::format("has more numbers than its header says, in line {}", lines_.number()));
  }
  /// Nothing but blank lines may follow the last element.
  void finish() {
    const bool more = format_ == PlyFormat::text
                          ? lines_.next()
                          : data_.substr(at_).find_first_not_of("\r\n") != std::string_view::npos;
    if (more) throw unreadable_mesh(path_, "something follows the elements that its header promises");
  }

  double read(PlyType type) {
    if (format_ == PlyFormat::text) {
      double value = 0;
      if (lines_.at_end_of_line())
        throw fail(fmt::format("has fewer numbers than its header says, in line {}", lines_.number()));
      if (!lines_.number(value))
        throw fail(
            fmt::format("has '{}' for a number in line {}", std::string(lines_.word().substr(0, 40)), lines_.number()));
      return value;
    }
    switch (type) {
      case PlyType::int8:
        return binary<std::int8_t>();
      case PlyType::uint8:
        return binary<std::uint8_t>();
      case PlyType::int16:
        return binary<std::int16_t>();
      case PlyType::uint16:
        return binary<std::uint16_t>();
      case PlyType::int32:
        return binary<std::int32_t>();
      case PlyType::uint32:
        return binary<std::uint32_t>();
      case PlyType::float32:
        return static_cast<double>(binary<float>());
      case PlyType::float64:
        return binary<double>();
    }
    return 0;
  }
  /// How many numbers follow in a list; no more than the file can hold.
  std::uint64_t length(const PlyProperty& property) {
    const double count = read(*property.count_type);
    const std::size_t one = format_ == PlyFormat::text ? 2 : bytes_of(property.type);
    const std::size_t left = format_ == PlyFormat::text ? lines_.line().size() + 1 : data_.size() - at_;
    if (!(count >= 0 && count == std::floor(count))) throw fail(fmt::format("has a list of {} numbers", count));
    if (count * static_cast<double>(one) > static_cast<double>(left)) throw fail("has a list that ends too soon");
    return static_cast<std::uint64_t>(count);
  }
  void skip(const PlyProperty& property) {
    const std::uint64_t count = property.count_type ? length(property) : 1;
    for (std::uint64_t i = 0; i < count; ++i)
      read(property.type);
  }
  InputError fail(std::string_view reason) const {
    return unreadable_mesh(path_, fmt::format("{} {} {}", element_->name, instance_, reason));
  }

 private:
  InputError ends() const {
    return unreadable_mesh(path_, fmt::format("it ends at {} {} of {}", element_->name, instance_, element_->count));
  }
  template <class T>
  T binary() {
    if (data_.size() - at_ < sizeof(T)) throw ends();
    std::array<char, sizeof(T)> bytes;
    std::memcpy(bytes.data(), data_.data() + at_, sizeof(T));
    at_ += sizeof(T);
    const bool little = std::endian::native == std::endian::little;
    if ((format_ == PlyFormat::little_endian) != little) std::reverse(bytes.begin(), bytes.end());
    return std::bit_cast<T>(bytes);
  }

  const fs::path& path_;
  PlyFormat format_;
  std::string_view data_;
  std::size_t at_ = 0;
  TextLines lines_;
  const PlyElement* element_ = nullptr;
  std::uint64_t instance_ = 0;
};

class PlyReader {
 public:
  PlyReader(const fs::path& path, const std::string& content)
      : path_(path),
        header_(read_ply_header(path, content)),
        numbers_(path, header_, std::string_view(content).substr(header_.bytes)) {}

  RawMesh read() {
    for (const PlyElement& element : header_.elements) {
      if (element.name == "vertex")
        vertices(element);
      else if (element.name == "face")
        faces(element);
      else if (element.name == "tristrips")
        strips(element);
      else
        skip(element);
    }
    numbers_.finish();
    add_triangles();
    return std::move(mesh_);
  }

 private:
  void vertices(const PlyElement& element) {
    if (!mesh_.positions.empty()) throw unreadable_mesh(path_, "it has vertices twice");
    std::array<std::size_t, 3> place{};
    for (std::size_t c = 0; c < 3; ++c) {
      const auto found = element.find({std::string_view("xyz").substr(c, 1)});
      if (!found) throw unreadable_mesh(path_, fmt::format("its vertices have no {}", "xyz"[c]));
      place[c] = *found;
    }
    const std::array normal{element.find({"nx"}), element.find({"ny"}), element.find({"nz"})};
    const std::array color{element.find({"red", "r", "diffuse_red"}), element.find({"green", "g", "diffuse_green"}),
                           element.find({"blue", "b", "diffuse_blue"})};
    const std::array uv{element.find({"s", "u", "texture_u"}), element.find({"t", "v", "texture_v"})};
    const bool normals = normal[0] && normal[1] && normal[2];
    const bool colors = color[0] && color[1] && color[2];
    const bool uvs = uv[0] && uv[1];
    mesh_.positions.reserve(element.count);
    std::vector<double> values(element.properties.size());
    for (std::uint64_t i = 0; i < element.count; ++i) {
      numbers_.begin(element, i);
      for (std::size_t p = 0; p < values.size(); ++p) {
        if (element.properties[p].count_type)
          numbers_.skip(element.properties[p]);
        else
          values[p] = numbers_.read(element.properties[p].type);
      }
      numbers_.end();
      mesh_.positions.emplace_back(values[place[0]], values[place[1]], values[place[2]]);
      if (normals) mesh_.normals.emplace_back(values[*normal[0]], values[*normal[1]], values[*normal[2]]);
      if (uvs) mesh_.uvs.emplace_back(values[*uv[0]], values[*uv[1]]);
      if (!colors) continue;
      glm::vec3& c = mesh_.colors.emplace_back();
      for (int k = 0; k < 3; ++k)
        c[k] = color_of(element.properties[*color[static_cast<std::size_t>(k)]].type,
                        values[*color[static_cast<std::size_t>(k)]]);
    }
  }
  /// Integers go up to 255, or to 65535 where the type does; others are shares.
  float color_of(PlyType type, double value) const {
    const double most = !is_integer(type) ? 1 : type == PlyType::uint16 ? 65535 : 255;
    if (!(value >= 0 && value <= most))
      throw numbers_.fail(fmt::format("has a colour of {}, out of [0, {}]", value, most));
    return static_cast<float>(value / most);
  }

  void faces(const PlyElement& element) {
    const auto list = corner_list(element);
    faces_.reserve(element.count);
    for (std::uint64_t i = 0; i < element.count; ++i) {
      numbers_.begin(element, i);
      faces_.begin();
      for (std::size_t p = 0; p < element.properties.size(); ++p) {
        const PlyProperty& property = element.properties[p];
        if (p != list) {
          numbers_.skip(property);
          continue;
        }
        const std::uint64_t corners = numbers_.length(property);
        for (std::uint64_t c = 0; c < corners; ++c)
          faces_.corner(vertex(numbers_.read(property.type)));
      }
      numbers_.end();
    }
  }
  std::size_t corner_list(const PlyElement& element) const {
    const auto list = element.find({"vertex_indices", "vertex_index"});
    if (!list || !element.properties[*list].count_type)
      throw unreadable_mesh(path_, fmt::format("its element {} has no list vertex_indices", element.name));
    return *list;
  }
  std::uint32_t vertex(double index) {
    if (!(index >= 0 && index < 4294967295.0 && index == std::floor(index)))
      throw numbers_.fail(fmt::format("names the vertex {}", index));
    highest_ = std::max(highest_, static_cast<std::uint32_t>(index));
    any_corner_ = true;
    return static_cast<std::uint32_t>(index);
  }

  /// Each vertex behind the second makes a triangle with the two before it, every other one turned; −1 begins anew.
  void strips(const PlyElement& element) {
    const auto list = corner_list(element);
    for (std::uint64_t i = 0; i < element.count; ++i) {
      numbers_.begin(element, i);
      for (std::size_t p = 0; p < element.properties.size(); ++p) {
        const PlyProperty& property = element.properties[p];
        if (p != list) {
          numbers_.skip(property);
          continue;
        }
        std::vector<std::uint32_t> strip;
        const std::uint64_t length = numbers_.length(property);
        for (std::uint64_t c = 0; c < length; ++c) {
          const double index = numbers_.read(property.type);
          if (index == -1) {
            strip.clear();
            continue;
          }
          strip.push_back(vertex(index));
          const std::size_t n = strip.size();
          if (n < 3) continue;
          glm::uvec3 triangle(strip[n - 3], strip[n - 2], strip[n - 1]);
          if (n % 2 == 0) std::swap(triangle.x, triangle.y);
          if (triangle.x != triangle.y && triangle.y != triangle.z && triangle.x != triangle.z)
            strip_triangles_.push_back(triangle);  // others only turn the strip around
        }
      }
      numbers_.end();
    }
  }

  void skip(const PlyElement& element) {
    if (element.properties.empty()) return;
    for (std::uint64_t i = 0; i < element.count; ++i) {
      numbers_.begin(element, i);
      for (const PlyProperty& property : element.properties)
        numbers_.skip(property);
      numbers_.end();
    }
  }

  void add_triangles() {
    if (any_corner_ && highest_ >= mesh_.positions.size())
      throw unreadable_mesh(path_, fmt::format("a face names vertex {} of {}", highest_, mesh_.positions.size()));
    faces_.triangulate(path_, mesh_);
    check_mesh_size(path_, mesh_.positions.size(), mesh_.triangles.size() + strip_triangles_.size());
    mesh_.triangles.insert(mesh_.triangles.end(), strip_triangles_.begin(), strip_triangles_.end());
  }

  const fs::path& path_;
  PlyHeader header_;
  Numbers numbers_;
  RawMesh mesh_;
  Faces faces_;
  std::vector<glm::uvec3> strip_triangles_;
  std::uint32_t highest_ = 0;
  bool any_corner_ = false;
};

}  // namespace

RawMesh read_ply(const fs::path& path) {
  const std::string content = mesh_bytes(path);
  return PlyReader(path, content).read();
}

}  // namespace pellucid
