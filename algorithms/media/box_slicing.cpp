// Sampling hulls and image-aligned slices of a box: Imagire et al. 2007 (references.bib: imagire2007), Sec. 3.2,
// Fig. 3.
#include "algorithms/media/box_slicing.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

namespace pellucid {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

glm::dvec3 corner(int i) {
  return {i & 1, (i >> 1) & 1, (i >> 2) & 1};
}

// Corners of each face, counter-clockwise from outside.
constexpr std::array<std::array<int, 4>, 6> kFaces{
    {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};
constexpr std::array<std::array<int, 2>, 12> kEdges{
    {{0, 1}, {2, 3}, {4, 5}, {6, 7}, {0, 2}, {1, 3}, {4, 6}, {5, 7}, {0, 4}, {1, 5}, {2, 6}, {3, 7}}};

// Where the edge crosses `depth`. Always computed from the lower corner, so that every polygon that shares the edge
// gets the same bits.
glm::vec3 edge_point(const BoxDepth& box, int a, int b, double depth) {
  if (a > b) std::swap(a, b);
  const glm::dvec3 pa = corner(a), pb = corner(b);
  const double da = box(pa), db = box(pb);
  return glm::vec3(glm::mix(pa, pb, std::clamp((depth - da) / (db - da), 0.0, 1.0)));
}

using Polygon = std::vector<glm::vec3>;

// A corner is in front of a plane when its depth is strictly smaller; a corner on the plane counts as behind it. One
// rule for all polygons keeps the pieces closed when a plane touches a corner.
bool in_front(const BoxDepth& box, int i, double depth) {
  return box(corner(i)) < depth;
}

// The part of a face between two depths.
Polygon clip_face(const BoxDepth& box, const std::array<int, 4>& face, double front, double back) {
  Polygon polygon;
  for (std::size_t k = 0; k < 4; ++k) {
    const int a = face[k], b = face[(k + 1) % 4];
    if (!in_front(box, a, front) && in_front(box, a, back)) polygon.emplace_back(corner(a));
    std::array<double, 2> planes{front, back};
    if (box(corner(a)) > box(corner(b))) std::swap(planes[0], planes[1]);
    for (double plane : planes) {
      if (in_front(box, a, plane) != in_front(box, b, plane)) polygon.push_back(edge_point(box, a, b, plane));
    }
  }
  return polygon;
}

// The box's cross-section at a depth, counter-clockwise as seen from the front.
Polygon cross_section(const BoxDepth& box, double depth) {
  Polygon polygon;
  for (const auto& [a, b] : kEdges) {
    if (in_front(box, a, depth) != in_front(box, b, depth)) polygon.push_back(edge_point(box, a, b, depth));
  }
  if (polygon.size() < 3) return {};
  // Sort by angle about the centroid, in a basis (u, v) of the plane with u × v towards smaller depth.
  const glm::dvec3 toward = -glm::normalize(box.gradient);
  const glm::dvec3 helper = std::abs(toward.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  const glm::dvec3 u = glm::normalize(glm::cross(helper, toward)), v = glm::cross(toward, u);
  glm::dvec3 centroid(0.0);
  for (const glm::vec3& p : polygon)
    centroid += glm::dvec3(p) / static_cast<double>(polygon.size());
  auto angle = [&](const glm::vec3& p) {
    const glm::dvec3 d = glm::dvec3(p) - centroid;
    return std::atan2(glm::dot(d, v), glm::dot(d, u));
  };
  std::sort(polygon.begin(), polygon.end(), [&](const auto& p, const auto& q) { return angle(p) < angle(q); });
  return polygon;
}

void append(BoxPieces& out, Polygon polygon, bool reversed) {
  if (polygon.size() < 3) return;
  if (reversed) std::reverse(polygon.begin(), polygon.end());
  for (std::size_t i = 2; i < polygon.size(); ++i) {
    out.vertices.insert(out.vertices.end(), {polygon[0], polygon[i - 1], polygon[i]});
  }
  out.pieces.back().count = static_cast<int>(out.vertices.size()) - out.pieces.back().first;
}

}  // namespace

BoxDepth::BoxDepth(const glm::mat4& to_world, const glm::mat4& world_to_view) {
  const glm::dmat4 to_view = glm::dmat4(world_to_view) * glm::dmat4(to_world);
  gradient = -glm::dvec3(to_view[0].z, to_view[1].z, to_view[2].z);
  offset = -to_view[3].z;
  mirrored = glm::determinant(glm::dmat3(to_view)) < 0;
}

std::optional<DepthRange> depth_range(const BoxDepth& box, double near_m) {
  double front = kInfinity, back = -kInfinity;
  for (int i = 0; i < 8; ++i) {
    front = std::min(front, box(corner(i)));
    back = std::max(back, box(corner(i)));
  }
  if (back <= near_m) return std::nullopt;
  return DepthRange{std::max(front, near_m), back, front < near_m};
}

BoxPieces cut_hulls(const BoxDepth& box, const DepthRange& range, int hulls) {
  BoxPieces out;
  auto plane = [&](int k) { return range.front + (range.back - range.front) * k / hulls; };
  for (int i = hulls - 1; i >= 0; --i) {
    out.pieces.push_back({static_cast<int>(out.vertices.size()), 0});
    // The outermost planes touch the box in a corner or an edge at most, so no cap is needed there, except where the
    // near plane cuts the box.
    const double front = i == 0 && !range.clipped ? -kInfinity : plane(i);
    const double back = i == hulls - 1 ? kInfinity : plane(i + 1);
    for (const auto& face : kFaces)
      append(out, clip_face(box, face, front, back), box.mirrored);
    if (std::isfinite(front)) append(out, cross_section(box, front), box.mirrored);
    if (std::isfinite(back)) append(out, cross_section(box, back), !box.mirrored);
  }
  return out;
}

BoxPieces cut_slices(const BoxDepth& box, const DepthRange& range, int slices) {
  BoxPieces out;
  out.pieces.push_back({});
  for (int i = slices - 1; i >= 0; --i) {
    const double depth = range.front + (range.back - range.front) * (i + 0.5) / slices;
    append(out, cross_section(box, depth), box.mirrored);
  }
  return out;
}

ObjectSlices cut_object_slices(const glm::mat4& to_world, const glm::mat4& world_to_view, const glm::vec3& eye,
                               int slices) {
  const glm::vec3 view_axis = -glm::vec3(world_to_view[0].z, world_to_view[1].z, world_to_view[2].z);
  // The slices' normals are the rows of the inverse: the box may be sheared or scaled.
  const glm::mat4 to_local = glm::inverse(to_world);
  auto normal = [&](int k) { return glm::vec3(to_local[0][k], to_local[1][k], to_local[2][k]); };
  int across = 0;
  for (int k = 1; k < 3; ++k) {
    if (std::abs(glm::dot(glm::normalize(normal(k)), view_axis)) >
        std::abs(glm::dot(glm::normalize(normal(across)), view_axis))) {
      across = k;
    }
  }
  ObjectSlices out;
  out.axis = glm::normalize(normal(across));
  out.slab_m = 1 / (glm::length(normal(across)) * static_cast<float>(slices));
  out.polygons.pieces.push_back({});
  const double eye_at = (to_local * glm::vec4(eye, 1.0F))[across];
  auto add = [&](int i) {
    Polygon polygon(4, glm::vec3(static_cast<float>((i + 0.5) / slices)));
    for (int c = 0; c < 4; ++c) {
      polygon[static_cast<std::size_t>(c)][(across + 1) % 3] = c == 1 || c == 2 ? 1.0F : 0.0F;
      polygon[static_cast<std::size_t>(c)][(across + 2) % 3] = c >= 2 ? 1.0F : 0.0F;
    }
    append(out.polygons, polygon, false);
  };
  int below = 0;  // slices before the eye along the edge
  while (below < slices && (below + 0.5) / slices < eye_at)
    ++below;
  for (int i = 0; i < below; ++i)
    add(i);
  for (int i = slices - 1; i >= below; --i)
    add(i);
  return out;
}

}  // namespace pellucid
