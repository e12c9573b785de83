#include "sandbox/commands/scene_facts.hpp"

#include <fmt/format.h>

namespace pellucid::sandbox {
namespace {

/// A volume that is no file's has the range [0, 1], which says nothing.
bool from_file(const Volume& volume) {
  return volume.file_range != glm::vec2(0.0F, 1.0F);
}

}  // namespace

nlohmann::ordered_json volume_json(const Scene& scene) {
  if (!scene.volume) return nullptr;
  const Volume& volume = *scene.volume;
  const glm::vec3 spacing = volume.voxel_spacing_m();
  nlohmann::ordered_json out{{"voxels", {volume.size.x, volume.size.y, volume.size.z}},
                             {"voxel_spacing_m", {spacing.x, spacing.y, spacing.z}},
                             {"extinction_per_m", volume.extinction},
                             {"file_range", nullptr}};
  if (from_file(volume)) out["file_range"] = {volume.file_range.x, volume.file_range.y};
  return out;
}

std::string volume_text(const Scene& scene) {
  if (!scene.volume) return "";
  const Volume& volume = *scene.volume;
  const glm::vec3 spacing = volume.voxel_spacing_m();
  std::string text =
      fmt::format("{}×{}×{} voxels of {:.3g} × {:.3g} × {:.3g} m, extinction {:.4g} 1/m at density 1", volume.size.x,
                  volume.size.y, volume.size.z, spacing.x, spacing.y, spacing.z, volume.extinction);
  if (from_file(volume)) {
    text += fmt::format("; {:.6g} in the file is density 0, {:.6g} is 1", volume.file_range.x, volume.file_range.y);
  }
  return text;
}

}  // namespace pellucid::sandbox
