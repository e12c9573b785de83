#include "algorithms/reference/geometry.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>  // Debian 12
#endif
#include <fmt/format.h>

#include "gl/error.hpp"

namespace pellucid {
namespace {

// A ray that leaves a surface sets out this far above it, as a share of its largest coordinate: some ten roundings of
// the single precision in which Embree takes it. Only the neighbours of its triangle need that; the triangle itself is
// left out by name.
constexpr double kClearance = 1e-6;

void check_embree(RTCDevice device, const char* doing) {
  const RTCError error = rtcGetDeviceError(device);
  if (error != RTC_ERROR_NONE) {
    throw RuntimeError(fmt::format("Embree failed while {} (error {})", doing, static_cast<int>(error)));
  }
}

void set_ray(RTCRay& ray, const glm::dvec3& origin, const glm::dvec3& direction, double begin, double end) {
  ray.org_x = static_cast<float>(origin.x);
  ray.org_y = static_cast<float>(origin.y);
  ray.org_z = static_cast<float>(origin.z);
  ray.dir_x = static_cast<float>(direction.x);
  ray.dir_y = static_cast<float>(direction.y);
  ray.dir_z = static_cast<float>(direction.z);
  ray.tnear = static_cast<float>(begin);
  ray.tfar = static_cast<float>(end);
  ray.mask = ~0U;
}

// Embree finds the triangle in single precision; where the ray meets it is solved again in double.
void refine(Hit& hit, const Mesh& mesh, const glm::dmat4& to_world, const glm::dvec3& origin,
            const glm::dvec3& direction, const RTCRayHit& query) {
  const auto corner = [&](int i) {
    return glm::dvec3(to_world * glm::dvec4(glm::dvec3(mesh.positions[hit.triangle[i]]), 1.0));
  };
  const glm::dvec3 a = corner(0), ab = corner(1) - a, ac = corner(2) - a;
  const glm::dvec3 p = glm::cross(direction, ac);
  const double determinant = glm::dot(ab, p);
  const double scale = glm::length(ab) * glm::length(ac);
  if (std::abs(determinant) > 1e-9 * scale) {
    const glm::dvec3 from_a = origin - a, q = glm::cross(from_a, ab);
    const double u = glm::dot(from_a, p) / determinant, v = glm::dot(direction, q) / determinant;
    hit.weights = {1.0 - u - v, u, v};
    hit.distance = glm::dot(ac, q) / determinant;
  } else {  // edge-on: nothing to gain
    const double u = static_cast<double>(query.hit.u), v = static_cast<double>(query.hit.v);
    hit.weights = {1.0 - u - v, u, v};
    hit.distance = static_cast<double>(query.ray.tfar);
  }
}

}  // namespace

void Geometry::Release::operator()(RTCDeviceTy* device) const {
  rtcReleaseDevice(device);
}

void Geometry::Release::operator()(RTCSceneTy* scene) const {
  rtcReleaseScene(scene);
}

Geometry::Geometry(const Scene& scene, const std::function<bool(int)>& included)
    : scene_(&scene), device_(rtcNewDevice(nullptr)) {
  if (!device_) throw RuntimeError("Embree gives no device on this machine");
  meshes_.resize(scene.meshes.size());
  root_.reset(rtcNewScene(device_.get()));
  rtcSetSceneFlags(root_.get(), RTC_SCENE_FLAG_ROBUST);
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const Instance& instance = scene.instances[i];
    to_world_.emplace_back(instance.to_world);
    normals_.push_back(glm::transpose(glm::inverse(glm::dmat3(instance.to_world))));
    if (included && !included(static_cast<int>(i))) continue;
    const auto mesh = static_cast<std::size_t>(instance.mesh);
    if (scene.meshes[mesh].triangles.empty()) continue;
    if (!meshes_[mesh]) meshes_[mesh] = build(scene.meshes[mesh]);
    RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(geometry, meshes_[mesh].get());
    rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR, &instance.to_world[0][0]);
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(root_.get(), geometry, static_cast<unsigned>(i));
    rtcReleaseGeometry(geometry);
  }
  rtcCommitScene(root_.get());
  check_embree(device_.get(), "building the scene");
}

Geometry::Bvh Geometry::build(const Mesh& mesh) const {
  Bvh result(rtcNewScene(device_.get()));
  rtcSetSceneFlags(result.get(), RTC_SCENE_FLAG_ROBUST);
  RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
  // Embree's own buffers are padded as it needs; the mesh's vectors are not.
  void* vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(glm::vec3),
                                           mesh.positions.size());
  void* indices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, sizeof(glm::uvec3),
                                          mesh.triangles.size());
  if (vertices == nullptr || indices == nullptr) {
    rtcReleaseGeometry(geometry);
    throw RuntimeError(fmt::format("Embree has no memory for mesh '{}'", mesh.name));
  }
  std::copy(mesh.positions.begin(), mesh.positions.end(), static_cast<glm::vec3*>(vertices));
  std::copy(mesh.triangles.begin(), mesh.triangles.end(), static_cast<glm::uvec3*>(indices));
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(result.get(), geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(result.get());
  check_embree(device_.get(), "building a mesh");
  return result;
}

Hit Geometry::nearest(const glm::dvec3& embree_origin, const glm::dvec3& origin, const glm::dvec3& direction,
                      double begin, double end, float* met_at) const {
  RTCRayHit query{};
  set_ray(query.ray, embree_origin, direction, begin, end);
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
#if RTC_VERSION_MAJOR >= 4
  rtcIntersect1(root_.get(), &query);
#else
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(root_.get(), &context, &query);
#endif
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};

  if (met_at != nullptr) *met_at = query.ray.tfar;
  Hit hit;
  const std::size_t index = query.hit.instID[0];
  hit.index = static_cast<int>(index);
  hit.instance = &scene_->instances[index];
  const Mesh& mesh = scene_->meshes[static_cast<std::size_t>(hit.instance->mesh)];
  hit.primitive = query.hit.primID;
  hit.triangle = mesh.triangles[query.hit.primID];
  refine(hit, mesh, to_world_[index], origin, direction, query);
  return hit;
}

Hit Geometry::intersect(const glm::dvec3& origin, const glm::dvec3& direction, double begin, double end) const {
  return nearest(origin, origin, direction, begin, end);
}

Hit Geometry::intersect_from(const glm::dvec3& start, const Hit& from, const glm::dvec3& face,
                             const glm::dvec3& direction) const {
  const glm::dvec3 size = glm::abs(start);
  const glm::dvec3 raised = start + kClearance * std::max({size.x, size.y, size.z}) * face;
  float begin = 0.0F, met_at = 0.0F;
  for (;;) {
    Hit hit =
        nearest(raised, start, direction, static_cast<double>(begin), std::numeric_limits<double>::infinity(), &met_at);
    if (hit.instance == nullptr) return hit;
    if (hit.index != from.index || hit.primitive != from.primitive) {
      hit.distance = std::max(hit.distance, 0.0);
      return hit;
    }
    // Rounding in a large triangle. Embree takes numbers below the normal ones for 0.
    begin = std::nextafter(std::max(met_at, std::numeric_limits<float>::min()), std::numeric_limits<float>::infinity());
  }
}

bool Geometry::occluded(const glm::dvec3& origin, const glm::dvec3& direction, double begin, double end) const {
  RTCRay ray{};
  set_ray(ray, origin, direction, begin, end);
#if RTC_VERSION_MAJOR >= 4
  rtcOccluded1(root_.get(), &ray);
#else
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(root_.get(), &context, &ray);
#endif
  return ray.tfar < 0.0F;  // Embree's mark of a hit
}

}  // namespace pellucid
