#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "algorithms/parameters.hpp"
#include "algorithms/scene/toml/scene_description.hpp"

namespace pellucid {

/// A scene file that has been read, and the values of its parameters. Assigning a parameter rewrites the numbers that
/// it drives and evaluates the parts of the scene that they belong to.
class SceneSource {
 public:
  /// Checks what every parameter drives. `text` is the file's content, for the hash.
  SceneSource(std::unique_ptr<SceneDescription> description, std::string text);

  /// Evaluates the whole scene at the current values.
  void evaluate_all(Scene&);
  const ParameterTable& table() const { return table_; }
  LoadingFacts& facts() { return description_->facts; }
  std::uint64_t revision() const { return revision_; }
  std::string content_hash() const;

 private:
  /// One number and all that is done to it: value = (base or set) · Π scales + Σ additions.
  struct Driven {
    double* number = nullptr;
    double base = 0;
    const DriveTarget* target = nullptr;
    std::vector<std::size_t> set, scale, add;  // parameters
  };
  void connect();
  void connect(std::size_t parameter, const DriveTarget& target, const std::pair<std::string, FilePosition>& drive);
  Range bounds(const Driven&) const;
  void write(const Driven&) const;
  double number(std::size_t parameter) const;
  std::vector<Affected> affected_by(std::size_t parameter) const;
  void assign(Scene&, std::size_t parameter, const Value&);
  void apply(Scene&, std::size_t parameter);
  double time_s() const;

  std::unique_ptr<SceneDescription> description_;
  std::string text_;
  std::vector<Driven> driven_;
  std::vector<Value> values_;
  std::size_t time_index_ = 0;
  std::uint64_t revision_ = 1;
  ParameterTable table_;
};

}  // namespace pellucid
