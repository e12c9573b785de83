#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <exception>
#include <iostream>
#include <string>
#include <string_view>
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

/// The text of a number option is a number, and a finite one: the library takes "" for 0 and "nan" for any range.
std::string check_number(const CLI::Option& option, const std::string& text) {
  const bool real = option.get_type_name().starts_with("FLOAT");
  const std::string shown = fmt::format("{} '{}'", option.get_name(), text);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value))
    return fmt::format("{} is not {}", shown, real ? "a finite number" : "an integer");
  if (real) return "";
  if (value != std::floor(value) || text.find_first_of(".eE") != std::string::npos)
    return fmt::format("{} is not an integer", shown);
  if (option.get_name() == "--device" && value < 0)
    return fmt::format("{} is not a device's number (pellucid devices)", shown);
  return "";
}

void check_numbers(CLI::App& app) {
  for (CLI::Option* option : app.get_options()) {
    const std::string type = option->get_type_name();
    if (type.starts_with("FLOAT") || type.starts_with("INT") || type.starts_with("UINT"))
      option->check([option](const std::string& text) { return check_number(*option, text); });
  }
  for (CLI::App* child : app.get_subcommands([](const CLI::App*) { return true; }))
    check_numbers(*child);
}

/// A name in a message may hold line ends or a terminal's control characters; an error is one line all the same.
std::string printable(std::string_view text) {
  std::string out;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte >= 0x20 && byte != 0x7F)
      out += c;
    else if (c == '\n')
      out += "\\n";
    else if (c == '\t')
      out += "\\t";
    else
      out += fmt::format("\\x{:02x}", byte);
  }
  return out;
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

  check_numbers(root);

  try {
    check_command_words(root, argc, argv, 1);
    root.parse(argc, argv);
  } catch (const InputError& e) {
    fmt::print(stderr, "error: {}\n", printable(e.what()));
    return sandbox::kBadInput;
  } catch (const CLI::ParseError& e) {
    // CLI11 prints help and version with status 0; everything else is bad usage.
    if (e.get_exit_code() == 0) {
      const int status = root.exit(e);
      std::cout.flush();
      if (!std::cout || std::fflush(stdout) != 0) {
        fmt::print(stderr, "error: cannot write to standard output: {}\n", std::strerror(errno));
        return sandbox::kFailed;
      }
      return status;
    }
    fmt::print(stderr, "error: {}\n", printable(e.what()));
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
    fmt::print(stderr, "error: {}\n", printable(e.what()));
    return sandbox::kBadInput;
  } catch (const std::exception& e) {
    // fmt says only "file" when standard output takes no more.
    const std::string words = std::ferror(stdout) != 0 ? "cannot write to standard output" : e.what();
    fmt::print(stderr, "error: {}\n", printable(words));
    return sandbox::kFailed;
  }
  return sandbox::kBadInput;
}
