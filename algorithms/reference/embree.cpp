#include "algorithms/reference/embree.hpp"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <span>
#include <string>

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>  // Debian 12
#endif
#include <fmt/format.h>

#include "gl/error.hpp"

namespace pellucid::embree {
namespace {

void check(const Device& device, const char* doing) {
  const RTCError error = rtcGetDeviceError(device.get());
  if (error != RTC_ERROR_NONE)
    throw RuntimeError(fmt::format("Embree failed while {} (error {})", doing, static_cast<int>(error)));
}

RTCRay in_single_precision(const Ray& from) {
  RTCRay ray{};
  ray.org_x = static_cast<float>(from.origin.x);
  ray.org_y = static_cast<float>(from.origin.y);
  ray.org_z = static_cast<float>(from.origin.z);
  ray.dir_x = static_cast<float>(from.direction.x);
  ray.dir_y = static_cast<float>(from.direction.y);
  ray.dir_z = static_cast<float>(from.direction.z);
  ray.tnear = static_cast<float>(from.begin);
  ray.tfar = static_cast<float>(from.end);
  ray.mask = ~0U;
  return ray;
}

// Embree 4 asks for no context.
#if RTC_VERSION_MAJOR >= 4
void intersect(RTCScene scene, RTCRayHit& query) {
  rtcIntersect1(scene, &query);
}
void occlude(RTCScene scene, RTCRay& ray) {
  rtcOccluded1(scene, &ray);
}
#else
void intersect(RTCScene scene, RTCRayHit& query) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(scene, &context, &query);
}
void occlude(RTCScene scene, RTCRay& ray) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(scene, &context, &ray);
}
#endif

}  // namespace

void Release::operator()(RTCDeviceTy* device) const {
  rtcReleaseDevice(device);
}

void Release::operator()(RTCSceneTy* scene) const {
  rtcReleaseScene(scene);
}

Device make_device() {
  Device device(rtcNewDevice(nullptr));
  if (!device) throw RuntimeError("Embree gives no device on this machine");
  return device;
}

Bvh empty_bvh(const Device& device) {
  Bvh bvh(rtcNewScene(device.get()));
  rtcSetSceneFlags(bvh.get(), RTC_SCENE_FLAG_ROBUST);
  return bvh;
}

Bvh triangles_bvh(const Device& device, std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles,
                  const std::string& name) {
  Bvh bvh = empty_bvh(device);
  RTCGeometry geometry = rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
  // Embree's own buffers are padded as it needs; the mesh's vectors are not.
  void* vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(glm::vec3),
                                           positions.size());
  void* indices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, sizeof(glm::uvec3),
                                          triangles.size());
  if (vertices == nullptr || indices == nullptr) {
    rtcReleaseGeometry(geometry);
    throw RuntimeError(fmt::format("Embree has no memory for mesh '{}'", name));
  }
  std::copy(positions.begin(), positions.end(), static_cast<glm::vec3*>(vertices));
  std::copy(triangles.begin(), triangles.end(), static_cast<glm::uvec3*>(indices));
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(bvh.get(), geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(bvh.get());
  check(device, "building a mesh");
  return bvh;
}

void add_instance(const Device& device, const Bvh& to, const Bvh& of, const glm::mat4& to_world, unsigned number) {
  RTCGeometry geometry = rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_INSTANCE);
  rtcSetGeometryInstancedScene(geometry, of.get());
  rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR, &to_world[0][0]);
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(to.get(), geometry, number);
  rtcReleaseGeometry(geometry);
}

void finish(const Device& device, const Bvh& bvh) {
  rtcCommitScene(bvh.get());
  check(device, "building the scene");
}

std::optional<Hit> nearest(const Bvh& bvh, const Ray& ray) {
  RTCRayHit query{};
  query.ray = in_single_precision(ray);
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  intersect(bvh.get(), query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  return Hit{query.hit.instID[0], query.hit.primID, query.ray.tfar, query.hit.u, query.hit.v};
}

bool occluded(const Bvh& bvh, const Ray& from) {
  RTCRay ray = in_single_precision(from);
  occlude(bvh.get(), ray);
  return ray.tfar < 0.0F;  // Embree's mark of a hit
}

}  // namespace pellucid::embree
