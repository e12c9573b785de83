#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "gl/error.hpp"

/// One declaration per parameter. A technique's parameters are a plain struct whose static `parameters(self, visit)`
/// declares each member once; the command line, sweep validation, the panel, shader defines, EXR metadata, `describe`
/// and the tests read the type-erased table that is filled from it.
namespace pellucid {

/// The cost of a new value.
enum class Change {
  uniform,    ///< next frame
  program,    ///< compiled into a shader
  precompute  ///< prepare() runs again
};
const char* name(Change);

struct Range {
  double min = 0;
  double max = 0;
};

/// The metadata declared beside a parameter's name and member. Designated initialisers keep it readable.
struct Meta {
  std::string_view symbol{};  ///< the paper's symbol
  Range range{};              ///< inclusive; not for bool and choices
  std::string_view cite{};    ///< section or equation of the paper, or "beyond the paper"
  std::string_view doc{};     ///< one line, no full stop
  Change when = Change::uniform;
  std::string_view unit{};
  std::string_view choices{};  ///< names of an enum's values in order, separated by '|'
};

/// bool; integer; real; name of a choice.
using Value = std::variant<bool, std::int64_t, double, std::string>;
enum class ValueType { boolean, integer, real, choice };
const char* name(ValueType);

/// Shortest text that reads back as the same value.
std::string to_text(const Value&);

/// A parameter with its type erased.
struct ParameterInfo {
  std::string name;  ///< snake_case; what -s, specs, JSON and tables call it
  std::string symbol, cite, doc, unit;
  ValueType type = ValueType::real;
  double min = 0, max = 0;
  std::vector<std::string> choices;
  Value default_value;
  Change when = Change::uniform;
};

/// Declares how to read and write the parameters of one kind of object.
class ParameterTable {
 public:
  using Get = std::function<Value(const void*, std::size_t)>;
  using Set = std::function<void(void*, std::size_t, const Value&)>;
  ParameterTable() = default;
  ParameterTable(std::vector<ParameterInfo> infos, Get get, Set set)
      : infos_(std::move(infos)), get_(std::move(get)), set_(std::move(set)) {}

  std::span<const ParameterInfo> infos() const { return infos_; }
  const ParameterInfo* find(std::string_view name) const;
  std::size_t index(const ParameterInfo& info) const { return static_cast<std::size_t>(&info - infos_.data()); }
  Value get(const void* object, std::size_t i) const { return get_(object, i); }
  void set(void* object, std::size_t i, const Value& value) const { set_(object, i, value); }

 private:
  std::vector<ParameterInfo> infos_;
  Get get_;
  Set set_;
};

/// Checks type and range and returns the value in the parameter's own type: an integer becomes a real where a real is
/// asked for, nothing else is converted. `owner` names the table in the message ("sampling_hulls").
/// Throws InputError: "sampling_hulls: hulls = 99 is out of range [1, 64]".
Value checked(const ParameterInfo&, const Value&, std::string_view owner);
/// The same from text, as the command line gives it.
Value parse_value(const ParameterInfo&, std::string_view text, std::string_view owner);

/// "unknown parameter 'hull' of sampling_hulls; did you mean 'hulls'?" (or the list of names when none is near).
InputError unknown_parameter(std::string_view name, std::string_view owner, std::span<const ParameterInfo>);
/// The candidate with the smallest edit distance, or empty when none is within a third of the name's length (at least
/// 2).
std::string nearest_name(std::string_view name, std::span<const std::string> candidates);

// ---- declaring ----

/// Inside `parameters(auto& self, auto&& visit)`.
#define PARAM(member) #member, self.member

namespace detail {

struct Any {
  template <class T>
  constexpr operator T() const;  // NOLINT: counts aggregate members, never called
};

template <class T, class... A>
constexpr std::size_t member_count() {
  if constexpr (requires { T{A{}..., Any{}}; }) {
    return member_count<T, A..., Any>();
  } else {
    return sizeof...(A);
  }
}

constexpr std::size_t choice_count(std::string_view choices) {
  std::size_t n = choices.empty() ? 0 : 1;
  for (char c : choices)
    n += c == '|' ? 1 : 0;
  return n;
}

template <class M>
constexpr double as_number(const M& value) {
  return static_cast<double>(value);
}

/// The shortest decimal that is this float, as a double: 0.1F gives 0.1 and not 0.10000000149. So a float that was
/// assigned from a text or a spec reads back as what was written there.
double nearest_decimal(float value);

template <class M>
double shown_number(const M& value) {
  if constexpr (std::is_same_v<M, float>) {
    return nearest_decimal(value);
  } else {
    return as_number(value);
  }
}

ParameterInfo make_info(std::string_view name, ValueType, const Meta&, double default_number);
Value make_value(const ParameterInfo&, double number);
double to_number(const ParameterInfo&, const Value&);

template <class M>
constexpr ValueType value_type() {
  if constexpr (std::is_same_v<M, bool>)
    return ValueType::boolean;
  else if constexpr (std::is_enum_v<M>)
    return ValueType::choice;
  else if constexpr (std::is_integral_v<M>)
    return ValueType::integer;
  else
    return ValueType::real;
}

struct CheckVisitor {
  std::size_t count = 0;
  bool good = true;
  template <class M>
  constexpr void operator()(std::string_view parameter, const M& value, const Meta& meta) {
    ++count;
    const double v = as_number(value);
    constexpr ValueType type = value_type<M>();
    good = good && !parameter.empty() && !meta.doc.empty() && !meta.cite.empty();
    if (type == ValueType::choice) {
      good = good && v >= 0 && v < static_cast<double>(choice_count(meta.choices));
    } else if (type != ValueType::boolean) {
      good = good && meta.range.min < meta.range.max && v >= meta.range.min && v <= meta.range.max;
    }
  }
};

/// Calls `f(member)` for the i-th declared member.
template <class F>
struct PickVisitor {
  std::size_t wanted;
  F f;
  std::size_t at = 0;
  template <class M>
  constexpr void operator()(std::string_view, M& member, const Meta&) {
    if (at++ == wanted) f(member);
  }
};
template <class F>
PickVisitor(std::size_t, F) -> PickVisitor<F>;

struct InfoVisitor {
  std::vector<ParameterInfo> infos;
  template <class M>
  void operator()(std::string_view parameter, const M& value, const Meta& meta) {
    infos.push_back(make_info(parameter, value_type<M>(), meta, shown_number(value)));
  }
};

}  // namespace detail

/// None forgotten, defaults in range, each documented and cited. For static_assert.
template <class T>
consteval bool well_formed() {
  detail::CheckVisitor visitor;
  const T defaults{};
  T::parameters(defaults, visitor);
  return visitor.good && visitor.count == detail::member_count<T>();
}

/// The table of a parameter struct; built once.
template <class T>
const ParameterTable& parameter_table() {
  static const ParameterTable table = [] {
    detail::InfoVisitor visitor;
    const T defaults{};
    T::parameters(defaults, visitor);
    auto infos = visitor.infos;
    return ParameterTable(
        visitor.infos,
        [infos](const void* object, std::size_t i) {
          double number = 0;
          detail::PickVisitor pick{i, [&](const auto& member) { number = detail::shown_number(member); }};
          T::parameters(*static_cast<const T*>(object), pick);
          return detail::make_value(infos[i], number);
        },
        [infos](void* object, std::size_t i, const Value& value) {
          const double number = detail::to_number(infos[i], value);
          detail::PickVisitor pick{
              i, [&](auto& member) { member = static_cast<std::remove_reference_t<decltype(member)>>(number); }};
          T::parameters(*static_cast<T*>(object), pick);
        });
  }();
  return table;
}

/// A table bound to an object.
struct ParameterRef {
  const ParameterTable* table = nullptr;
  void* object = nullptr;

  std::span<const ParameterInfo> infos() const { return table->infos(); }
  Value get(std::string_view name) const;  ///< asserts that it exists
  /// Validates and assigns; returns what the change costs. Throws InputError; `owner` as for checked().
  Change assign(std::string_view name, const Value&, std::string_view owner) const;
};

template <class T>
ParameterRef bind_parameters(T& object) {
  return {&parameter_table<T>(), &object};
}

}  // namespace pellucid
