#pragma once

#include <vector>

#include "algorithms/scene/scene.hpp"

namespace pellucid {

/// Parts of a mesh that share no vertex.
struct ConnectedParts {
  std::vector<int> of_vertex;  ///< the number of each vertex's part, in the order of the parts' first vertices
  int count = 0;
};
ConnectedParts connected_parts(const Mesh&);

}  // namespace pellucid
