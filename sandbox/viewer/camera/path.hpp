#pragma once

#include <span>

#include "algorithms/scene/scene.hpp"

namespace pellucid::sandbox {

/// The camera on a smooth way through `views` (Catmull and Rom 1974), `share` from 0 at the first to 1 at the last; it
/// is at each of them at equal distances of `share`. One view alone stands still.
View view_along(std::span<const View> views, double share);

}  // namespace pellucid::sandbox
