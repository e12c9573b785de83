#include "sandbox/commands/scene_facts.hpp"

#include <fmt/format.h>

#include "algorithms/scene/files/tell.hpp"
#include "algorithms/scene/loading_facts.hpp"
#include "sandbox/arguments.hpp"

namespace pellucid::sandbox {

nlohmann::ordered_json volume_json(const Scene& scene) {
  if (!scene.volume) return nullptr;
  const Volume& volume = *scene.volume;
  const glm::vec3 spacing = volume.voxel_spacing_m();
  nlohmann::ordered_json out{{"voxels", {volume.size.x, volume.size.y, volume.size.z}},
                             {"voxel_spacing_m", {spacing.x, spacing.y, spacing.z}},
                             {"extinction_per_m", volume.extinction},
                             {"file_range", nullptr}};
  if (const auto& range = loading_facts(scene).file_range) out["file_range"] = {range->x, range->y};
  return out;
}

std::string volume_text(const Scene& scene) {
  if (!scene.volume) return "";
  const Volume& volume = *scene.volume;
  const glm::vec3 spacing = volume.voxel_spacing_m();
  std::string text =
      fmt::format("{}×{}×{} voxels of {:.3g} × {:.3g} × {:.3g} m, extinction {:.4g} 1/m at density 1", volume.size.x,
                  volume.size.y, volume.size.z, spacing.x, spacing.y, spacing.z, volume.extinction);
  if (const auto& range = loading_facts(scene).file_range)
    text += fmt::format("; {} in the file is density 0, {} is 1", range->x, range->y);
  return text;
}

void check_output_is_no_input(const std::filesystem::path& output, const Scene& scene) {
  for (const std::filesystem::path& file : loading_facts(scene).files)
    check_no_input(output, file, "-o");
}

void print_warnings(const Scene& scene) {
  for (const std::string& warning : loading_facts(scene).warnings)
    tell("warning: {}", warning);
}

}  // namespace pellucid::sandbox
