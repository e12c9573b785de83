#include "sandbox/commands/command_line.hpp"

#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "algorithms/parameters.hpp"
#include "gl/error.hpp"

namespace pellucid::sandbox::cli {

namespace {

Check described(CLI::Validator test, const std::string& words) {
  test.description(words);
  return Check(std::make_shared<const CLI::Validator>(std::move(test)));
}

std::string listed(const std::vector<std::string>& names) {
  if (names.size() < 2) return fmt::format("{}", fmt::join(names, ""));
  return fmt::format("{} or {}", fmt::join(names.begin(), names.end() - 1, ", "), names.back());
}

/// `--samples INT   Rays per pixel (1 to 65536; default: 1)`. CLI11 puts all of that into the left column.
class HelpFormatter : public CLI::Formatter {
 public:
  std::string make_option_opts(const CLI::Option* option) const override {
    if (option->get_type_size() == 0) return "";
    std::string text = " " + type_and_check(option).first;
    if (option->get_expected_max() == CLI::detail::expected_max_vector_size) text += " ...";
    if (option->get_required()) text += " REQUIRED";
    return text;
  }

  std::string make_option_desc(const CLI::Option* option) const override {
    std::vector<std::string> notes;
    const std::string check = type_and_check(option).second;
    if (!check.empty()) notes.push_back(check);
    if (!option->get_default_str().empty()) notes.push_back("default: " + option->get_default_str());
    if (notes.empty()) return option->get_description();
    return fmt::format("{} ({})", option->get_description(), fmt::join(notes, "; "));
  }

 private:
  /// CLI11 joins the two with a colon.
  static std::pair<std::string, std::string> type_and_check(const CLI::Option* option) {
    const std::string both = option->get_type_name();
    const std::size_t colon = both.find(':');
    if (colon == std::string::npos) return {both, ""};
    return {both.substr(0, colon), both.substr(colon + 1)};
  }
};

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

/// The text of a number option is a number, and a finite one: CLI11 takes "" for 0 and "nan" for any range.
std::string check_number(const CLI::Option& option, const std::string& text) {
  const bool real = option.get_type_name().starts_with("FLOAT");
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool sound = !text.empty() && error == std::errc{} && end == text.data() + text.size() && std::isfinite(value);
  if (!sound) return fmt::format("'{}' is not {}", text, real ? "a finite number" : "an integer");
  if (real) return "";
  if (value != std::floor(value) || text.find_first_of(".eE") != std::string::npos)
    return fmt::format("'{}' is not an integer", text);
  if (option.get_name() == "--device" && value < 0)
    return fmt::format("'{}' is not a device's number (pellucid devices)", text);
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

/// Prints help or the version; a full disk behind a redirection is a failure.
int print_and_exit(const CLI::App& app, const CLI::ParseError& asked) {
  const int status = app.exit(asked);
  std::cout.flush();
  if (!std::cout || std::fflush(stdout) != 0)
    throw RuntimeError(fmt::format("cannot write to standard output: {}", std::strerror(errno)));
  return status;
}

}  // namespace

template <class T>
Check Range(T low, T high) {
  return described(CLI::Range(low, high), fmt::format("{} to {}", low, high));
}
template Check Range(int, int);
template Check Range(double, double);
template Check Range(std::size_t, std::size_t);

Check IsMember(std::vector<std::string> names) {
  const std::string words = listed(names);
  return described(CLI::IsMember(std::move(names)), words);
}

const Check PositiveNumber = described(CLI::PositiveNumber, "above 0");
const Check NonNegativeNumber = described(CLI::NonNegativeNumber, "0 or more");
const Check ExistingDirectory = described(CLI::ExistingDirectory, "a folder");

Option* Option::required() {
  option_->required();
  return this;
}
Option* Option::check(const Check& check) {
  option_->check(check.test());
  return this;
}
Option* Option::capture_default_str() {
  option_->capture_default_str();
  return this;
}
Option* Option::allow_extra_args(bool allowed) {
  option_->allow_extra_args(allowed);
  return this;
}
Option* Option::delimiter(char separator) {
  option_->delimiter(separator);
  return this;
}
Option* Option::take_all() {
  option_->take_all();
  return this;
}
Option* Option::excludes(Option* other) {
  option_->excludes(other->option_);
  return this;
}
Option* Option::excludes(const std::string& name) {
  option_->excludes(name);
  return this;
}
Option* Option::needs(Option* other) {
  option_->needs(other->option_);
  return this;
}
std::size_t Option::count() const {
  return option_->count();
}
std::string Option::get_name() const {
  return option_->get_name();
}

App* App::add_subcommand(const std::string& name, const std::string& description) {
  return &subcommands_.emplace_back(app_->add_subcommand(name, description));
}

template <class T>
Option* App::add_option(const std::string& names, T& target, const std::string& description) {
  return keep(app_->add_option(names, target, description));
}
template Option* App::add_option(const std::string&, std::string&, const std::string&);
template Option* App::add_option(const std::string&, std::filesystem::path&, const std::string&);
template Option* App::add_option(const std::string&, int&, const std::string&);
template Option* App::add_option(const std::string&, float&, const std::string&);
template Option* App::add_option(const std::string&, double&, const std::string&);
template Option* App::add_option(const std::string&, std::size_t&, const std::string&);
template Option* App::add_option(const std::string&, std::optional<std::string>&, const std::string&);
template Option* App::add_option(const std::string&, std::optional<int>&, const std::string&);
template Option* App::add_option(const std::string&, std::optional<double>&, const std::string&);
template Option* App::add_option(const std::string&, std::vector<std::string>&, const std::string&);
template Option* App::add_option(const std::string&, std::optional<std::filesystem::path>&, const std::string&);
template Option* App::add_option(const std::string&, std::optional<std::size_t>&, const std::string&);
template Option* App::add_option(const std::string&, std::vector<int>&, const std::string&);
template Option* App::add_option(const std::string&, std::vector<double>&, const std::string&);

Option* App::add_flag(const std::string& names, bool& target, const std::string& description) {
  return keep(app_->add_flag(names, target, description));
}

Option* App::add_flag_callback(const std::string& names, std::function<void()> action, const std::string& description) {
  return keep(app_->add_flag_callback(names, std::move(action), description));
}

void App::footer(const std::string& text) {
  app_->footer(text);
}
void App::footer(std::function<std::string()> text) {
  app_->footer(std::move(text));
}
void App::group(const std::string& name) {
  app_->group(name);
}
void App::require_subcommand(int count) {
  app_->require_subcommand(count);
}
bool App::parsed() const {
  return app_->parsed();
}
std::size_t App::count(const std::string& option) const {
  return app_->count(option);
}

Option* App::keep(CLI::Option* option) {
  return &options_.emplace_back(option);
}

CommandLine::CommandLine(const std::string& name, const std::string& description, const std::string& version)
    : app_(std::make_unique<CLI::App>(description, name)), root_(app_.get()) {
  app_->formatter(std::make_shared<HelpFormatter>());
  app_->set_version_flag("--version", version);
  app_->require_subcommand(1);
  app_->fallthrough(false);
}
CommandLine::~CommandLine() = default;

std::optional<int> CommandLine::parse(int argc, char** argv) {
  check_command_words(*app_, argc, argv, 1);
  check_numbers(*app_);
  try {
    app_->parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    // CLI11 prints help and version with status 0; everything else is bad usage.
    if (error.get_exit_code() == 0) return print_and_exit(*app_, error);
    throw InputError(error.what());
  }
  return std::nullopt;
}

}  // namespace pellucid::sandbox::cli
