#include "sweeps/tables/table_variables.hpp"

#include <cstddef>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>

#include "gl/error.hpp"

namespace pellucid::sweeps {
namespace {

constexpr int kDeepest = 8;

const Value& find(std::string_view name, const Variables& variables) {
  if (const auto found = variables.find(name); found != variables.end()) return found->second;
  std::vector<std::string> names;
  for (const auto& [known, value] : variables)
    names.push_back(known);
  const std::string near = nearest_name(name, names);
  throw InputError(fmt::format(
      "{{{}}} is unknown here; {}", name,
      near.empty() ? fmt::format("there are {}", fmt::join(names, ", ")) : fmt::format("did you mean '{}'?", near)));
}

std::string expand(std::string_view text, const Variables& variables, int depth) {
  if (depth > kDeepest) throw InputError(fmt::format("'{}' names itself", text));
  std::string out;
  while (!text.empty()) {
    const std::size_t open = text.find('{');
    const std::size_t close = open == std::string_view::npos ? open : text.find('}', open);
    if (close == std::string_view::npos) break;
    out += text.substr(0, open);
    const Value& value = find(text.substr(open + 1, close - open - 1), variables);
    const auto* inner = std::get_if<std::string>(&value);
    out += inner != nullptr ? expand(*inner, variables, depth + 1) : to_text(value);
    text.remove_prefix(close + 1);
  }
  return out.append(text);
}

}  // namespace

Variables merged(Variables variables, const Variables& later) {
  for (const auto& [name, value] : later)
    variables[name] = value;
  return variables;
}

std::string expand(std::string_view text, const Variables& variables) {
  return expand(text, variables, 0);
}

Value expand_value(std::string_view text, const Variables& variables) {
  if (text.size() > 2 && text.front() == '{' && text.find('}') == text.size() - 1) {
    const Value& value = find(text.substr(1, text.size() - 2), variables);
    if (!std::holds_alternative<std::string>(value)) return value;
  }
  return expand(text, variables);
}

}  // namespace pellucid::sweeps
