#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include <glm/glm.hpp>

#include "algorithms/scene/scene.hpp"

/// Where single rays go at mirrors, metals and dielectrics, by exact geometry: what a technique compares its hit points
/// and exit points with (native errors). Double precision, the surfaces of the reference's own tracer: triangles, with
/// normals interpolated as the raster pass does.
namespace pellucid {

/// A point that a ray has met.
struct InterfaceHit {
  int instance = -1;  ///< index in Scene::instances; −1: the ray meets nothing (the environment)
  double distance_m = std::numeric_limits<double>::infinity();  ///< from the ray's origin
  glm::dvec3 position{0.0};
  glm::dvec3 normal{0.0};  ///< unit, interpolated, on the side where the mesh's front is (outwards of a solid)
  glm::dvec3 face{0.0};    ///< unit, the triangle's own, on that side
  bool front = true;       ///< the ray comes from that side: from outside
  unsigned primitive = 0;  ///< the triangle, in the instance's mesh

  explicit operator bool() const { return instance >= 0; }
};

/// Where a ray inside a solid meets its boundary.
struct InnerVertex {
  InterfaceHit hit;
  glm::dvec3 arriving{0.0};           ///< unit, the direction in which the ray came
  std::optional<glm::dvec3> leaving;  ///< unit, refracted outwards; nothing at total internal reflection
  double reflected_share = 1.0;       ///< Fresnel's; 1 at total internal reflection
  double path_m = 0.0;                ///< inside the solid, from the entry to here
};

/// The way of one ray through one solid.
struct InnerPath {
  glm::dvec3 entering{0.0};            ///< unit, refracted inwards at the entry
  double entry_reflected_share = 0.0;  ///< Fresnel's at the entry; 1 (ior below 1, grazing): no vertices
  /// The k-th boundary met after k internal reflections, each a specular one whether or not it is total; as many as
  /// were asked for, fewer when the mesh is open there.
  std::vector<InnerVertex> vertices;

  /// The first vertex at which light gets out, as rays that follow only total reflection find it; null if none does.
  const InnerVertex* first_exit() const;
};

/// Embree's hierarchy of a scene, to be asked ray by ray from any thread. Keeps the scene's address: make another when
/// objects move.
class InterfaceTracer {
 public:
  explicit InterfaceTracer(const Scene&);  ///< RuntimeError if Embree cannot
  ~InterfaceTracer();
  InterfaceTracer(InterfaceTracer&&) noexcept;
  InterfaceTracer& operator=(InterfaceTracer&&) noexcept;

  /// The object that the pixel (x, y), rows from the top, sees through its centre: the nearest between the clipping
  /// planes.
  InterfaceHit primary(const Camera&, int x, int y) const;

  /// The nearest object along a ray; `direction` unit.
  InterfaceHit nearest(const glm::dvec3& origin, const glm::dvec3& direction) const;
  /// The same for a ray that leaves a surface at `from` (a hit of this tracer): it does not meet the surface where it
  /// starts; it may leave to either side, reflected or refracted. `without`: this instance is not there (as an
  /// environment cube of the others sees it); −1: all are.
  InterfaceHit next(const InterfaceHit& from, const glm::dvec3& direction, int without = -1) const;
  /// The same from any point, without one instance.
  InterfaceHit nearest_without(const glm::dvec3& origin, const glm::dvec3& direction, int without) const;

  /// Mirror direction at a hit, `direction` unit and arriving there. Where an interpolated normal would send it below
  /// the surface the normal is bent towards the triangle's until it does not (as the reference does).
  glm::dvec3 reflected_at(const InterfaceHit&, const glm::dvec3& direction) const;
  /// Refracted direction with the instance's `ior`, inwards or outwards by `front`; nothing at total reflection.
  std::optional<glm::dvec3> refracted_at(const InterfaceHit&, const glm::dvec3& direction) const;

  /// Follows the ray that arrives at `entry` (a front hit on a dielectric instance) along `direction` through that
  /// solid alone, other objects inside or across it left out, and gives the boundary points after 0, 1, … `reflections`
  /// internal reflections.
  InnerPath through(const InterfaceHit& entry, const glm::dvec3& direction, int reflections) const;
  /// The same for a ray that starts inside the solid at `origin` with `direction` (no entry): geocube cells, cameras
  /// inside.
  InnerPath inside(int instance, const glm::dvec3& origin, const glm::dvec3& direction, int reflections) const;

  /// The diagonal of an instance's vertices, in the world: the unit of exit-point errors [m].
  double diagonal_m(int instance) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace pellucid
