#pragma once

#include <cstdint>

#include "algorithms/scene/scene.hpp"

/// The kinds of plants of add_forest(). Each stands on y = 0 at the origin and carries its albedo as vertex colours
/// (dark towards the inside of a crown, where little light gets).
namespace pellucid::forest {

enum class Detail { near, far };  ///< far: a third of the triangles, for what stands behind others

Mesh make_spruce(std::uint32_t seed, Detail);        ///< 15 m; drooping boughs in whorls from 1.5 m up
Mesh make_young_spruce(std::uint32_t seed, Detail);  ///< 4 m; boughs down to the ground
Mesh make_pine(std::uint32_t seed, Detail);          ///< 18 m; a bare trunk with dead stubs, a loose crown from 11 m up
Mesh make_beech(std::uint32_t seed, Detail);         ///< 15 m; leafless, forked
Mesh make_birch(std::uint32_t seed, Detail);         ///< 12 m; slender, pale, leafless
Mesh make_fern(std::uint32_t seed, Detail);          ///< 0.7 m
Mesh make_rock(std::uint32_t seed, Detail);          ///< 0.8 m, half sunk
Mesh make_fallen_trunk(std::uint32_t seed, Detail);  ///< 5 m along x, centred

}  // namespace pellucid::forest
