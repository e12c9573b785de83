#pragma once

#include <numbers>
#include <vector>

#include <glm/glm.hpp>

#include "algorithms/scene/noise.hpp"
#include "algorithms/scene/scene.hpp"

/// The parts that trees are made of. They are appended to a mesh with vertex colours.
///
/// Random numbers are drawn one statement at a time, or in braces: the order of evaluation of operands and arguments is
/// the compiler's choice, and a seed must give the same forest with every compiler.
namespace pellucid::forest {

inline constexpr float kTurn = 2.0F * std::numbers::pi_v<float>;
inline constexpr glm::vec3 kUp(0.0F, 1.0F, 0.0F);
inline constexpr glm::vec3 kMoss(0.06F, 0.095F, 0.025F);

glm::vec3 heading(float angle);  ///< unit, horizontal
/// Unit; a random heading that rises by a random slope.
glm::vec3 random_direction(float min_rise, float max_rise, Random&);

/// Centre line, thickness and colour of a trunk or branch.
struct Stem {
  std::vector<glm::vec3> path;
  std::vector<float> radius;
  std::vector<glm::vec3> color;
  void add(const glm::vec3& p, float r, const glm::vec3& c) {
    path.push_back(p);
    radius.push_back(r);
    color.push_back(c);
  }
};

/// A tube of `sides` around the stem; it ends in a point where the last radius is 0. `fluting` makes the cross-section
/// irregular and the colour mottled.
void add_tube(Mesh&, const Stem&, int sides, float fluting, Random&);

/// A trunk that flares at the root, tapers to `top_radius` and wanders sideways by about `bend` metres.
struct Trunk {
  float height;
  float root_radius, top_radius;
  float bend;
  int segments;
  glm::vec3 bark, bark_above;
};
Stem make_trunk(const Trunk&, Random&);

/// A curved branch; returns its stem, so that twigs can grow from it.
Stem add_branch(Mesh&, const glm::vec3& base, const glm::vec3& direction, float length, float radius, float lift,
                int segments, int sides, const glm::vec3& bark, Random&);

/// A flat spray of twigs: pairs of triangular teeth along a drooping spine, the gaps between them open, so that its
/// outline is ragged. Normals lean outwards and up, as those of the whole crown.
struct Bough {
  glm::vec3 base;
  glm::vec3 out;  // unit, horizontal
  float length;
  float width;
  float rise;   // slope at the base
  float droop;  // what the tip falls below the straight line, per length
  int teeth;    // pairs of side twigs
  glm::vec3 inside, outside;
};

void add_bough(Mesh&, const Bough&, Random&);

/// Whorls of boughs from `low` to the tip, longest at the bottom; some of the lowest are missing.
struct Whorls {
  float low;
  float reach;  // of the lowest boughs
  int count, boughs, teeth;
  glm::vec3 inside, outside;
};
void add_whorls(Mesh&, const Stem& trunk, float height, const Whorls&, Random&);

/// A leafless crown: limbs around the trunk from `low` up, each with twigs.
struct Limbs {
  float low;
  float reach;  // of the lowest limbs
  float rise;   // slope
  int count, twigs, segments, sides;
  glm::vec3 bark;
};
void add_limbs(Mesh&, const Stem& trunk, float height, const Limbs&, Random&);

glm::vec3 point_on(const Stem&, float y);
float radius_on(const Stem&, float y);

}  // namespace pellucid::forest
