#pragma once

#include <nlohmann/json_fwd.hpp>

#include "algorithms/technique.hpp"

namespace pellucid::sweeps {

/// The place of a picture's error: in a map with classes, for each class C that some pixel has, `flip_mean_C` and
/// `flip_share_C`, its part in the sum of `flip` over all pixels that have a class. Nothing of other maps. `flip`: one
/// channel, of the map's size.
void put_errors_by_class(nlohmann::json& row, const NativeMap&, const Image& flip);

}  // namespace pellucid::sweeps
