#pragma once

#include "algorithms/bare_frame.hpp"

namespace pellucid::sampling_hulls {

const BareFrameInfo& bare_frame();

}  // namespace pellucid::sampling_hulls
