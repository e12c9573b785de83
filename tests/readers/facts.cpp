// Prints what the program's readers find in files, a line of JSON each; readers_test.py compares it with others.
#include <algorithm>
#include <cctype>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <glm/glm.hpp>
#include <nlohmann/json.hpp>

#include "algorithms/scene/images/picture_file.hpp"
#include "algorithms/scene/meshes/mesh_file.hpp"
#include "algorithms/scene/volumes/volume_file.hpp"
#include "gl/error.hpp"

namespace pellucid {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

json numbers(const glm::dvec3& v) {
  return {v.x, v.y, v.z};
}

json facts_of(const Image& image) {
  json sums = json::array(), weighted = json::array();
  for (int c = 0; c < image.channels; ++c) {
    double sum = 0, with_weights = 0;
    for (int y = 0; y < image.height; ++y) {
      for (int x = 0; x < image.width; ++x) {
        const double value = image.at(x, y)[c];
        sum += value;
        with_weights += value * static_cast<double>((static_cast<long>(y) * image.width + x) % 1009 + 1);
      }
    }
    sums.push_back(sum);
    weighted.push_back(with_weights);
  }
  return {{"size", {image.width, image.height}}, {"sum", sums}, {"weighted", weighted}};
}

json picture_facts(const fs::path& path) {
  const PictureFile file = read_picture(path, no_layer);
  json facts = facts_of(file.image);
  const auto corners = [](const PixelWindow& w) { return json{w.min_x, w.min_y, w.max_x, w.max_y}; };
  if (file.display_encoded) return facts;
  facts["data_window"] = corners(file.data_window);
  facts["display_window"] = corners(file.display_window);
  return facts;
}

json volume_facts(const fs::path& path) {
  const VolumeFile file = load_volume_file(path);
  double sum = 0, weighted = 0;
  for (std::size_t i = 0; i < file.voxels.size(); ++i) {
    sum += file.voxels[i];
    weighted += file.voxels[i] * static_cast<double>(i % 1009 + 1);
  }
  return {{"size", {file.size.x, file.size.y, file.size.z}},
          {"spacing", numbers(file.spacing)},
          {"range", {file.value_range.x, file.value_range.y}},
          {"sum", sum},
          {"weighted", weighted}};
}

json mesh_facts(const fs::path& path) {
  const MeshFile file = load_mesh_file(path, 60);
  glm::dvec3 low(1e300), high(-1e300), moment(0.0);  // moment: of the area
  double area = 0, volume = 0;
  for (const glm::uvec3& t : file.mesh.triangles) {
    const glm::dvec3 a(file.mesh.positions[t.x]), b(file.mesh.positions[t.y]), c(file.mesh.positions[t.z]);
    const double part = glm::length(glm::cross(b - a, c - a)) / 2;
    area += part;
    moment += part / 3 * (a + b + c + 3.0 * file.origin);
    volume += glm::dot(a, glm::cross(b, c)) / 6;
    for (const glm::dvec3& p : {a, b, c}) {
      low = glm::min(low, p + file.origin);
      high = glm::max(high, p + file.origin);
    }
  }
  return {{"triangles", file.mesh.triangles.size()},
          {"low", numbers(low)},
          {"high", numbers(high)},
          {"area", area},
          {"moment", numbers(moment)},
          {"volume", volume}};
}

json facts_of(const fs::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  const auto is_one_of = [&](const std::vector<std::string>& all) {
    return std::find(all.begin(), all.end(), extension) != all.end();
  };
  if (is_one_of({".exr", ".png"})) return picture_facts(path);
  return is_one_of({".vti", ".mhd", ".mha", ".nrrd", ".nhdr", ".inr"}) ? volume_facts(path) : mesh_facts(path);
}

}  // namespace
}  // namespace pellucid

int main(int argc, char** argv) {
  for (int i = 1; i < argc; ++i) {
    nlohmann::json facts;
    try {
      facts = pellucid::facts_of(argv[i]);
    } catch (const pellucid::InputError& error) {
      facts = {{"error", error.what()}};
    }
    fmt::print("{}\n", facts.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
  }
}
