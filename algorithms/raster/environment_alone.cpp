#include "algorithms/raster/environment_alone.hpp"

#include <algorithm>
#include <set>
#include <string>

#include <fmt/format.h>
#include <glm/glm.hpp>

#include "algorithms/scene/files/tell.hpp"

namespace pellucid {

void warn_of_black_environment(const Scene& scene, std::string_view technique) {
  const Environment& environment = scene.environment;
  const glm::vec3 brightest = max(max(environment.zenith, environment.horizon), environment.ground);
  if (environment.scale > 0 && (environment.image || brightest != glm::vec3(0.0F))) return;
  if (std::none_of(scene.instances.begin(), scene.instances.end(),
                   [&](const Instance& instance) { return optical(scene, instance); }))
    return;
  static std::set<std::string> told;
  if (told.insert(fmt::format("{} {}", technique, scene.name)).second)
    tell("warning: {} shows the environment alone, and that of '{}' is black: so are its mirrors and glass", technique,
         scene.name);
}

}  // namespace pellucid
