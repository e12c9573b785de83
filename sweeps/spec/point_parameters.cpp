#include "sweeps/spec/point_parameters.hpp"

#include <algorithm>
#include <cassert>
#include <stdexcept>

#include <fmt/format.h>

namespace pellucid::sweeps {

PointParameters::PointParameters(const Table& table) {
  Shared shared;
  for (const auto& [name, value] : table) {
    shared.names.push_back(name);
    shared.values.push_back(value);
  }
  shared_ = std::make_shared<const Shared>(std::move(shared));
}

const Value& PointParameters::value(std::size_t place) const {
  for (const auto& [own, value] : own_)  // as many as the spec has axes: a handful
    if (own == place) return value;
  return shared_->values[place];
}

const Value& PointParameters::at(std::string_view name) const {
  const auto found = std::lower_bound(shared_->names.begin(), shared_->names.end(), name);
  if (found == shared_->names.end() || *found != name) {
    throw std::out_of_range(fmt::format("no parameter '{}'", name));
  }
  return value(static_cast<std::size_t>(found - shared_->names.begin()));
}

PointParameters::Table PointParameters::table() const {
  Table all;
  for (const auto& [name, own] : *this)
    all.emplace(name, own);
  return all;
}

void PointParameters::set(std::size_t place, Value value) {
  assert(place < size());
  for (auto& [own, old] : own_) {
    if (own != place) continue;
    old = std::move(value);
    return;
  }
  own_.emplace_back(place, std::move(value));
}

}  // namespace pellucid::sweeps
