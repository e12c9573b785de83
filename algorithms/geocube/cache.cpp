#include "algorithms/geocube/cache.hpp"

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <type_traits>
#include <vector>

#include <fmt/format.h>

#include "algorithms/scene/files/atomic_file.hpp"
#include "algorithms/scene/files/hash.hpp"
#include "gl/error.hpp"

namespace pellucid::geocube {

namespace fs = std::filesystem;

namespace {

/// Raise it when what is computed or how it is written changes.
constexpr int kVersion = 4;
constexpr std::string_view kMagic = "pellucid geocube\n";

template <class T>
std::span<const std::byte> bytes_of(const std::vector<T>& values) {
  return std::as_bytes(std::span(values));
}

/// Values one after the other, as they lie in memory.
class Writer {
 public:
  template <class T>
  requires std::is_trivially_copyable_v<T>
  void add(const T& value) {
    const auto bytes = std::as_bytes(std::span(&value, 1));
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
  }
  template <class T>
  void add(const std::vector<T>& values) {
    add(static_cast<std::uint64_t>(values.size()));
    const auto bytes = std::as_bytes(std::span(values));
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
  }
  const std::vector<std::byte>& bytes() const { return bytes_; }

 private:
  std::vector<std::byte> bytes_;
};

class Reader {
 public:
  explicit Reader(std::span<const std::byte> bytes) : rest_(bytes) {}
  template <class T>
  requires std::is_trivially_copyable_v<T>
  void take(T& value) { copy(&value, sizeof(T)); }
  template <class T>
  void take(std::vector<T>& values) {
    std::uint64_t count = 0;
    take(count);
    if (count > rest_.size() / sizeof(T)) throw InputError("a list is longer than the file");
    values.resize(count);
    copy(values.data(), count * sizeof(T));
  }
  bool done() const { return rest_.empty(); }

 private:
  void copy(void* to, std::size_t count) {
    if (count > rest_.size()) throw InputError("it ends early");
    if (count > 0) std::memcpy(to, rest_.data(), count);
    rest_ = rest_.subspan(count);
  }
  std::span<const std::byte> rest_;
};

// What follows the key and the checksum: everything but the options, which the key stands for.
std::vector<std::byte> packed(const CubeSet& set) {
  Writer out;
  out.add(set.diagonal);
  out.add(set.unseen_share);
  out.add(set.build_s);
  out.add(set.first_cube);
  out.add(static_cast<std::uint64_t>(set.cubes.size()));
  for (const Cube& cube : set.cubes) {
    out.add(cube.center);
    out.add(cube.sphere);
    out.add(cube.dropped_share);
    out.add(static_cast<std::uint64_t>(cube.layers.size()));
    for (const CubeLayer& layer : cube.layers) {
      out.add(layer.bounds);
      out.add(layer.planes);
      out.add(layer.inners);
    }
  }
  return out.bytes();
}

CubeSet unpacked(std::span<const std::byte> bytes) {
  Reader in(bytes);
  CubeSet set;
  in.take(set.diagonal);
  in.take(set.unseen_share);
  in.take(set.build_s);
  in.take(set.first_cube);
  std::uint64_t cubes = 0, layers = 0;
  in.take(cubes);
  if (cubes > kMaxCubes) throw InputError("too many cubes");
  set.cubes.resize(cubes);
  for (Cube& cube : set.cubes) {
    in.take(cube.center);
    in.take(cube.sphere);
    in.take(cube.dropped_share);
    in.take(layers);
    if (layers > 8) throw InputError("too many layers");
    cube.layers.resize(layers);
    for (CubeLayer& layer : cube.layers) {
      in.take(layer.bounds);
      in.take(layer.planes);
      in.take(layer.inners);
    }
  }
  if (!in.done()) throw InputError("it is longer than it says");
  return set;
}

// A file is the magic, the key and the body's checksum, then the body.
template <class T, class Unpack>
std::optional<T> read_file(const fs::path& file, const std::string& key, Unpack unpack) {
  std::error_code error;
  if (!fs::exists(file, error)) return std::nullopt;
  try {
    std::ifstream in(file, std::ios::binary);
    const std::vector<char> text((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
    const std::string head = std::string(kMagic) + key;
    constexpr std::size_t kDigits = 64;
    if (text.size() < head.size() + kDigits || std::string_view(text.data(), head.size()) != head)
      throw InputError("it holds something else");
    const auto body = std::as_bytes(std::span(text)).subspan(head.size() + kDigits);
    if (std::string_view(text.data() + head.size(), kDigits) != sha256_hex(body))
      throw InputError("its checksum is wrong");
    return unpack(body);
  } catch (const std::exception& e) {
    fmt::print(stderr, "warning: cached geocube '{}' cannot be used ({}); making it again\n", file.string(), e.what());
  }
  return std::nullopt;
}

void write_file(const fs::path& file, const std::string& key, std::span<const std::byte> body) {
  std::error_code error;
  fs::create_directories(file.parent_path(), error);
  if (error)
    throw RuntimeError(fmt::format("folder '{}' cannot be made: {}", file.parent_path().string(), error.message()));
  AtomicFile out(file);
  out.write(kMagic);
  out.write(key);
  out.write(sha256_hex(body));
  out.write(body);
  out.commit();
}

void keep(const fs::path& file, const std::string& key, std::span<const std::byte> body) {
  try {
    write_file(file, key, body);
  } catch (const RuntimeError& e) {
    fmt::print(stderr, "warning: the geocube is not cached: {}\n", e.what());
  }
}

void add_mesh(Sha256& hash, const Mesh& mesh) {
  hash.add(bytes_of(mesh.positions));
  hash.add(bytes_of(mesh.normals));
  hash.add(bytes_of(mesh.triangles));
}

}  // namespace

fs::path cache_folder() {
  const auto set = [](const char* name) -> std::string {
    const char* value = std::getenv(name);
    return value != nullptr ? value : "";
  };
  if (const std::string own = set("PELLUCID_CACHE"); !own.empty())
    return own == "off" ? fs::path() : fs::path(own) / "geocube";
  if (const std::string xdg = set("XDG_CACHE_HOME"); !xdg.empty()) return fs::path(xdg) / "pellucid" / "geocube";
  if (const std::string home = set("HOME"); !home.empty()) return fs::path(home) / ".cache" / "pellucid" / "geocube";
  return {};
}

std::string cache_key(const Mesh& mesh, std::span<const glm::dvec3> centers, const CubeOptions& o) {
  Sha256 hash;
  hash.add(fmt::format("{} {} {} {} {} {}{}{}{} {}", kVersion, o.resolution, o.layers, o.epsilon,
                       static_cast<int>(o.cone_b), o.use_a, o.use_b, o.use_c, o.use_d, o.ior));
  add_mesh(hash, mesh);
  hash.add(std::as_bytes(centers));
  return hash.hex();
}

std::optional<CubeSet> read_cubes(const fs::path& file, const std::string& key) {
  return read_file<CubeSet>(file, key, unpacked);
}

void write_cubes(const fs::path& file, const std::string& key, const CubeSet& set) {
  write_file(file, key, packed(set));
}

CubeSet cached_cubes(const Solid& solid, const Mesh& mesh, std::span<const glm::dvec3> centers,
                     const CubeOptions& options, const fs::path& folder) {
  if (folder.empty()) return build_cubes(solid, centers, options);
  const std::string key = cache_key(mesh, centers, options);
  const fs::path file = folder / (key + ".cubes");
  if (auto set = read_cubes(file, key)) {
    set->options = options;
    return std::move(*set);
  }
  CubeSet set = build_cubes(solid, centers, options);
  keep(file, key, packed(set));
  return set;
}

Placement cached_placement(const Solid& solid, const Mesh& mesh, const PlacementOptions& o, const fs::path& folder) {
  if (folder.empty()) return place_cubes(solid, o);
  Sha256 hash;
  hash.add(fmt::format("placement {} {} {} {} {} {}", kVersion, o.cubes, o.enough, o.candidates, o.samples, o.seed));
  add_mesh(hash, mesh);
  const std::string key = hash.hex();
  const fs::path file = folder / (key + ".places");
  const auto unpack = [](std::span<const std::byte> bytes) {
    Reader in(bytes);
    Placement placement;
    in.take(placement.centers);
    in.take(placement.unseen);
    if (!in.done() || placement.centers.empty() || placement.centers.size() != placement.unseen.size())
      throw InputError("it holds no places");
    return placement;
  };
  if (auto known = read_file<Placement>(file, key, unpack)) return std::move(*known);
  Placement placement = place_cubes(solid, o);
  Writer out;
  out.add(placement.centers);
  out.add(placement.unseen);
  keep(file, key, out.bytes());
  return placement;
}

}  // namespace pellucid::geocube
