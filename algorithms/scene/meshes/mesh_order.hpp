#pragma once

#include "algorithms/scene/scene.hpp"

namespace pellucid {

/// Puts triangles that lie near each other next to each other (along Morton's curve through the bounds) and numbers the
/// vertices in the order of their first use; vertices that no triangle uses are dropped. Shape and winding stay. Files
/// come in any order, and one without locality has its vertices fetched and transformed several times over.
void order_by_place(Mesh&);

}  // namespace pellucid
