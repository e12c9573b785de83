#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

namespace pellucid::sweeps {

/// Arithmetic over named numbers, evaluated with muParser: a constraint that must hold for a point
/// ("hulls * samples <= 64"), or a quantity that is worked out from others ("hulls * samples").
class Expression {
 public:
  /// `names`: the variables it may use. Throws InputError, with the nearest name for an unknown one, and when the
  /// expression cannot be a comparison.
  Expression(std::string text, const std::vector<std::string>& names);
  /// It may use any name.
  explicit Expression(std::string text);
  ~Expression();
  Expression(Expression&&) noexcept;
  Expression& operator=(Expression&&) noexcept;

  /// Throws InputError when the result is neither true (1) nor false (0), as of 0/0 or of a mere product.
  bool holds(const std::map<std::string, double>& values);
  /// `values` must have all that it uses. Throws InputError where muParser cannot go on.
  double value(const std::map<std::string, double>& values);
  /// The variables that it uses, sorted.
  const std::vector<std::string>& used() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace pellucid::sweeps
