#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "algorithms/scene/meshes/raw_mesh.hpp"

/// 3D Studio's chunks, little-endian: number, length, content (Pitts, "3D Studio File Format", 1994). Meshes are read
/// as they lie in the editor's space, whose z axis points up; keyframes, which may move them, are left aside.
namespace pellucid {

namespace fs = std::filesystem;

namespace {

static_assert(std::endian::native == std::endian::little);

enum Chunk : std::uint16_t {
  kMain = 0x4D4D,
  kEditor = 0x3D3D,
  kObject = 0x4000,
  kMesh = 0x4100,
  kVertices = 0x4110,
  kFaces = 0x4120,
  kUvs = 0x4140,
  kSmoothing = 0x4150,
  kKeyframer = 0xB000,
  kObjectNode = 0xB002,
  kNodeHeader = 0xB010
};

class Bytes {
 public:
  Bytes(const fs::path& path, std::string_view bytes) : path_(&path), bytes_(bytes) {}
  bool empty() const { return bytes_.empty(); }
  std::size_t size() const { return bytes_.size(); }

  template <class T>
  T take() {
    if (bytes_.size() < sizeof(T)) fail("a chunk ends too soon");
    T value;
    std::memcpy(&value, bytes_.data(), sizeof(T));
    bytes_.remove_prefix(sizeof(T));
    return value;
  }
  std::string text() {
    const auto end = bytes_.find('\0');
    if (end == std::string_view::npos) fail("a name without an end");
    const std::string out(bytes_.substr(0, end));
    bytes_.remove_prefix(end + 1);
    return out;
  }
  /// The next chunk's number and content.
  std::pair<std::uint16_t, Bytes> chunk() {
    const auto number = take<std::uint16_t>();
    const auto length = take<std::uint32_t>();
    if (length < 6 || length - 6 > bytes_.size())
      fail(fmt::format("chunk {:#06x} of {} bytes, of which {} are there", number, length, bytes_.size() + 6));
    const Bytes content(*path_, bytes_.substr(0, length - 6));
    bytes_.remove_prefix(length - 6);
    return {number, content};
  }
  [[noreturn]] void fail(std::string_view reason) const { throw unreadable_mesh(*path_, reason); }

 private:
  const fs::path* path_;
  std::string_view bytes_;
};

class Reader3ds {
 public:
  explicit Reader3ds(const fs::path& path) : path_(path) {}

  RawMesh read(const std::string& content) {
    Bytes file(path_, content);
    auto [number, main] = file.chunk();
    if (number != kMain) file.fail("it does not begin with 3D Studio's main chunk");
    while (!main.empty()) {
      auto [kind, part] = main.chunk();
      if (kind == kEditor) editor(part);
      if (kind == kKeyframer) keyframes(part);
    }
    for (const auto& [name, uses] : placed_) {
      if (uses > 1) file.fail(fmt::format("its keyframes place the object '{}' {} times; one is read", name, uses));
    }
    if (!all_mapped_) mesh_.uvs.clear();
    return std::move(mesh_);
  }

 private:
  void editor(Bytes part) {
    while (!part.empty()) {
      auto [kind, object] = part.chunk();
      if (kind != kObject) continue;
      object.text();
      while (!object.empty()) {
        const auto [what, content] = object.chunk();
        if (what == kMesh) mesh(content);
      }
    }
  }

  void keyframes(Bytes part) {
    while (!part.empty()) {
      auto [kind, node] = part.chunk();
      if (kind != kObjectNode) continue;
      while (!node.empty()) {
        auto [what, header] = node.chunk();
        if (what == kNodeHeader) {
          const std::string name = header.text();
          if (name != "$$$DUMMY") ++placed_[name];
        }
      }
    }
  }

  void mesh(Bytes part) {
    const std::size_t first = mesh_.positions.size();
    std::vector<glm::vec2> uvs;
    std::vector<std::pair<glm::u16vec3, std::uint32_t>> faces;
    while (!part.empty()) {
      auto [kind, content] = part.chunk();
      if (kind == kVertices) vertices(content);
      if (kind == kFaces) read_faces(content, faces);
      if (kind == kUvs) {
        for (std::size_t n = content.take<std::uint16_t>(); n > 0; --n) {
          const auto u = content.take<float>();
          uvs.emplace_back(u, content.take<float>());
        }
      }
    }
    const std::size_t count = mesh_.positions.size() - first;
    if (count > 0) all_mapped_ = all_mapped_ && uvs.size() == count;
    uvs.resize(count);
    mesh_.uvs.insert(mesh_.uvs.end(), uvs.begin(), uvs.end());
    for (const auto& [corners, groups] : faces) {
      for (int i = 0; i < 3; ++i)
        if (corners[i] >= count) part.fail(fmt::format("a face names vertex {} of {}", corners[i], count));
      mesh_.triangles.push_back(glm::uvec3(corners) + static_cast<unsigned>(first));
      // Groups are a mesh's own. Another mesh's vertices are others, so they never meet.
      mesh_.smoothing.push_back(groups);
    }
    check_mesh_size(path_, mesh_.positions.size(), mesh_.triangles.size());
  }

  void vertices(Bytes content) {
    for (std::size_t n = content.take<std::uint16_t>(); n > 0; --n) {
      const auto x = static_cast<double>(content.take<float>());
      const auto y = static_cast<double>(content.take<float>());
      const auto z = static_cast<double>(content.take<float>());
      mesh_.positions.emplace_back(x, z, -y);  // z up to y up
    }
  }

  void read_faces(Bytes content, std::vector<std::pair<glm::u16vec3, std::uint32_t>>& faces) {
    const std::size_t first = faces.size();
    for (std::size_t n = content.take<std::uint16_t>(); n > 0; --n) {
      const auto a = content.take<std::uint16_t>(), b = content.take<std::uint16_t>(),
                 c = content.take<std::uint16_t>();
      content.take<std::uint16_t>();  // which edges are drawn
      faces.emplace_back(glm::u16vec3(a, b, c), 0);
    }
    while (!content.empty()) {
      auto [kind, part] = content.chunk();
      if (kind != kSmoothing) continue;
      for (std::size_t f = first; f < faces.size(); ++f)
        faces[f].second = part.take<std::uint32_t>();
    }
  }

  const fs::path& path_;
  RawMesh mesh_;
  std::map<std::string, int> placed_;
  bool all_mapped_ = true;
};

}  // namespace

RawMesh read_3ds(const fs::path& path) {
  return Reader3ds(path).read(mesh_bytes(path));
}

}  // namespace pellucid
