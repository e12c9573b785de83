#pragma once

#include "algorithms/scene/scene.hpp"
#include "algorithms/scene/volumes/volume_file.hpp"

/// Making solids of what files hold, with VTK's filters.
namespace pellucid {

struct MeshProcessing {
  /// Weld vertices by position, triangulate every hole, and turn all triangles counter-clockwise from outside.
  bool close_holes = false;
  int subdivide = 0;  ///< Loop subdivisions, each of four triangles out of one (Loop 1987); 0…5
  bool any() const { return close_holes || subdivide > 0; }
};

/// Colours and uvs are dropped, normals made anew. Throws InputError when the result would exceed kMaxTriangles, the
/// mesh is not manifold (Loop's rule needs two triangles at an edge), or holes remain.
void process_mesh(Mesh&, const MeshProcessing&, double crease_deg);

struct IsosurfaceOptions {
  double level = 0.5;   ///< in the data's own values
  double refine = 1.0;  ///< voxels along an axis out of one, by cubic interpolation; 1…4
};

/// The largest connected surface on which the data equal the level, closed at the data's border as if they were
/// surrounded by their minimum; outward from the higher values; in the file's unit. Throws InputError when there is
/// none.
Mesh isosurface(const VolumeFile&, const IsosurfaceOptions&);

}  // namespace pellucid
