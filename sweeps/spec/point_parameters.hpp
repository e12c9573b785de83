#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "algorithms/parameters.hpp"

namespace pellucid::sweeps {

/// A point's parameters by full name, in order of names. Points of one place (technique, scene, view and size) share a
/// table, and each holds the values that differ: a plan of 100,000 points would otherwise copy every parameter 100,000
/// times.
class PointParameters {
 public:
  using Table = std::map<std::string, Value>;
  struct Entry {
    const std::string& name;
    const Value& value;
  };
  class Iterator {
   public:
    Iterator(const PointParameters& of, std::size_t at) : of_(&of), at_(at) {}
    Entry operator*() const { return {of_->shared_->names[at_], of_->value(at_)}; }
    Iterator& operator++() {
      ++at_;
      return *this;
    }
    bool operator==(const Iterator&) const = default;

   private:
    const PointParameters* of_;
    std::size_t at_;
  };

  PointParameters() : PointParameters(Table{}) {}
  explicit PointParameters(const Table&);

  /// Throws std::out_of_range.
  const Value& at(std::string_view name) const;
  /// Sets the value of the parameter at a place in order of names. Points that share the table keep theirs.
  void set(std::size_t place, Value);
  Table table() const;
  std::size_t size() const { return shared_->names.size(); }
  Iterator begin() const { return {*this, 0}; }
  Iterator end() const { return {*this, size()}; }

 private:
  struct Shared {
    std::vector<std::string> names;
    std::vector<Value> values;
  };
  const Value& value(std::size_t place) const;

  std::shared_ptr<const Shared> shared_;
  std::vector<std::pair<std::size_t, Value>> own_;
};

}  // namespace pellucid::sweeps
