#include "sandbox/commands/frame_options.hpp"

namespace pellucid::sandbox {

void add_frame_options(cli::App& app, FrameOptions& options) {
  app.add_option("scene", options.scene, "A scene's name (pellucid list scenes) or a .toml file")->required();
  app.add_option("-s,--set", options.settings, "name=value of a parameter, scene.name for the scene's own; repeatable")
      ->allow_extra_args(false);
  app.add_option("--view", options.view,
                 "A named view, the first without it; or a camera: [NAME:]eye=X,Y,Z:target=X,Y,Z:up=X,Y,Z:fov=DEGREES");
  app.add_option("--size", options.size, "WIDTHxHEIGHT in pixels")->capture_default_str();
  app.add_option("-o,--output", options.output, "out.exr (scene-linear floats) or out.png (display)")->required();
  app.add_option("--device", options.device, "EGL device (pellucid devices)");
  app.add_option("--exposure", options.display.exposure_ev, "Stops by which a PNG is brightened")
      ->check(cli::Range(-64.0, 64.0))
      ->capture_default_str();
  app.add_option("--display", options.display.display, "OpenColorIO display of a PNG; the config's default without it");
  app.add_option("--display-view", options.display.view, "OpenColorIO view of a PNG; the config's default without it");
  app.add_option("--look", options.display.look, "OpenColorIO look of a PNG; none without it");
  app.add_flag("--json", options.json, "Print what was done as JSON");
}

}  // namespace pellucid::sandbox
