#pragma once

#include <string>

#include <fmt/format.h>

namespace pellucid::test {

/// A scene as TOML: a ball that scatters (1/m, by every channel), view `front`, a gradient around.
inline std::string cloudy_ball(double scattering, double anisotropy) {
  return fmt::format(R"(title = "A cloudy ball"
description = "It scatters."
[views.front]
eye = [0, 0.2, 3.4]
target = [0, 0, 0]
fov_y_deg = 40
near_m = 0.1
far_m = 100
[materials.medium]
kind = "dielectric"
ior = 1.3
scattering = {}
anisotropy = {}
[meshes.ball]
shape = "sphere"
radius = 1
segments = 16
[instances.ball]
mesh = "ball"
material = "medium"
[environment]
zenith = [0.2, 0.4, 1.0]
horizon = [1.0, 1.0, 1.0]
ground = [0.2, 0.1, 0.0]
)",
                     scattering, anisotropy);
}

}  // namespace pellucid::test
