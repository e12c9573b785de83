#include "algorithms/parameters.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <numeric>

#include <fmt/format.h>

namespace pellucid {

const char* name(Change change) {
  switch (change) {
    case Change::uniform:
      return "uniform";
    case Change::program:
      return "program";
    case Change::precompute:
      return "precompute";
  }
  return "";
}

const char* name(ValueType type) {
  switch (type) {
    case ValueType::boolean:
      return "boolean";
    case ValueType::integer:
      return "integer";
    case ValueType::real:
      return "real";
    case ValueType::choice:
      return "choice";
  }
  return "";
}

std::string to_text(const Value& value) {
  struct Visitor {
    std::string operator()(bool v) const { return v ? "true" : "false"; }
    std::string operator()(std::int64_t v) const { return fmt::to_string(v); }
    std::string operator()(double v) const { return fmt::format("{}", v); }
    std::string operator()(const std::string& v) const { return v; }
  };
  return std::visit(Visitor{}, value);
}

const ParameterInfo* ParameterTable::find(std::string_view wanted) const {
  auto it = std::find_if(infos_.begin(), infos_.end(), [&](const ParameterInfo& p) { return p.name == wanted; });
  return it == infos_.end() ? nullptr : &*it;
}

namespace {

std::string allowed(const ParameterInfo& info) {
  switch (info.type) {
    case ValueType::boolean:
      return "true or false";
    case ValueType::integer:
      return fmt::format("an integer in [{}, {}]", info.min, info.max);
    case ValueType::real:
      return fmt::format("a number in [{}, {}]", info.min, info.max);
    case ValueType::choice:
      return fmt::format("one of {}", fmt::join(info.choices, ", "));
  }
  return "";
}

InputError wrong_type(const ParameterInfo& info, std::string_view found, std::string_view owner) {
  return InputError(fmt::format("{}: {} = {} is not {}", owner, info.name, found, allowed(info)));
}

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i + 1);
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t substituted = diagonal + (a[i] == b[j] ? 0U : 1U);
      diagonal = row[j + 1];
      row[j + 1] = std::min({row[j] + 1, row[j + 1] + 1, substituted});
    }
  }
  return row.back();
}

}  // namespace

Value checked(const ParameterInfo& info, const Value& value, std::string_view owner) {
  auto in_range = [&](double v) {
    if (!(v >= info.min && v <= info.max)) {
      throw InputError(
          fmt::format("{}: {} = {} is out of range [{}, {}]", owner, info.name, to_text(value), info.min, info.max));
    }
  };
  switch (info.type) {
    case ValueType::boolean:
      if (std::holds_alternative<bool>(value)) return value;
      break;
    case ValueType::integer:
      if (const auto* v = std::get_if<std::int64_t>(&value)) {
        in_range(static_cast<double>(*v));
        return value;
      }
      break;
    case ValueType::real: {
      const auto* integer = std::get_if<std::int64_t>(&value);
      const auto* real = std::get_if<double>(&value);
      if (integer == nullptr && real == nullptr) break;
      const double v = integer != nullptr ? static_cast<double>(*integer) : *real;
      in_range(v);
      return v;
    }
    case ValueType::choice:
      if (const auto* v = std::get_if<std::string>(&value)) {
        if (std::find(info.choices.begin(), info.choices.end(), *v) != info.choices.end()) return value;
        const std::string near = nearest_name(*v, info.choices);
        throw InputError(fmt::format("{}: {} = '{}' is not {}{}", owner, info.name, *v, allowed(info),
                                     near.empty() ? "" : fmt::format("; did you mean '{}'?", near)));
      }
      break;
  }
  throw wrong_type(info, to_text(value), owner);
}

Value parse_value(const ParameterInfo& info, std::string_view text, std::string_view owner) {
  const char* end = text.data() + text.size();
  switch (info.type) {
    case ValueType::boolean:
      if (text == "true") return true;
      if (text == "false") return false;
      break;
    case ValueType::integer: {
      std::int64_t v = 0;
      auto [p, ec] = std::from_chars(text.data(), end, v);
      if (ec == std::errc{} && p == end) return checked(info, v, owner);
      break;
    }
    case ValueType::real: {
      double v = 0;
      auto [p, ec] = std::from_chars(text.data(), end, v);
      if (ec == std::errc{} && p == end) return checked(info, v, owner);
      break;
    }
    case ValueType::choice:
      return checked(info, std::string(text), owner);
  }
  throw wrong_type(info, fmt::format("'{}'", text), owner);
}

std::string nearest_name(std::string_view wanted, std::span<const std::string> candidates) {
  std::size_t best = std::max<std::size_t>(2, wanted.size() / 3) + 1;
  std::string nearest;
  for (const std::string& candidate : candidates) {
    const std::size_t shorter = std::min(wanted.size(), candidate.size());
    if (std::max(wanted.size(), candidate.size()) - shorter >= best) continue;  // a page of text is no misspelt name
    const std::size_t distance = edit_distance(wanted, candidate);
    if (distance < best) {
      best = distance;
      nearest = candidate;
    }
  }
  return nearest;
}

InputError unknown_parameter(std::string_view wanted, std::string_view owner, std::span<const ParameterInfo> infos) {
  std::vector<std::string> names;
  for (const ParameterInfo& info : infos)
    names.push_back(info.name);
  const std::string near = nearest_name(wanted, names);
  return InputError(fmt::format(
      "unknown parameter '{}' of {}; {}", wanted, owner,
      near.empty() ? fmt::format("it has {}", fmt::join(names, ", ")) : fmt::format("did you mean '{}'?", near)));
}

namespace detail {

ParameterInfo make_info(std::string_view parameter, ValueType type, const Meta& meta, double default_number) {
  ParameterInfo info;
  info.name = parameter;
  info.symbol = meta.symbol;
  info.cite = meta.cite;
  info.doc = meta.doc;
  info.unit = meta.unit;
  info.type = type;
  info.min = meta.range.min;
  info.max = meta.range.max;
  info.when = meta.when;
  std::string_view rest = meta.choices;
  while (!rest.empty()) {
    const auto bar = rest.find('|');
    info.choices.emplace_back(rest.substr(0, bar));
    rest = bar == std::string_view::npos ? std::string_view{} : rest.substr(bar + 1);
  }
  info.default_value = make_value(info, default_number);
  return info;
}

double nearest_decimal(float value) {
  std::array<char, 32> digits{};
  const auto written = std::to_chars(digits.data(), digits.data() + digits.size(), value);
  double decimal = 0;
  std::from_chars(digits.data(), written.ptr, decimal);
  return decimal;
}

Value make_value(const ParameterInfo& info, double number) {
  switch (info.type) {
    case ValueType::boolean:
      return number != 0;
    case ValueType::integer:
      return static_cast<std::int64_t>(number);
    case ValueType::real:
      return number;
    case ValueType::choice:
      return info.choices.at(static_cast<std::size_t>(number));
  }
  return {};
}

double to_number(const ParameterInfo& info, const Value& value) {
  struct Visitor {
    const ParameterInfo& info;
    double operator()(bool v) const { return v ? 1 : 0; }
    double operator()(std::int64_t v) const { return static_cast<double>(v); }
    double operator()(double v) const { return v; }
    double operator()(const std::string& v) const {
      const auto it = std::find(info.choices.begin(), info.choices.end(), v);
      assert(it != info.choices.end());
      return static_cast<double>(it - info.choices.begin());
    }
  };
  return std::visit(Visitor{info}, value);
}

}  // namespace detail

Value ParameterRef::get(std::string_view wanted) const {
  const ParameterInfo* info = table->find(wanted);
  assert(info != nullptr);
  return table->get(object, table->index(*info));
}

Change ParameterRef::assign(std::string_view wanted, const Value& value, std::string_view owner) const {
  const ParameterInfo* info = table->find(wanted);
  if (info == nullptr) throw unknown_parameter(wanted, owner, table->infos());
  table->set(object, table->index(*info), checked(*info, value, owner));
  return info->when;
}

}  // namespace pellucid
