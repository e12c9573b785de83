#pragma once

#include "algorithms/bare_frame.hpp"

namespace pellucid::geocube {

const BareFrameInfo& bare_frame();

}  // namespace pellucid::geocube
