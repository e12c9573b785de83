#include "sweeps/spec/constraint.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <muParser.h>

#include "algorithms/parameters.hpp"
#include "gl/error.hpp"

namespace pellucid::sweeps {
namespace {

constexpr const char* kNameCharacters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_.";

/// muParser's own words, on one line.
InputError parse_failure(const std::string& text, const mu::ParserError& e) {
  return InputError(fmt::format("expression '{}': {}", text, e.GetMsg()));
}

}  // namespace

struct Expression::State {
  std::string text;
  std::vector<std::string> used;
  std::map<std::string, double> values;  // muParser keeps pointers to these
  mu::Parser parser;
};

Expression::Expression(std::string text) : state_(std::make_unique<State>()) {
  State& s = *state_;
  s.text = std::move(text);
  if (s.text.size() > 1000) throw InputError("an expression may have 1000 characters");
  // A single '=' would assign.
  for (std::size_t i = s.text.find('='); i != std::string::npos; i = s.text.find('=', i + 1)) {
    const bool pair_left = i > 0 && std::string_view("<>!=").find(s.text[i - 1]) != std::string_view::npos;
    const bool pair_right = i + 1 < s.text.size() && s.text[i + 1] == '=';
    if (!pair_left && !pair_right)
      throw InputError(fmt::format("expression '{}': '=' assigns; compare with '=='", s.text));
  }
  try {
    s.parser.DefineNameChars(kNameCharacters);
    s.parser.SetExpr(s.text);
    for (const auto& [name, unused] : s.parser.GetUsedVar())
      s.used.push_back(name);
    for (const std::string& name : s.used)
      s.parser.DefineVar(name, &s.values[name]);
    s.parser.Eval();  // parses in full
  } catch (const mu::ParserError& e) {
    throw parse_failure(s.text, e);
  }
  if (s.parser.GetNumResults() != 1) throw InputError(fmt::format("expression '{}': more than one expression", s.text));
}

Expression::Expression(std::string text, const std::vector<std::string>& names) : Expression(std::move(text)) {
  for (const std::string& name : used()) {
    if (std::find(names.begin(), names.end(), name) != names.end()) continue;
    const std::string near = nearest_name(name, names);
    throw InputError(fmt::format(
        "expression '{}': unknown name '{}'; {}", state_->text, name,
        near.empty() ? fmt::format("it may use {}", fmt::join(names, ", ")) : fmt::format("did you mean '{}'?", near)));
  }
}

Expression::~Expression() = default;
Expression::Expression(Expression&&) noexcept = default;
Expression& Expression::operator=(Expression&&) noexcept = default;

const std::vector<std::string>& Expression::used() const {
  return state_->used;
}

double Expression::value(const std::map<std::string, double>& values) {
  State& s = *state_;
  for (auto& [name, value] : s.values) {
    const auto found = values.find(name);
    assert(found != values.end());
    value = found->second;
  }
  try {
    return s.parser.Eval();
  } catch (const mu::ParserError& e) {
    throw parse_failure(s.text, e);
  }
}

bool Expression::holds(const std::map<std::string, double>& values) {
  const double result = value(values);
  if (result != 0 && result != 1) {  // NaN too, whose sign is of no interest
    throw InputError(fmt::format("constraint '{}' gives {}, neither true nor false; compare with <=, <, ==, !=, >, >=",
                                 state_->text, std::isnan(result) ? "nan" : fmt::format("{}", result)));
  }
  return result == 1;
}

}  // namespace pellucid::sweeps
