#pragma once

#include <cstddef>
#include <string>

#include "sweeps/spec/plan.hpp"

namespace pellucid::sweeps {

/// One part of a sweep that is split without talk between the parts: the points whose id, a hash, falls to it.
struct Shard {
  std::size_t index = 1, count = 1;  ///< 1-based
  bool holds(const Point&) const;
};

/// "2/16". Throws InputError.
Shard parse_shard(const std::string&);

}  // namespace pellucid::sweeps
