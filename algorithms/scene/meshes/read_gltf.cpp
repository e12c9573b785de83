#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <set>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <glm/gtc/quaternion.hpp>

#include "algorithms/scene/meshes/gltf_file.hpp"
#include "algorithms/scene/meshes/mesh_file.hpp"
#include "algorithms/scene/meshes/raw_mesh.hpp"

/// The triangles of a glTF scene. Ours, because Assimp 5.2 reads what required extensions forbid it to, does not decode
/// URIs, and leaves mirrored nodes inside out.
namespace pellucid {

namespace fs = std::filesystem;
using nlohmann::json;

namespace {

/// The attributes of a primitive's vertices, in the mesh's space.
struct Vertices {
  std::vector<double> positions, normals, colors, uvs;
  std::size_t color_components = 3;
};

class GltfReader {
 public:
  explicit GltfReader(GltfFile file) : file_(std::move(file)) {}

  RawMesh read() {
    for (const json& node : root_nodes())
      add_node(node, glm::dmat4(1.0), 0);
    if (!all_colored_) {
      if (any_colored_) mesh_.warnings.emplace_back("only some of its vertices have colours; they are left out");
      mesh_.colors.clear();
    }
    if (!all_mapped_) mesh_.uvs.clear();
    if (!any_normal_) mesh_.normals.clear();
    if (left_out_ > 0)
      mesh_.warnings.push_back(fmt::format("{} primitives of points or lines are left out", left_out_));
    if (skinned_) mesh_.warnings.emplace_back("it is skinned; the mesh is read as it was bound");
    if (wrong_bounds_) mesh_.warnings.emplace_back("its positions are not within the bounds that it states");
    mesh_.files = file_.files();
    return std::move(mesh_);
  }

 private:
  /// The nodes of the default scene, else of the first; without scenes all nodes that are no children.
  json root_nodes() const {
    const json& document = file_.document();
    if (document.contains("scenes") && document["scenes"].is_array() && !document["scenes"].empty()) {
      const json& scene =
          file_.object("scenes", document.contains("scene") ? document["scene"] : json(0U), "the document");
      const auto nodes = scene.find("nodes");
      if (nodes == scene.end()) return json::array();
      if (!nodes->is_array()) file_.fail("a scene's nodes are no list");
      return *nodes;
    }
    std::set<std::size_t> children;
    json roots = json::array();
    const auto nodes = document.find("nodes");
    if (nodes == document.end() || !nodes->is_array()) return roots;
    for (const json& node : *nodes) {
      if (!node.is_object() || !node.contains("children") || !node["children"].is_array()) continue;
      for (const json& child : node["children"])
        if (child.is_number_unsigned()) children.insert(child.get<std::size_t>());
    }
    for (std::size_t i = 0; i < nodes->size(); ++i)
      if (!children.contains(i)) roots.push_back(i);
    return roots;
  }

  template <std::size_t N>
  std::array<double, N> numbers(const json& node, const char* key, std::array<double, N> otherwise) const {
    const auto found = node.find(key);
    if (found == node.end()) return otherwise;
    if (!found->is_array() || found->size() != N) file_.fail(fmt::format("a node's {} has not {} numbers", key, N));
    for (std::size_t i = 0; i < N; ++i) {
      if (!(*found)[i].is_number()) file_.fail(fmt::format("a node's {} has something that is no number", key));
      otherwise[i] = (*found)[i].template get<double>();
    }
    return otherwise;
  }

  glm::dmat4 transform(const json& node) const {
    if (node.contains("matrix")) {
      const auto m = numbers<16>(node, "matrix", {});
      glm::dmat4 matrix(1.0);
      for (int i = 0; i < 16; ++i)
        matrix[i / 4][i % 4] = m[static_cast<std::size_t>(i)];
      return matrix;
    }
    return composed(numbers<3>(node, "translation", {0, 0, 0}), numbers<4>(node, "rotation", {0, 0, 0, 1}),
                    numbers<3>(node, "scale", {1, 1, 1}));
  }

  /// Scaled, then turned by a quaternion, then moved.
  static glm::dmat4 composed(const std::array<double, 3>& t, const std::array<double, 4>& r,
                             const std::array<double, 3>& s) {
    glm::dmat4 matrix = glm::mat4_cast(glm::dquat(r[3], r[0], r[1], r[2]));
    for (int c = 0; c < 3; ++c)
      matrix[c] *= s[static_cast<std::size_t>(c)];
    matrix[3] = glm::dvec4(t[0], t[1], t[2], 1);
    return matrix;
  }

  /// Where the node's mesh stands: once, or as often as EXT_mesh_gpu_instancing says.
  std::vector<glm::dmat4> instances_of(const json& node, const glm::dmat4& to_mesh) const {
    const auto extensions = node.find("extensions");
    if (extensions == node.end() || !extensions->is_object() || !extensions->contains("EXT_mesh_gpu_instancing"))
      return {to_mesh};
    const json& instancing = (*extensions)["EXT_mesh_gpu_instancing"];
    if (!instancing.is_object() || !instancing.contains("attributes") || !instancing["attributes"].is_object())
      file_.fail("EXT_mesh_gpu_instancing has no attributes");
    const auto attribute = [&](const char* name, std::size_t components) {
      const json& attributes = instancing["attributes"];
      if (!attributes.contains(name)) return std::vector<double>();
      // Without data of its own a file of a few bytes could ask for a million copies of a mesh.
      if (!file_.object("accessors", attributes[name], name).contains("bufferView"))
        file_.fail(fmt::format("{} of EXT_mesh_gpu_instancing has no data", name));
      return file_.numbers(attributes[name], components, name);
    };
    const std::vector<double> t = attribute("TRANSLATION", 3), r = attribute("ROTATION", 4), s = attribute("SCALE", 3);
    const std::size_t count = std::max({t.size() / 3, r.size() / 4, s.size() / 3});
    if (count == 0) file_.fail("EXT_mesh_gpu_instancing has none of TRANSLATION, ROTATION and SCALE");
    if ((!t.empty() && t.size() != 3 * count) || (!r.empty() && r.size() != 4 * count) ||
        (!s.empty() && s.size() != 3 * count))
      file_.fail("the attributes of EXT_mesh_gpu_instancing are of different lengths");
    std::vector<glm::dmat4> all;
    all.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
      std::array<double, 3> move{0, 0, 0}, scale{1, 1, 1};
      std::array<double, 4> turn{0, 0, 0, 1};
      if (!t.empty()) std::copy_n(t.begin() + static_cast<std::ptrdiff_t>(3 * i), 3, move.begin());
      if (!s.empty()) std::copy_n(s.begin() + static_cast<std::ptrdiff_t>(3 * i), 3, scale.begin());
      if (!r.empty()) {
        // Stored as integers, a quaternion has a length of only about 1.
        const glm::dvec4 stored(r[4 * i], r[4 * i + 1], r[4 * i + 2], r[4 * i + 3]);
        if (!(glm::length(stored) > 0)) file_.fail(fmt::format("ROTATION {} of EXT_mesh_gpu_instancing is 0", i));
        for (int c = 0; c < 4; ++c)
          turn[static_cast<std::size_t>(c)] = stored[c] / glm::length(stored);
      }
      all.push_back(to_mesh * composed(move, turn, scale));
    }
    return all;
  }

  void add_node(const json& index, const glm::dmat4& parent, int depth) {
    if (depth > 256) file_.fail("its nodes are nested too deeply");
    const json& node = file_.object("nodes", index, depth == 0 ? "a scene" : "a node");
    if (!visited_.insert(index.get<std::size_t>()).second)
      file_.fail(fmt::format("node {} has two parents", index.dump()));
    const glm::dmat4 to_mesh = parent * transform(node);
    if (node.contains("mesh")) {
      const json& mesh = file_.object("meshes", node["mesh"], "a node");
      add_mesh(mesh, weights_of(node.contains("weights") ? node : mesh), instances_of(node, to_mesh));
    }
    skinned_ = skinned_ || node.contains("skin");
    if (!node.contains("children")) return;
    if (!node["children"].is_array()) file_.fail("a node's children are no list");
    for (const json& child : node["children"])
      add_node(child, to_mesh, depth + 1);
  }

  /// How much of each morph target a mesh takes (3.7.2.2); a node's weights come before its mesh's.
  std::vector<double> weights_of(const json& owner) const {
    std::vector<double> weights;
    if (!owner.contains("weights")) return weights;
    if (!owner["weights"].is_array()) file_.fail("weights is no list");
    for (const json& weight : owner["weights"]) {
      if (!weight.is_number()) file_.fail("a weight is no number");
      weights.push_back(weight.get<double>());
    }
    return weights;
  }

  void add_mesh(const json& mesh, const std::vector<double>& weights, const std::vector<glm::dmat4>& instances) {
    const auto primitives = mesh.find("primitives");
    if (primitives == mesh.end() || !primitives->is_array()) file_.fail("a mesh has no primitives");
    for (const json& primitive : *primitives)
      add_primitive(primitive, weights, instances);
  }

  Vertices vertices_of(const json& primitive) {
    const auto attributes = primitive.find("attributes");
    if (attributes == primitive.end() || !attributes->is_object() || !attributes->contains("POSITION"))
      file_.fail("a primitive has no positions");
    Vertices v;
    const json& a = *attributes;
    v.positions = file_.numbers(a["POSITION"], 3, "POSITION");
    check_bounds(a["POSITION"], v.positions);
    if (a.contains("NORMAL")) v.normals = file_.numbers(a["NORMAL"], 3, "NORMAL");
    if (a.contains("TEXCOORD_0")) v.uvs = file_.numbers(a["TEXCOORD_0"], 2, "TEXCOORD_0");
    if (a.contains("COLOR_0")) {
      v.color_components = file_.object("accessors", a["COLOR_0"], "COLOR_0").value("type", json()) == "VEC4" ? 4 : 3;
      v.colors = file_.numbers(a["COLOR_0"], v.color_components, "COLOR_0");
    }
    const std::size_t count = v.positions.size() / 3;
    if ((!v.normals.empty() && v.normals.size() / 3 != count) || (!v.uvs.empty() && v.uvs.size() / 2 != count) ||
        (!v.colors.empty() && v.colors.size() / v.color_components != count))
      file_.fail("a primitive's attributes are of different lengths");
    return v;
  }

  /// The bounds that the file states itself, within the rounding of a float.
  void check_bounds(const json& index, const std::vector<double>& positions) {
    const json& accessor = file_.object("accessors", index, "POSITION");
    if (!accessor.contains("min") || !accessor.contains("max") || accessor.value("normalized", json()) == true) return;
    const json &low = accessor["min"], &high = accessor["max"];
    if (!low.is_array() || !high.is_array() || low.size() != 3 || high.size() != 3) return;
    for (std::size_t i = 0; i < positions.size(); ++i) {
      if (!low[i % 3].is_number() || !high[i % 3].is_number()) return;
      const double least = low[i % 3].get<double>(), most = high[i % 3].get<double>();
      const double slack = 1e-5 * (std::abs(least) + std::abs(most)) + 1e-3 * (most - least);
      wrong_bounds_ = wrong_bounds_ || positions[i] < least - slack || positions[i] > most + slack;
    }
  }

  /// Adds the targets' displacements, each by its weight.
  void morph(const json& primitive, const std::vector<double>& weights, Vertices& v) const {
    const auto targets = primitive.find("targets");
    if (targets == primitive.end()) return;
    if (!targets->is_array()) file_.fail("a primitive's targets are no list");
    for (std::size_t i = 0; i < std::min(targets->size(), weights.size()); ++i) {
      const json& target = (*targets)[i];
      if (weights[i] == 0) continue;
      if (!target.is_object()) file_.fail("a morph target is no object");
      for (const auto& [name, values] : {std::pair("POSITION", &v.positions), std::pair("NORMAL", &v.normals)}) {
        if (!target.contains(name) || values->empty()) continue;
        const std::vector<double> moves = file_.numbers(target[name], 3, name);
        if (moves.size() != values->size()) file_.fail("a morph target has another number of vertices");
        for (std::size_t j = 0; j < moves.size(); ++j)
          (*values)[j] += weights[i] * moves[j];
      }
    }
  }

  void add_primitive(const json& primitive, const std::vector<double>& weights,
                     const std::vector<glm::dmat4>& instances) {
    if (!primitive.is_object()) file_.fail("a primitive is no object");
    const std::uint64_t mode = file_.integer(primitive, "mode", 4, "a primitive");
    if (mode < 4) {
      ++left_out_;
      return;
    }
    if (mode > 6) file_.fail(fmt::format("a primitive's mode is {}", mode));
    Vertices v = vertices_of(primitive);
    morph(primitive, weights, v);
    const std::size_t count = v.positions.size() / 3;
    std::vector<std::uint32_t> corners;
    if (primitive.contains("indices")) {
      corners = file_.indices(primitive["indices"]);
    } else {
      corners.resize(count);
      for (std::size_t i = 0; i < count; ++i)
        corners[i] = static_cast<std::uint32_t>(i);
    }
    for (const std::uint32_t corner : corners)
      if (corner >= count) file_.fail(fmt::format("a primitive names vertex {} of {}", corner, count));
    if (mode == 4 && corners.size() % 3 != 0) file_.fail(fmt::format("{} corners make no triangles", corners.size()));
    const std::size_t added = std::max({mode == 4 ? corners.size() / 3 : corners.size(), (count + 2) / 3, 1UL});
    const std::size_t used = std::max(mesh_.triangles.size(), (mesh_.positions.size() + 2) / 3);
    if (used > kMaxTriangles || added > (kMaxTriangles - used) / instances.size())
      file_.fail(fmt::format("more than {} triangles", kMaxTriangles));
    for (const glm::dmat4& to_mesh : instances) {
      const auto first = static_cast<std::uint32_t>(mesh_.positions.size());
      append(v, count, to_mesh);
      add_triangles(mode, corners, first, glm::determinant(glm::dmat3(to_mesh)) < 0);
    }
  }

  /// 3.7.2.1: strips turn every other triangle, fans share their first corner. 3.7.4: where the node mirrors, the
  /// winding turns over.
  void add_triangles(std::uint64_t mode, const std::vector<std::uint32_t>& corners, std::uint32_t first,
                     bool mirrored) {
    const std::size_t step = mode == 4 ? 3 : 1;
    for (std::size_t i = 0; i + 2 < corners.size(); i += step) {
      glm::uvec3 t(corners[i], corners[i + 1], corners[i + 2]);
      if (mode == 5 && i % 2 == 1) t = {corners[i], corners[i + 2], corners[i + 1]};
      if (mode == 6) t = {corners[i + 1], corners[i + 2], corners[0]};
      if (mode != 4 && (t.x == t.y || t.y == t.z || t.x == t.z)) continue;  // only turns the strip around
      if (mirrored) std::swap(t.y, t.z);
      mesh_.triangles.push_back(t + first);
    }
  }

  void append(const Vertices& v, std::size_t count, const glm::dmat4& to_mesh) {
    // Turned and stretched as the surface is, up to a length that is set to 1 later.
    const glm::dmat3 m(to_mesh);
    const glm::dmat3 cofactors(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1]));
    const double sign = glm::determinant(m) < 0 ? -1 : 1;
    for (std::size_t i = 0; i < count; ++i) {
      mesh_.positions.emplace_back(to_mesh *
                                   glm::dvec4(v.positions[3 * i], v.positions[3 * i + 1], v.positions[3 * i + 2], 1));
      glm::dvec3 normal(0.0);
      if (!v.normals.empty()) {
        normal = sign * (cofactors * glm::dvec3(v.normals[3 * i], v.normals[3 * i + 1], v.normals[3 * i + 2]));
        const double length = glm::length(normal);
        normal = length > 0 && std::isfinite(length) ? normal / length : glm::dvec3(0.0);
      }
      mesh_.normals.emplace_back(normal);
      mesh_.uvs.push_back(v.uvs.empty() ? glm::vec2(0.0F) : glm::vec2(v.uvs[2 * i], v.uvs[2 * i + 1]));
      glm::vec3& color = mesh_.colors.emplace_back(1.0F);
      for (int c = 0; c < 3 && !v.colors.empty(); ++c) {
        const double value = v.colors[v.color_components * i + static_cast<std::size_t>(c)];
        if (!(value >= 0 && value <= 1))
          file_.fail(fmt::format("vertex {} has a colour of {}, out of [0, 1]", i, value));
        color[c] = static_cast<float>(value);
      }
    }
    any_normal_ = any_normal_ || !v.normals.empty();
    all_mapped_ = all_mapped_ && !v.uvs.empty();
    any_colored_ = any_colored_ || !v.colors.empty();
    all_colored_ = all_colored_ && !v.colors.empty();
  }

  GltfFile file_;
  RawMesh mesh_;
  std::set<std::size_t> visited_;
  bool any_normal_ = false, all_mapped_ = true, all_colored_ = true, any_colored_ = false;
  bool skinned_ = false, wrong_bounds_ = false;
  std::size_t left_out_ = 0;
};

}  // namespace

RawMesh read_gltf(const fs::path& path, bool binary) {
  return GltfReader(GltfFile(path, mesh_bytes(path), binary)).read();
}

}  // namespace pellucid
