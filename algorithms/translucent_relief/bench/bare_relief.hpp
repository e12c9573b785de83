#pragma once

#include "algorithms/bare_frame.hpp"

namespace pellucid::translucent_relief {

const BareFrameInfo& bare_frame();

}  // namespace pellucid::translucent_relief
