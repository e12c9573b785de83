#include "sandbox/commands/frame_options.hpp"

#include "sweeps/spec/provenance.hpp"

namespace pellucid::sandbox {

using nlohmann::ordered_json;

void add_frame_options(cli::App& app, FrameOptions& options) {
  app.add_option("scene", options.scene, "A scene's name (pellucid list scenes) or a .toml file")->required();
  app.add_option("-s,--set", options.settings, "name=value of a parameter, scene.name for the scene's own; repeatable")
      ->allow_extra_args(false);
  app.add_option("--view", options.view, "A named view; the first without it");
  app.add_option("--size", options.size, "WIDTHxHEIGHT in pixels")->capture_default_str();
  app.add_option("-o,--output", options.output, "out.exr (scene-linear half) or out.png (display)")->required();
  app.add_option("--device", options.device, "EGL device (pellucid devices)");
  app.add_option("--exposure", options.display.exposure_ev, "Stops by which a PNG is brightened")
      ->capture_default_str();
  app.add_option("--display", options.display.display, "OpenColorIO display of a PNG; the config's default without it");
  app.add_option("--display-view", options.display.view, "OpenColorIO view of a PNG; the config's default without it");
  app.add_flag("--json", options.json, "Print what was done as JSON");
}

ordered_json file_provenance() {
  return {{"version", PELLUCID_VERSION},
          {"commit", sweeps::kCommit},
          {"dirty", sweeps::kDirty},
          {"started_utc", sweeps::utc_text(sweeps::unix_now_s())},
          {"argv", process_arguments()}};
}

Attributes file_attributes(const char* command, const ordered_json& recipe, const ordered_json& origin) {
  return {{"pellucid.command", command}, {"pellucid.recipe", recipe.dump()}, {"pellucid.provenance", origin.dump()}};
}

}  // namespace pellucid::sandbox
