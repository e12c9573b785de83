#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "algorithms/parameters.hpp"
#include "algorithms/scene/scene.hpp"

/// Lights and objects are moved by the parameters that place them, so that what a hand did is in the recipe.
namespace pellucid::sandbox {

/// A drag over (dx, dy) pixels changes the parameters that belong to `name` (without the prefix `scene.`) to these.
/// Names that end in _x, _y, _z (or _x_m, …) are places of one object along the world's axes: it follows the pointer,
/// on the floor where there is no _y. For any other number the drag over the picture's width is its whole range.
std::vector<std::pair<std::string, Value>> dragged(const std::string& name, const std::vector<ParameterInfo>& infos,
                                                   const std::function<Value(const std::string&)>& get, const View&,
                                                   float dx_px, float dy_px, int width_px, int height_px);

/// The first parameter of the scene that places something; empty when there is none.
std::string first_placement(const std::vector<ParameterInfo>& infos);

}  // namespace pellucid::sandbox
