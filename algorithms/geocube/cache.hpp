#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include "algorithms/geocube/cubes.hpp"
#include "algorithms/geocube/placement.hpp"
#include "algorithms/scene/scene.hpp"

/// Cubes are kept in files by the content they were made from (cache_file.hpp).
namespace pellucid::geocube {

/// SHA-256 (hex) of the mesh, the centres and the options.
std::string cache_key(const Mesh&, std::span<const glm::dvec3> centers, const CubeOptions&);

/// Nothing when the file is missing, damaged (with a warning) or of another key.
std::optional<CubeSet> read_cubes(const std::filesystem::path& file, const std::string& key);
/// Throws RuntimeError when it cannot be written.
void write_cubes(const std::filesystem::path& file, const std::string& key, const CubeSet&);

/// From the folder, or built and then kept there. `build_s` is always what building took.
CubeSet cached_cubes(const Solid&, const Mesh&, std::span<const glm::dvec3> centers, const CubeOptions&,
                     const std::filesystem::path& folder);

/// The same for automatic placement, which takes longer than the cubes of a usual resolution.
Placement cached_placement(const Solid&, const Mesh&, const PlacementOptions&, const std::filesystem::path& folder);

}  // namespace pellucid::geocube
