#include "algorithms/geocube/cache.hpp"

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "algorithms/scene/files/cache_file.hpp"
#include "algorithms/scene/files/hash.hpp"
#include "gl/error.hpp"

namespace pellucid::geocube {

namespace fs = std::filesystem;

namespace {

/// Raise it when what is computed or how it is written changes.
constexpr int kVersion = 6;
constexpr const char* kWhat = "geocube";

template <class T>
std::span<const std::byte> bytes_of(const std::vector<T>& values) {
  return std::as_bytes(std::span(values));
}

// The content after the key and the checksum: everything but the options, which the key stands for.
std::vector<std::byte> packed(const CubeSet& set) {
  ByteWriter out;
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
  ByteReader in(bytes);
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

void add_mesh(Sha256& hash, const Mesh& mesh) {
  hash.add(bytes_of(mesh.positions));
  hash.add(bytes_of(mesh.normals));
  hash.add(bytes_of(mesh.triangles));
}

}  // namespace

std::string cache_key(const Mesh& mesh, std::span<const glm::dvec3> centers, const CubeOptions& o) {
  Sha256 hash;
  hash.add(fmt::format("{} {} {} {} {} {}{}{}{} {}", kVersion, o.resolution, o.layers, o.epsilon,
                       static_cast<int>(o.cone_b), o.use_a, o.use_b, o.use_c, o.use_d, o.ior));
  add_mesh(hash, mesh);
  hash.add(std::as_bytes(centers));
  return hash.hex();
}

std::optional<CubeSet> read_cubes(const fs::path& file, const std::string& key) {
  std::optional<CubeSet> set;
  CacheFile{file, kWhat, key}.read([&](std::span<const std::byte> body) { set = unpacked(body); });
  return set;
}

void write_cubes(const fs::path& file, const std::string& key, const CubeSet& set) {
  CacheFile{file, kWhat, key}.write(packed(set));
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
  CacheFile{file, kWhat, key}.keep(packed(set));
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
    ByteReader in(bytes);
    Placement placement;
    in.take(placement.centers);
    in.take(placement.unseen);
    if (!in.done() || placement.centers.empty() || placement.centers.size() != placement.unseen.size())
      throw InputError("it holds no places");
    return placement;
  };
  Placement placement;
  const CacheFile cached{file, kWhat, key};
  if (cached.read([&](std::span<const std::byte> body) { placement = unpack(body); })) return placement;
  placement = place_cubes(solid, o);
  ByteWriter out;
  out.add(placement.centers);
  out.add(placement.unseen);
  cached.keep(out.bytes());
  return placement;
}

}  // namespace pellucid::geocube
