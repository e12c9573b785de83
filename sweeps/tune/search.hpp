#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

namespace pellucid::sweeps {

/// A setting's cost and error as found. `error` is to be small: a quantity of which more is better
/// is negated by the caller.
struct Outcome {
  double cost = 0;
  double cost_low = 0, cost_high = 0;  ///< its interval
  double error = 0;
  double least_cost = 0;  ///< the least that was seen, which other work on the machine disturbs least; 0: not known
};

struct SearchOptions {
  double bound = 0;             ///< the error of an acceptable setting is at most this
  std::size_t budget = 0;       ///< settings to measure at most
  bool errors_positive = true;  ///< they are fitted by their logarithm
};

struct SearchResult {
  std::optional<std::size_t> best;      ///< the acceptable setting that seems cheapest, of those measured
  std::vector<std::size_t> acceptable;  ///< all that were measured, by the cost that they seem to have …
  std::vector<double> seeming_cost;     ///< … which is this, for each
  std::vector<std::size_t> measured;    ///< in order
  bool settled = false;                 ///< the search ended because nothing promised more, not for want of budget
};

/// Looks for the cheapest of `settings` (coordinates of about [0, 1], similar ones near each other) whose error stays
/// below a bound, as Imagire et al. 2007 (Sec. 5) do by hand. A Gaussian process for the logarithm of cost and one for
/// that of error tell which setting most likely is acceptable and cheaper than the best so far (expected improvement
/// under a constraint, Gardner et al. 2014); that one is measured next. A cost far above what all others tell is left
/// out of the model, since a busy machine only ever adds. A setting that cannot be measured (nothing) is avoided.
/// `known` settings are free.
SearchResult search_cheapest(const std::vector<std::vector<double>>& settings, const SearchOptions&,
                             const std::vector<std::optional<Outcome>>& known,
                             const std::function<std::optional<Outcome>(std::size_t)>& measure);

/// The settings that no measured one beats in both cost and error, by cost.
std::vector<std::size_t> front(const std::vector<std::optional<Outcome>>& outcomes);

}  // namespace pellucid::sweeps
