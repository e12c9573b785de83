#pragma once

#include <string_view>

#include "algorithms/scene/scene.hpp"

namespace pellucid {

/// For a technique whose interfaces show the environment and nothing else: a warning, once per scene and technique in a
/// process, where the scene has interfaces and its environment is black, as all of them would be.
void warn_of_black_environment(const Scene&, std::string_view technique);

}  // namespace pellucid
