#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "algorithms/parameters.hpp"
#include "gl/error.hpp"
#include "sandbox/commands/commands.hpp"

using namespace pellucid;

namespace {

/// CLI11 says of a mistyped command only that one is required.
void check_command_words(const CLI::App& app, int argc, char** argv, int at) {
  const auto subcommands = app.get_subcommands([](const CLI::App*) { return true; });
  if (at >= argc || argv[at][0] == '-' || subcommands.empty()) return;
  std::vector<std::string> names;
  for (const CLI::App* subcommand : subcommands) {
    if (subcommand->check_name(argv[at])) return check_command_words(*subcommand, argc, argv, at + 1);
    if (!subcommand->get_group().empty()) names.push_back(subcommand->get_name());  // hidden ones have no group
  }
  const std::string near = nearest_name(argv[at], names);
  throw InputError(near.empty() ? fmt::format("unknown command '{}'; there are {}", argv[at], fmt::join(names, ", "))
                                : fmt::format("unknown command '{}'; did you mean '{}'?", argv[at], near));
}

/// Output that nobody received is a failure (a full disk behind a redirection).
void check_standard_output() {
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
    throw RuntimeError(fmt::format("cannot write to standard output: {}", std::strerror(errno)));
  }
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App root{"Pellucid: a research sandbox for real-time transparency, translucency and scattering", "pellucid"};
  root.set_version_flag("--version", PELLUCID_VERSION);
  root.require_subcommand(1);
  root.fallthrough(false);

  std::vector<sandbox::Command> commands;
  sandbox::add_list(root, commands);
  sandbox::add_render(root, commands);
  sandbox::add_reference(root, commands);
  sandbox::add_compare(root, commands);
  sandbox::add_sweep(root, commands);
  sandbox::add_results(root, commands);
  sandbox::add_bench(root, commands);
  sandbox::add_plot(root, commands);
  sandbox::add_reproduce(root, commands);
  sandbox::add_bundle(root, commands);

  try {
    check_command_words(root, argc, argv, 1);
    root.parse(argc, argv);
  } catch (const InputError& e) {
    fmt::print(stderr, "error: {}\n", e.what());
    return sandbox::kBadInput;
  } catch (const CLI::ParseError& e) {
    // CLI11 prints help and version with status 0; everything else is bad usage.
    if (e.get_exit_code() == 0) return root.exit(e);
    fmt::print(stderr, "error: {}\n", e.what());
    return sandbox::kBadInput;
  }

  try {
    for (const sandbox::Command& command : commands) {
      if (!command.app->parsed()) continue;
      const int status = command.run();
      check_standard_output();
      return status;
    }
  } catch (const InputError& e) {
    fmt::print(stderr, "error: {}\n", e.what());
    return sandbox::kBadInput;
  } catch (const std::exception& e) {
    // fmt says only "file" when standard output takes no more.
    const std::string words = std::ferror(stdout) != 0 ? "cannot write to standard output" : e.what();
    fmt::print(stderr, "error: {}\n", words);
    return sandbox::kFailed;
  }
  return sandbox::kBadInput;
}
