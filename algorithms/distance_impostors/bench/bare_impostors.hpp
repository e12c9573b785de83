#pragma once

#include "algorithms/bare_frame.hpp"

namespace pellucid::distance_impostors {

const BareFrameInfo& bare_frame();

}  // namespace pellucid::distance_impostors
