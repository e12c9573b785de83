#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <type_traits>
#include <vector>

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>  // Debian 12
#endif
#include <fmt/format.h>
#include <tbb/blocked_range2d.h>
#include <tbb/parallel_for.h>

#include "algorithms/reference/reference.hpp"
#include "algorithms/reference/shading.hpp"
#include "gl/error.hpp"

namespace pellucid {
namespace {

struct ReleaseDevice {
  void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
};
struct ReleaseScene {
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
using DeviceHandle = std::unique_ptr<std::remove_pointer_t<RTCDevice>, ReleaseDevice>;
using SceneHandle = std::unique_ptr<std::remove_pointer_t<RTCScene>, ReleaseScene>;

void check_embree(RTCDevice device, const char* doing) {
  const RTCError error = rtcGetDeviceError(device);
  if (error != RTC_ERROR_NONE) {
    throw RuntimeError(fmt::format("Embree failed while {} (error {})", doing, static_cast<int>(error)));
  }
}

struct Hit {
  const Instance* instance = nullptr;  // null: nothing was hit
  glm::uvec3 triangle{0};
  glm::dvec3 weights{0.0};  // barycentric
  double distance = std::numeric_limits<double>::infinity();
};

// One bounding-volume hierarchy for each mesh and one over their instances.
class Geometry {
 public:
  explicit Geometry(const Scene& scene) : scene_(&scene), device_(rtcNewDevice(nullptr)) {
    if (!device_) throw RuntimeError("Embree gives no device on this machine");
    meshes_.resize(scene.meshes.size());
    root_.reset(rtcNewScene(device_.get()));
    rtcSetSceneFlags(root_.get(), RTC_SCENE_FLAG_ROBUST);
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
      const Instance& instance = scene.instances[i];
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

  Hit intersect(const glm::dvec3& origin, const glm::dvec3& direction, double begin, double end) const {
    RTCRayHit query{};
    query.ray.org_x = static_cast<float>(origin.x);
    query.ray.org_y = static_cast<float>(origin.y);
    query.ray.org_z = static_cast<float>(origin.z);
    query.ray.dir_x = static_cast<float>(direction.x);
    query.ray.dir_y = static_cast<float>(direction.y);
    query.ray.dir_z = static_cast<float>(direction.z);
    query.ray.tnear = static_cast<float>(begin);
    query.ray.tfar = static_cast<float>(end);
    query.ray.mask = ~0U;
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

    Hit hit;
    hit.instance = &scene_->instances[query.hit.instID[0]];
    const Mesh& mesh = scene_->meshes[static_cast<std::size_t>(hit.instance->mesh)];
    hit.triangle = mesh.triangles[query.hit.primID];
    refine(hit, mesh, origin, direction, query);
    return hit;
  }

 private:
  SceneHandle build(const Mesh& mesh) const {
    SceneHandle result(rtcNewScene(device_.get()));
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

  // Embree finds the triangle in single precision; where the ray meets it is solved again in double.
  static void refine(Hit& hit, const Mesh& mesh, const glm::dvec3& origin, const glm::dvec3& direction,
                     const RTCRayHit& query) {
    const glm::dmat4 to_world(hit.instance->to_world);
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

  const Scene* scene_;
  DeviceHandle device_;
  std::vector<SceneHandle> meshes_;  // null where no instance uses the mesh
  SceneHandle root_;
};

glm::dvec3 interpolate(const std::vector<glm::vec3>& values, const Hit& hit) {
  return hit.weights.x * glm::dvec3(values[hit.triangle.x]) + hit.weights.y * glm::dvec3(values[hit.triangle.y]) +
         hit.weights.z * glm::dvec3(values[hit.triangle.z]);
}

glm::dvec3 shade(const Scene& scene, const Illumination& light, const Hit& hit, const glm::dvec3& origin,
                 const glm::dvec3& direction) {
  const Instance& instance = *hit.instance;
  const Mesh& mesh = scene.meshes[static_cast<std::size_t>(instance.mesh)];
  const Material& material = scene.materials[static_cast<std::size_t>(instance.material)];
  const glm::dmat3 normal_to_world = glm::transpose(glm::inverse(glm::dmat3(instance.to_world)));
  glm::dvec3 normal = glm::normalize(normal_to_world * interpolate(mesh.normals, hit));
  if (glm::dot(normal, direction) > 0.0) normal = -normal;
  glm::dvec3 albedo = glm::dvec3(material.albedo) * glm::dvec3(instance.tint);
  if (!mesh.colors.empty()) albedo *= interpolate(mesh.colors, hit);
  return light.surface_radiance(origin + hit.distance * direction, normal, albedo, glm::dvec3(material.emission));
}

}  // namespace

SurfaceLayer trace_surfaces(const Scene& scene, const Camera& camera) {
  assert(camera.width > 0 && camera.height > 0);
  const Geometry geometry(scene);
  const Illumination light(scene);
  SurfaceLayer layer;
  layer.radiance = Image(camera.width, camera.height, 3);
  layer.distance_m.resize(static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height));
  const glm::dvec3 origin(camera.view.eye);
  const glm::dvec3 forward = glm::normalize(glm::dvec3(camera.view.target) - origin);

  tbb::parallel_for(tbb::blocked_range2d<int>(0, camera.height, 16, 0, camera.width, 64), [&](const auto& tile) {
    for (int y = tile.rows().begin(); y < tile.rows().end(); ++y) {
      for (int x = tile.cols().begin(); x < tile.cols().end(); ++x) {
        const glm::dvec3 direction = camera.ray_direction(x + 0.5, y + 0.5);
        // The clipping planes are at constant view depth.
        const double per_depth = 1.0 / glm::dot(direction, forward);
        const Hit hit = geometry.intersect(origin, direction, static_cast<double>(camera.view.near_m) * per_depth,
                                           static_cast<double>(camera.view.far_m) * per_depth);
        const glm::dvec3 radiance = hit.instance != nullptr
                                        ? shade(scene, light, hit, origin, direction)
                                        : glm::dvec3(scene.environment.radiance(glm::vec3(direction)));
        float* pixel = layer.radiance.at(x, y);
        for (int c = 0; c < 3; ++c)
          pixel[c] = static_cast<float>(radiance[c]);
        layer.distance_m[static_cast<std::size_t>(y) * static_cast<std::size_t>(camera.width) +
                         static_cast<std::size_t>(x)] = hit.distance;
      }
    }
  });
  return layer;
}

}  // namespace pellucid
