#include "algorithms/geocube/solid.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "algorithms/geocube/weld.hpp"
#include "algorithms/scene/files/tell.hpp"
#include "gl/error.hpp"

namespace pellucid::geocube {
namespace {

// Seams that were computed twice differ by rounding: by this share of the diagonal at most.
constexpr double kWeldTolerance = 1e-6;

InputError refused(const std::string& mesh, const std::string& why) {
  return InputError(fmt::format("mesh '{}' is no solid: {}", mesh, why));
}

void check_finite(const Mesh& mesh) {
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const glm::vec3& p = mesh.positions[i];
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
      throw refused(mesh.name, fmt::format("vertex {} is not finite", i));
  }
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const glm::uvec3& t = mesh.triangles[i];
    if (std::max({t.x, t.y, t.z}) >= mesh.positions.size())
      throw refused(mesh.name, fmt::format("triangle {} names a vertex that does not exist", i));
  }
}

std::string where_open(const Welded& surface, const Topology& found) {
  const auto largest = std::max_element(found.borders.begin(), found.borders.end(),
                                        [](const Border& a, const Border& b) { return a.size() < b.size(); });
  glm::dvec3 middle(0.0);
  for (const std::uint32_t corner : *largest)
    middle += surface.positions[corner] / static_cast<double>(largest->size());
  return fmt::format("it is open: {}, {} border edges, the largest hole ({} edges) near {}",
                     counted(found.borders.size(), "hole"), found.open_edges, largest->size(), place(middle));
}

}  // namespace

Solid::Solid(const Mesh& mesh, Holes holes) : name_(mesh.name), normals_(mesh.normals) {
  if (mesh.triangles.empty()) throw refused(name_, "it has no triangles");
  check_finite(mesh);
  low_ = high_ = mesh.positions[mesh.triangles[0].x];
  for (const glm::uvec3& t : mesh.triangles) {
    for (int c = 0; c < 3; ++c) {
      low_ = glm::min(low_, glm::dvec3(mesh.positions[t[c]]));
      high_ = glm::max(high_, glm::dvec3(mesh.positions[t[c]]));
    }
  }

  Welded surface = weld(mesh, 0);
  Topology found = topology(surface);
  if (!found.fault.empty() || !found.borders.empty()) {  // dearer, so only where it may help
    surface = weld(mesh, kWeldTolerance * diagonal());
    found = topology(surface);
  }
  if (surface.triangles.empty()) throw refused(name_, "all its triangles are points or lines");
  if (!found.fault.empty()) throw refused(name_, found.fault);
  if (!found.borders.empty()) {
    if (holes == Holes::refuse) throw refused(name_, where_open(surface, found));
    for (const Border& border : found.borders)
      cap(surface, border);
    capped_holes_ = found.borders.size();
  }

  sources_ = std::move(surface.sources);
  tree_ = TriangleTree(std::move(surface.positions), std::move(surface.triangles));
  const glm::dvec3 middle = 0.5 * (low_ + high_);
  for (std::uint32_t i = 0; i < triangle_count(); ++i) {
    const auto t = tree_.corners(i);
    const glm::dvec3 normal = glm::cross(t[1] - t[0], t[2] - t[0]);
    const double length = glm::length(normal);
    centroids_.push_back((t[0] + t[1] + t[2]) / 3.0);
    facet_normals_.push_back(length > 0 ? normal / length : glm::dvec3(0.0, 1.0, 0.0));
    areas_.push_back(0.5 * length);
    volume_ += glm::dot(glm::cross(t[0] - middle, t[1] - middle), t[2] - middle) / 6.0;
    area_ += area(i);
  }
  const double least = 1e-9 * std::pow(diagonal(), 3);
  if (volume_ < -least) throw refused(name_, "it is inside out (its triangles run clockwise seen from outside)");
  if (volume_ < least) throw refused(name_, "it encloses no volume");
  const auto [a, b] = tree_.first_crossing();
  if (a != kNoTriangle)
    throw refused(name_,
                  fmt::format("it cuts itself, its triangles near {} and {}", place(centroid(a)), place(centroid(b))));

  normal_corners_.resize(triangle_count());
  for (std::uint32_t i = 0; i < triangle_count(); ++i) {
    if (sources_[i] != kCap) normal_corners_[i] = mesh.triangles[sources_[i]];
  }
  build_rays();
}

void Solid::build_rays() {
  std::vector<glm::vec3> positions;
  positions.reserve(tree_.positions().size());
  for (const glm::dvec3& p : tree_.positions())
    positions.emplace_back(p);
  device_ = embree::make_device();
  rays_ = embree::triangles_bvh(device_, positions, tree_.triangles(), name_);
}

std::optional<std::uint32_t> Solid::source(std::uint32_t triangle) const {
  if (sources_[triangle] == kCap) return std::nullopt;
  return sources_[triangle];
}

glm::dvec3 Solid::shading_normal(std::uint32_t triangle, const glm::dvec3& weights) const {
  const glm::dvec3 facet = facet_normal(triangle);
  if (sources_[triangle] == kCap || normals_.empty()) return facet;
  const glm::uvec3& corners = normal_corners_[triangle];
  const glm::dvec3 normal = weights.x * glm::dvec3(normals_[corners.x]) + weights.y * glm::dvec3(normals_[corners.y]) +
                            weights.z * glm::dvec3(normals_[corners.z]);
  const double length = glm::length(normal);
  if (!(length > 1e-6) || glm::dot(normal, facet) <= 0) return facet;  // a file's normals may point anywhere
  return normal / length;
}

std::optional<SurfaceHit> Solid::first_hit(const glm::dvec3& origin, const glm::dvec3& direction, double begin) const {
  const auto coarse = embree::nearest(rays_, {origin, direction, begin, std::numeric_limits<double>::infinity()});
  if (!coarse) return std::nullopt;

  SurfaceHit hit;
  hit.triangle = coarse->triangle;
  const auto t = tree_.corners(hit.triangle);
  const glm::dvec3 ab = t[1] - t[0], ac = t[2] - t[0], p = glm::cross(direction, ac);
  const double determinant = glm::dot(ab, p);
  double u = static_cast<double>(coarse->u), v = static_cast<double>(coarse->v);
  hit.distance = static_cast<double>(coarse->distance);
  if (std::abs(determinant) > 1e-9 * glm::length(ab) * glm::length(ac)) {
    const glm::dvec3 from_a = origin - t[0], q = glm::cross(from_a, ab);
    u = std::clamp(glm::dot(from_a, p) / determinant, 0.0, 1.0);
    v = std::clamp(glm::dot(direction, q) / determinant, 0.0, 1.0 - u);
    hit.distance = glm::dot(ac, q) / determinant;
  }
  hit.weights = {1.0 - u - v, u, v};
  hit.leaves = determinant < 0;  // (ab × ac)·direction > 0
  return hit;
}

bool Solid::contains(const glm::dvec3& point) const {
  if (glm::any(glm::lessThan(point, low_)) || glm::any(glm::lessThan(high_, point))) return false;
  static constexpr std::array<std::array<double, 3>, 5> kDirections{{{0.8017, 0.2673, 0.5345},
                                                                     {-0.6172, 0.7715, -0.1543},
                                                                     {0.1231, -0.4924, 0.8616},
                                                                     {-0.3370, -0.6740, -0.6574},
                                                                     {0.5571, 0.3714, -0.7428}}};
  int inside = 0;
  for (const auto& d : kDirections) {
    const auto hit = first_hit(point, glm::normalize(glm::dvec3(d[0], d[1], d[2])));
    inside += hit && hit->leaves ? 1 : -1;
  }
  return inside > 0;
}

bool Solid::sees(const glm::dvec3& inside, std::uint32_t triangle) const {
  const glm::dvec3 way = centroid(triangle) - inside;
  const double distance = glm::length(way);
  if (distance <= 0) return true;
  const double facing = glm::dot(way, facet_normal(triangle)) / distance;
  if (facing <= 0) return false;
  constexpr double kNear = 1e-5;  // before the centroid, as a share of the way
  // In single precision a ray meets the triangle itself that much too early where it grazes it.
  if (facing < 0.02) {
    const auto hit = first_hit(inside, way / distance);
    return hit && (hit->triangle == triangle || hit->distance >= distance * (1 - kNear));
  }
  return !blocked(inside, way, 1 - kNear);
}

bool Solid::blocked(const glm::dvec3& from, const glm::dvec3& way, double share) const {
  return embree::occluded(rays_, {from, way, 0, share});
}

}  // namespace pellucid::geocube
