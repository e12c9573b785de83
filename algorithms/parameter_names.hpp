#pragma once

#include <string>
#include <string_view>
#include <utility>

namespace pellucid {

/// Whose parameter a full name means: "hulls" is the technique's, "scene.time_s", "frame.format" and "shadow.size" are
/// not.
enum class ParameterOwner { technique, scene, frame, shadow };

struct ParameterName {
  ParameterOwner owner = ParameterOwner::technique;
  std::string local;  ///< the name that the owner's table knows
};

/// The one place where names are routed.
inline ParameterName route(std::string_view full) {
  for (const auto& [prefix, owner] : {std::pair{std::string_view("scene."), ParameterOwner::scene},
                                      std::pair{std::string_view("frame."), ParameterOwner::frame},
                                      std::pair{std::string_view("shadow."), ParameterOwner::shadow}}) {
    if (full.starts_with(prefix)) return {owner, std::string(full.substr(prefix.size()))};
  }
  return {ParameterOwner::technique, std::string(full)};
}

/// The reverse.
inline std::string full_name(ParameterOwner owner, std::string_view local) {
  constexpr std::string_view kPrefixes[] = {"", "scene.", "frame.", "shadow."};
  return std::string(kPrefixes[static_cast<int>(owner)]) + std::string(local);
}

}  // namespace pellucid
