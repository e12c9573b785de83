#pragma once

namespace pellucid::test {

/// A scene as TOML: view `front`, a sun, a gradient around, and a parameter `eta` for the ball's index.
inline constexpr const char* kGlassBall = R"(title = "A ball of glass over a floor"
ambient = 0.3
[views.front]
eye = [0, 1, 4]
target = [0, 0.7, 0]
[environment]
zenith = [0.2, 0.4, 0.9]
horizon = [0.9, 0.9, 0.8]
[lights.sun]
kind = "directional"
direction = [0, -1, 0]
intensity = 2
shadow = true
[meshes.ball]
shape = "sphere"
radius = 0.5
[meshes.floor]
shape = "plane"
size = [6, 6]
[materials.glass]
kind = "dielectric"
[materials.grey]
[instances.ball]
mesh = "ball"
material = "glass"
position = [0, 0.7, 0]
[instances.floor]
mesh = "floor"
material = "grey"
[parameters]
eta = { default = 1.5, range = [1, 3], doc = "index", mode = "set", drives = ["materials.glass.ior"] }
)";

}  // namespace pellucid::test
