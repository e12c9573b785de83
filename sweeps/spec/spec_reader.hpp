#pragma once

#include <functional>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <toml++/toml.h>

#include "sweeps/spec/axis.hpp"
#include "sweeps/spec/spec.hpp"

/// Typed reading of a spec's TOML, for spec.cpp alone: every complaint is an InputError that starts with the place.
namespace pellucid::sweeps {

class SpecReader {
 public:
  explicit SpecReader(std::string source) : source_(std::move(source)) {}

  [[noreturn]] void fail(Position, std::string_view message) const;
  [[noreturn]] void fail(const toml::node& node, std::string_view message) const { fail(position(node), message); }
  Position position(const toml::node&) const;
  /// Runs `f`; an InputError gets the node's place in front.
  void at(const toml::node&, const std::function<void()>& f) const;

  /// Complains about the first key of `table` that is not in `keys`.
  void allow(const toml::table& table, std::initializer_list<std::string_view> keys, std::string_view where) const;
  /// `value` must be among `allowed`.
  void one_of(const toml::node&, const std::string& value, std::span<const std::string> allowed,
              std::string_view what) const;
  void one_of(const toml::node& node, const std::string& value, std::initializer_list<std::string> allowed,
              std::string_view what) const {
    one_of(node, value, std::span<const std::string>(allowed.begin(), allowed.size()), what);
  }

  // Each leaves `out` as it is when the key is absent, and returns whether it is there.
  bool text(const toml::table&, std::string_view key, std::string& out) const;
  bool boolean(const toml::table&, std::string_view key, bool& out) const;
  bool integer(const toml::table&, std::string_view key, int min, int max, int& out) const;
  bool real(const toml::table&, std::string_view key, double min, double max, double& out) const;
  const toml::table* table(const toml::table&, std::string_view key) const;

  /// A required name of [a-z0-9_]+; `at` is where to complain when it is missing.
  std::string identifier(const toml::table&, std::string_view key, Position at) const;

  struct Text {
    std::string value;
    const toml::node* node;
  };
  /// A list of distinct strings; empty when the key is absent.
  std::vector<Text> texts(const toml::table&, std::string_view key, bool may_be_empty) const;
  /// The same of a list that is no key's value; `what` names it.
  std::vector<Text> texts(const toml::node& list, std::string_view what, bool may_be_empty) const;
  std::vector<Text> required_texts(const toml::table&, std::string_view key, Position at) const;

  /// A named value of [run.axes] or [run.fixed]; `scene.x = …` and `"scene.x" = …` are the same.
  struct Entry {
    std::string name;
    Position at;
    const toml::node* node;
  };
  std::vector<Entry> entries(const toml::table&) const;
  Value value(const toml::node&, std::string_view name) const;
  AxisRange range(const toml::table&, std::string_view name) const;
  Size size(const Text&) const;
  /// A relative path of a scene file counts from the spec's folder.
  std::string resolve_scene(const std::string& scene) const;

 private:
  double number(const toml::node&, std::string_view name) const;
  std::string source_;
};

}  // namespace pellucid::sweeps
