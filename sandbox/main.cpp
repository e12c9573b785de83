#include <cstdio>
#include <exception>

#include <fmt/format.h>

#include "gl/error.hpp"
#include "sandbox/commands/commands.hpp"

using namespace pellucid;

int main(int argc, char** argv) {
  CLI::App root{"Pellucid: a research sandbox for real-time transparency, translucency and scattering", "pellucid"};
  root.set_version_flag("--version", PELLUCID_VERSION);
  root.require_subcommand(1);
  root.fallthrough(false);

  std::vector<sandbox::Command> commands;
  sandbox::add_list(root, commands);
  sandbox::add_render(root, commands);
  sandbox::add_compare(root, commands);
  sandbox::add_sweep(root, commands);
  sandbox::add_results(root, commands);
  sandbox::add_plot(root, commands);
  sandbox::add_reproduce(root, commands);

  try {
    root.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    // CLI11 prints help and version with status 0; everything else is bad usage.
    if (e.get_exit_code() == 0) return root.exit(e);
    fmt::print(stderr, "error: {}\n", e.what());
    return sandbox::kBadInput;
  }

  try {
    for (const sandbox::Command& command : commands) {
      if (command.app->parsed()) return command.run();
    }
  } catch (const InputError& e) {
    fmt::print(stderr, "error: {}\n", e.what());
    return sandbox::kBadInput;
  } catch (const std::exception& e) {
    fmt::print(stderr, "error: {}\n", e.what());
    return sandbox::kFailed;
  }
  return sandbox::kBadInput;
}
