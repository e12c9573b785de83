#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "algorithms/scene/files/tell.hpp"
#include "gl/display/display.hpp"
#include "gl/error.hpp"
#include "sandbox/commands/command_line.hpp"
#include "sandbox/commands/commands.hpp"

using namespace pellucid;

namespace {

/// Output that nobody received is a failure (a full disk behind a redirection).
void check_standard_output() {
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
    throw RuntimeError(fmt::format("cannot write to standard output: {}", std::strerror(errno)));
  }
}

}  // namespace

int main(int argc, char** argv) {
  gl::on_display_warning([](const std::string& line) { tell("warning: {}", line); });
  sandbox::cli::CommandLine command_line(
      "pellucid", "Pellucid: a research sandbox for real-time transparency, translucency and scattering",
      PELLUCID_VERSION);
  sandbox::cli::App& root = command_line.root();
  std::vector<sandbox::Command> commands;
  sandbox::add_list(root, commands);
  sandbox::add_render(root, commands);
  sandbox::add_reference(root, commands);
  sandbox::add_compare(root, commands);
  sandbox::add_sweep(root, commands);
  sandbox::add_results(root, commands);
  sandbox::add_bench(root, commands);
  sandbox::add_slab(root, commands);
  sandbox::add_plot(root, commands);
  sandbox::add_reproduce(root, commands);
  sandbox::add_bundle(root, commands);
  sandbox::add_view(root, commands);

  try {
    if (const std::optional<int> status = command_line.parse(argc, argv)) return *status;
    for (const sandbox::Command& command : commands) {
      if (!command.app->parsed()) continue;
      const int status = command.run();
      check_standard_output();
      return status;
    }
  } catch (const InputError& e) {
    tell("error: {}", e.what());
    return sandbox::kBadInput;
  } catch (const std::exception& e) {
    // fmt says only "file" when standard output takes no more.
    const std::string words = std::ferror(stdout) != 0 ? "cannot write to standard output" : e.what();
    tell("error: {}", words);
    return sandbox::kFailed;
  }
  return sandbox::kBadInput;
}
