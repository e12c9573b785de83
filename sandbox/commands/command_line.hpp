#pragma once

#include <cstddef>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace CLI {
class App;
class Option;
class Validator;
}  // namespace CLI

/// The program's command line. command_line.cpp alone knows CLI11, whose header costs eight seconds of compilation in
/// every file that includes it. The names and the chaining are CLI11's.
namespace pellucid::sandbox::cli {

/// A test of an option's value, with the words that `--help` shows for it.
class Check {
 public:
  explicit Check(std::shared_ptr<const CLI::Validator> test) : test_(std::move(test)) {}
  const CLI::Validator& test() const { return *test_; }

 private:
  std::shared_ptr<const CLI::Validator> test_;
};

/// Both ends are allowed. Instantiated for int, double and std::size_t.
template <class T>
Check Range(T low, T high);
Check IsMember(std::vector<std::string> names);
extern const Check PositiveNumber, NonNegativeNumber, ExistingDirectory;

class Option {
 public:
  explicit Option(CLI::Option* option) : option_(option) {}

  Option* required();
  Option* check(const Check&);
  /// `--help` shows the value that the target has now.
  Option* capture_default_str();
  /// `false`: one value an occurrence, so that a positional argument may follow.
  Option* allow_extra_args(bool);
  Option* delimiter(char);
  Option* take_all();
  Option* excludes(Option*);
  Option* excludes(const std::string& name);
  Option* needs(Option*);

  std::size_t count() const;  ///< occurrences on the command line
  std::string get_name() const;

 private:
  CLI::Option* option_;
};

class App {
 public:
  explicit App(CLI::App* app) : app_(app) {}

  App* add_subcommand(const std::string& name, const std::string& description);
  /// Instantiated for std::string, std::filesystem::path, int, double, std::size_t, std::optional of them, and vectors
  /// of std::string, int and double (end of command_line.cpp).
  template <class T>
  Option* add_option(const std::string& names, T& target, const std::string& description);
  Option* add_flag(const std::string& names, bool& target, const std::string& description);
  Option* add_flag_callback(const std::string& names, std::function<void()> action, const std::string& description);
  void footer(const std::string& text);
  void footer(std::function<std::string()> text);  ///< made when `--help` is asked for
  void group(const std::string& name);             ///< empty: hidden from `--help`
  void require_subcommand(int count);
  bool parsed() const;
  std::size_t count(const std::string& option) const;  ///< occurrences on the command line

 private:
  Option* keep(CLI::Option* option);

  CLI::App* app_;
  std::deque<App> subcommands_;  // a deque's elements stay where they are
  std::deque<Option> options_;
};

/// The root and its parsing.
class CommandLine {
 public:
  CommandLine(const std::string& name, const std::string& description, const std::string& version);
  ~CommandLine();
  CommandLine(const CommandLine&) = delete;
  CommandLine& operator=(const CommandLine&) = delete;

  App& root() { return root_; }

  /// The status to exit with when nothing is left to do, since help or the version was asked for and is printed.
  /// Throws InputError for bad usage.
  std::optional<int> parse(int argc, char** argv);

 private:
  std::unique_ptr<CLI::App> app_;
  App root_;
};

}  // namespace pellucid::sandbox::cli
