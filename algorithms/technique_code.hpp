#pragma once

#include <string>
#include <string_view>

namespace pellucid {

/// The sources that a technique is made of, found at build time (technique_code.cmake).
struct TechniqueCode {
  const char* technique = nullptr;
  const char* sources_sha256 = nullptr;  ///< of its C++ and of the C++ below that it uses
  const char* shaders = nullptr;         ///< resources that this C++ names, separated by spaces
};
extern const TechniqueCode kTechniqueCode[];  ///< ends with an empty one

/// SHA-256 (hex) of all that decides on a technique's pictures and times: its C++ with the C++ below that it uses, and
/// every shader that it may compile with all that the shader includes. An override of $PELLUCID_SHADER_PATH counts.
/// Measuring alone (a folder `bench`) does not. `technique` is one of techniques().
std::string code_hash(std::string_view technique);

}  // namespace pellucid
