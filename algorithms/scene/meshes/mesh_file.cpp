#include "algorithms/scene/meshes/mesh_file.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <limits>
#include <new>
#include <sstream>
#include <string>
#include <string_view>

#include <assimp/DefaultIOSystem.h>
#include <assimp/Importer.hpp>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>

#include "gl/error.hpp"

namespace pellucid {

namespace fs = std::filesystem;

namespace {

constexpr std::uintmax_t kMaxFileBytes = std::uintmax_t{1} << 31;

InputError unreadable(const fs::path& path, std::string_view reason) {
  return InputError(fmt::format("cannot read mesh '{}': {}", path.string(), reason));
}

/// Notes which files Assimp opens.
class NotingFiles : public Assimp::DefaultIOSystem {
 public:
  explicit NotingFiles(std::vector<fs::path>& opened) : opened_(opened) {}
  Assimp::IOStream* Open(const char* file, const char* mode) override {
    Assimp::IOStream* stream = DefaultIOSystem::Open(file, mode);
    const fs::path path(file);
    if (stream != nullptr && std::find(opened_.begin(), opened_.end(), path) == opened_.end()) opened_.push_back(path);
    return stream;
  }

 private:
  std::vector<fs::path>& opened_;
};

struct Counts {
  std::uint64_t vertices = 0;
  std::uint64_t faces = 0;
};

/// The lines of a text file that are neither empty nor comments.
class Lines {
 public:
  explicit Lines(const fs::path& path) : file_(path, std::ios::binary) {}
  bool next() {
    while (std::getline(file_, line_)) {
      const auto first = line_.find_first_not_of(" \t\r");
      if (first != std::string::npos && line_[first] != '#') return true;
    }
    return false;
  }
  const std::string& line() const { return line_; }

 private:
  std::ifstream file_;
  std::string line_;
};

void check_counts(const fs::path& path, const Counts& claimed, std::uintmax_t bytes) {
  if (claimed.faces > kMaxTriangles || claimed.vertices > 3 * kMaxTriangles) {
    throw unreadable(path, fmt::format("{} vertices and {} faces; at most {} triangles are read", claimed.vertices,
                                       claimed.faces, kMaxTriangles));
  }
  if (claimed.vertices + claimed.faces > bytes) {  // each takes a byte at the very least
    throw unreadable(path, fmt::format("its header claims {} vertices and {} faces, more than {} bytes can hold",
                                       claimed.vertices, claimed.faces, bytes));
  }
}

/// Assimp allocates by what the header claims before it reads on.
void check_ply(const fs::path& path, std::uintmax_t bytes) {
  Counts counts;
  Lines lines(path);
  for (int n = 0; n < 1000 && lines.next() && !lines.line().starts_with("end_header"); ++n) {
    std::istringstream words(lines.line());
    std::string word;
    std::string element;
    std::uint64_t count = 0;
    if (!(words >> word >> element >> count) || word != "element") continue;
    if (element == "vertex") counts.vertices = count;
    if (element == "face") counts.faces = count;
  }
  check_counts(path, counts, bytes);
}

/// Assimp also mends a face that names no vertex, and tells only its log.
void check_off(const fs::path& path, std::uintmax_t bytes) {
  Lines lines(path);
  Counts counts;
  std::istringstream words;
  const auto next_line = [&] {
    if (!lines.next()) return false;
    words = std::istringstream(lines.line());
    return true;
  };
  std::string keyword;
  bool sound = next_line() && words >> keyword && keyword.ends_with("OFF");
  sound = sound && (words >> counts.vertices || (next_line() && words >> counts.vertices)) && words >> counts.faces;
  if (!sound) throw unreadable(path, "malformed OFF header");
  check_counts(path, counts, bytes);
  for (std::uint64_t v = 0; v < counts.vertices; ++v) {
    if (!lines.next()) throw unreadable(path, fmt::format("it ends at vertex {} of {}", v, counts.vertices));
  }
  for (std::uint64_t f = 0; f < counts.faces; ++f) {
    if (!lines.next()) throw unreadable(path, fmt::format("it ends at face {} of {}", f, counts.faces));
    const char* at = lines.line().data();
    const char* end = at + lines.line().size();
    const auto read = [&](std::uint64_t& number) {
      while (at != end && (*at == ' ' || *at == '\t'))
        ++at;
      const auto [past, error] = std::from_chars(at, end, number);
      at = past;
      return error == std::errc{};
    };
    std::uint64_t corners = 0;
    bool good = read(corners);
    for (std::uint64_t c = 0; good && c < corners; ++c) {
      std::uint64_t vertex = 0;
      good = read(vertex) && vertex < counts.vertices;
    }
    if (!good) throw unreadable(path, fmt::format("face {} names a vertex that does not exist", f));
  }
}

void check_before_import(const fs::path& path, const std::string& kind) {
  static constexpr std::array<std::string_view, 6> kKinds = {".obj", ".ply", ".off", ".gltf", ".glb", ".3ds"};
  if (std::find(kKinds.begin(), kKinds.end(), kind) == kKinds.end()) {
    throw unreadable(path, fmt::format("'{}' is not one of {}", kind, fmt::join(kKinds, ", ")));
  }
  std::error_code error;
  const std::uintmax_t bytes = fs::file_size(path, error);
  if (error) throw unreadable(path, error.message());
  if (bytes == 0) throw unreadable(path, "the file is empty");
  if (bytes > kMaxFileBytes) throw unreadable(path, fmt::format("{} bytes; at most {} are read", bytes, kMaxFileBytes));
  if (kind == ".ply") check_ply(path, bytes);
  if (kind == ".off") check_off(path, bytes);
}

/// Appends the triangles of `node` and of all below it.
class Merger {
 public:
  Merger(const fs::path& path, const aiScene& scene, Mesh& mesh) : path_(path), scene_(scene), mesh_(mesh) {
    all_colored_ = all_mapped_ = all_normals_ = true;
    for (unsigned m = 0; m < scene.mNumMeshes; ++m) {
      all_colored_ = all_colored_ && scene.mMeshes[m]->HasVertexColors(0);
      all_mapped_ = all_mapped_ && scene.mMeshes[m]->HasTextureCoords(0);
      all_normals_ = all_normals_ && scene.mMeshes[m]->HasNormals();
    }
  }

  void add(const aiNode& node, const aiMatrix4x4& parent, int depth = 0) {
    if (depth > 256) throw unreadable(path_, "its nodes are nested too deeply");
    const aiMatrix4x4 to_mesh = parent * node.mTransformation;
    for (unsigned m = 0; m < node.mNumMeshes; ++m)
      add(*scene_.mMeshes[node.mMeshes[m]], to_mesh);
    for (unsigned c = 0; c < node.mNumChildren; ++c)
      add(*node.mChildren[c], to_mesh, depth + 1);
  }

 private:
  void add(const aiMesh& source, const aiMatrix4x4& to_mesh) {
    if (mesh_.triangles.size() + source.mNumFaces > kMaxTriangles ||
        mesh_.positions.size() + source.mNumVertices > 3 * kMaxTriangles) {
      throw unreadable(path_, fmt::format("more than {} triangles", kMaxTriangles));
    }
    const auto first = static_cast<unsigned>(mesh_.positions.size());
    const aiMatrix3x3 normal_to_mesh = aiMatrix3x3(to_mesh).Inverse().Transpose();
    for (unsigned v = 0; v < source.mNumVertices; ++v) {
      const aiVector3D p = to_mesh * source.mVertices[v];
      if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) {
        throw unreadable(path_, fmt::format("vertex {} is not finite", v));
      }
      mesh_.positions.emplace_back(p.x, p.y, p.z);
      if (all_normals_) {
        const aiVector3D n = normal_to_mesh * source.mNormals[v];
        const float length = n.Length();
        if (!std::isfinite(length) || !(length > 0)) {
          throw unreadable(path_, fmt::format("the normal of vertex {} has no direction", v));
        }
        mesh_.normals.emplace_back(n.x / length, n.y / length, n.z / length);
      }
      if (all_colored_) {
        const aiColor4D& c = source.mColors[0][v];
        mesh_.colors.emplace_back(c.r, c.g, c.b);
      }
      if (all_mapped_) mesh_.uvs.emplace_back(source.mTextureCoords[0][v].x, source.mTextureCoords[0][v].y);
    }
    for (unsigned f = 0; f < source.mNumFaces; ++f) {
      const aiFace& face = source.mFaces[f];
      if (face.mNumIndices != 3) continue;  // points and lines, which SortByPType leaves when nothing else is there
      for (unsigned i = 0; i < 3; ++i) {
        if (face.mIndices[i] >= source.mNumVertices) throw unreadable(path_, fmt::format("face {} names no vertex", f));
      }
      mesh_.triangles.emplace_back(first + face.mIndices[0], first + face.mIndices[1], first + face.mIndices[2]);
    }
  }

  const fs::path& path_;
  const aiScene& scene_;
  Mesh& mesh_;
  bool all_colored_ = false, all_mapped_ = false, all_normals_ = false;
};

}  // namespace

MeshFile load_mesh_file(const fs::path& path, double crease_deg) {
  std::string kind = path.extension().string();
  std::transform(kind.begin(), kind.end(), kind.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  check_before_import(path, kind);
  MeshFile result;
  try {
    Assimp::Importer importer;
    importer.SetIOHandler(new NotingFiles(result.files));  // NOLINT: the importer owns it
    importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
    const aiScene* scene =
        importer.ReadFile(path.string(), aiProcess_Triangulate | aiProcess_SortByPType |
                                             aiProcess_JoinIdenticalVertices | aiProcess_ValidateDataStructure);
    if (scene == nullptr) throw unreadable(path, importer.GetErrorString());
    if (scene->mRootNode == nullptr) throw unreadable(path, "it has no triangles");
    Merger(path, *scene, result.mesh).add(*scene->mRootNode, aiMatrix4x4());
  } catch (const std::bad_alloc&) {
    throw unreadable(path, "not enough memory");
  }
  if (result.mesh.triangles.empty()) throw unreadable(path, "it has no triangles");
  if (result.mesh.normals.empty()) make_normals(result.mesh, crease_deg);
  return result;
}

void fit_mesh(Mesh& mesh, double size_m) {
  glm::dvec3 low(std::numeric_limits<double>::infinity());
  glm::dvec3 high = -low;
  for (const glm::vec3& p : mesh.positions) {
    low = glm::min(low, glm::dvec3(p));
    high = glm::max(high, glm::dvec3(p));
  }
  const glm::dvec3 sides = high - low;
  const double longest = std::max({sides.x, sides.y, sides.z});
  if (!(longest > 0)) throw InputError("all its vertices are one point");
  const glm::dvec3 center = (low + high) / 2.0;
  for (glm::vec3& p : mesh.positions)
    p = glm::vec3((glm::dvec3(p) - center) * (size_m / longest));
}

}  // namespace pellucid
