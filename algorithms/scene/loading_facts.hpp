#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <glm/glm.hpp>

namespace pellucid {

class Scene;

/// The facts that loading a scene found out beside the scene itself.
struct LoadingFacts {
  /// Warnings about the files read: where something was changed, left away or lost precision.
  std::vector<std::string> warnings;
  std::vector<std::filesystem::path> files;  ///< all that were read, the scene's own included
  std::optional<glm::dvec2> file_range;      ///< of a volume from a file: the values in it that became density 0 and 1
};
const LoadingFacts& loading_facts(const Scene&);

}  // namespace pellucid
