// pellucid reproduce.
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "gl/error.hpp"
#include "sandbox/commands/commands.hpp"
#include "sandbox/reproduce/reproduce_file.hpp"
#include "sandbox/reproduce/reproduce_paper.hpp"

namespace pellucid::sandbox {
namespace {

struct ReproduceArguments {
  std::string what;
  std::filesystem::path folder;
  std::optional<int> device;
  std::optional<double> tolerance;
  bool preview = false;
  bool json = false;
};

int reproduce(const ReproduceArguments& options) {
  if (options.what.ends_with(".exr")) {
    if (options.preview) throw InputError("--preview is for papers; a file is made again at its own size");
    FileOptions file{.file = options.what, .folder = options.folder, .device = options.device, .json = options.json};
    if (options.tolerance) file.tolerance = *options.tolerance;
    return reproduce_file(file);
  }
  if (options.tolerance) throw InputError("--tolerance is for a file");
  std::error_code error;
  if (!options.what.ends_with(".toml") && std::filesystem::is_regular_file(options.what, error)) {
    throw InputError(fmt::format(
        "{}: only a paper's file (.toml) or an EXR, which knows what made it, can be made again", options.what));
  }
  return reproduce_papers({.what = options.what,
                           .folder = options.folder,
                           .device = options.device,
                           .preview = options.preview,
                           .json = options.json});
}

}  // namespace

void add_reproduce(cli::App& root, std::vector<Command>& commands) {
  auto options = std::make_shared<ReproduceArguments>();
  cli::App* app = root.add_subcommand("reproduce", "Make a paper's tables and figures again, or a picture");
  app->add_option("what", options->what,
                  "A paper (pellucid list papers) or all, a file of your own FILE.toml, or an EXR that pellucid render "
                  "or reference wrote")
      ->required();
  app->add_option("-o,--output", options->folder, "Folder of the results; made when missing")->required();
  app->add_flag("--preview", options->preview, "Fewer and smaller measurements: minutes instead of hours");
  app->add_option("--device", options->device, "EGL device (pellucid devices)");
  app->add_option(
         "--tolerance", options->tolerance,
         fmt::format("Largest difference of a channel that a file made again on the same device and commit may "
                     "show, else status 3; {} without it",
                     FileOptions{}.tolerance))
      ->check(cli::Range(0.0, 1e9));
  app->add_flag("--json", options->json, "Print what came out as JSON");
  app->footer(
      "A paper: its sweeps are measured, its tables, figures and pictures made, and DIR/index.html shows them all. "
      "What\n"
      "DIR holds already is kept, so the same command goes on where it was stopped. Status 1: a point failed.\n"
      "A file: it is rendered again into DIR from what it says of itself, and compared.\n"
      "Examples:\n"
      "  pellucid reproduce all --preview -o results\n"
      "  pellucid reproduce my.toml -o results\n"
      "  pellucid reproduce fog.exr -o again");
  commands.push_back({app, [options] { return reproduce(*options); }});
}

}  // namespace pellucid::sandbox
