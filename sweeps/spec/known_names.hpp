#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "algorithms/parameters.hpp"

namespace pellucid::sweeps {

/// The planner's knowledge of a scene; no mesh, no volume.
struct SceneFacts {
  std::string content_hash;  ///< at the scene's default parameters
  std::vector<std::string> views;
  std::vector<ParameterInfo> parameters;  ///< without the prefix `scene.`
  bool interfaces = false;                ///< it has mirrors, metals or dielectrics
  bool volume = false;
};

/// The names that a spec may use. The installed one asks the registry and the scene loader; tests bring their own.
class KnownNames {
 public:
  virtual ~KnownNames() = default;
  virtual std::vector<std::string> techniques() const = 0;
  /// Throws InputError with the nearest name, as do the next two.
  virtual std::vector<ParameterInfo> technique_parameters(std::string_view technique) const = 0;
  /// SHA-256 (hex) of the technique's code (algorithms/technique_code.hpp).
  virtual std::string code_hash(std::string_view technique) const = 0;
  /// `scene`: a listed name or a path ending in .toml.
  virtual const SceneFacts& scene(const std::string& scene) const = 0;
};

/// The techniques and scenes of this program; scenes are loaded once each, on first use.
const KnownNames& installed_names();

}  // namespace pellucid::sweeps
