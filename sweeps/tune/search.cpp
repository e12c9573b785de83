#include "sweeps/tune/search.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "sweeps/tune/surrogate.hpp"

namespace pellucid::sweeps {
namespace {

/// Expected improvement, as a share of the cost, below which nothing promises more. The models are sure of themselves
/// too soon, and the renders are allowed.
constexpr double kSettled = 1e-6;
/// The noise of measured costs and errors, in their logarithms. That of costs is a busy machine's; on a quiet one it
/// costs a few settings more, since neighbours are told apart later.
constexpr double kCostNoise = 0.05;
constexpr double kErrorNoise = 0.005;
/// A cost whose logarithm lies so far above what the others tell is some other program's.
constexpr double kOutlier = 0.5;
/// Measurements from which they can contradict one, and beyond which looking for it takes too long.
constexpr std::size_t kFewest = 6;
constexpr std::size_t kMost = 64;

double normal_below(double x) {
  return std::erfc(-x / std::sqrt(2.0)) / 2;
}
double normal_density(double x) {
  return std::exp(-x * x / 2) / std::sqrt(2 * std::acos(-1.0));
}

double distance2(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    sum += (a[i] - b[i]) * (a[i] - b[i]);
  return sum;
}

class Search {
 public:
  Search(const std::vector<std::vector<double>>& settings, const SearchOptions& options,
         const std::vector<std::optional<Outcome>>& known,
         const std::function<std::optional<Outcome>(std::size_t)>& measure)
      : settings_(settings), options_(options), measure_(measure), outcomes_(known), tried_(settings.size(), false) {
    outcomes_.resize(settings.size());
    for (std::size_t i = 0; i < settings.size(); ++i)
      tried_[i] = outcomes_[i].has_value();
  }

  SearchResult run() {
    const std::size_t dimensions = settings_.empty() ? 0 : settings_.front().size();
    const std::size_t first =
        std::min(options_.budget, std::max<std::size_t>({3, dimensions + 1, options_.budget / 3}));
    while (successes() < first && spent_ < options_.budget) {
      const auto next = farthest();
      if (!next) break;
      take(*next);
    }
    while (spent_ < options_.budget && successes() > 0) {
      const auto next = most_promising();
      if (!next) {
        result_.settled = true;
        break;
      }
      take(*next);
    }
    if (std::all_of(tried_.begin(), tried_.end(), [](bool t) { return t; })) result_.settled = true;
    std::vector<std::pair<double, std::size_t>> by_cost;
    if (successes() > 0) {
      const Surrogate cost = cost_model();
      for (std::size_t i = 0; i < outcomes_.size(); ++i) {
        if (outcomes_[i] && acceptable(*outcomes_[i])) by_cost.emplace_back(cost.at(settings_[i]).mean, i);
      }
    }
    std::sort(by_cost.begin(), by_cost.end());
    for (const auto& [cost, setting] : by_cost)
      result_.acceptable.push_back(setting);
    for (const auto& [cost, setting] : by_cost)
      result_.seeming_cost.push_back(std::exp(cost));
    if (!by_cost.empty()) result_.best = result_.acceptable.front();
    return result_;
  }

 private:
  std::size_t successes() const {
    return static_cast<std::size_t>(
        std::count_if(outcomes_.begin(), outcomes_.end(), [](const auto& o) { return o.has_value(); }));
  }

  void take(std::size_t setting) {
    tried_[setting] = true;
    ++spent_;
    outcomes_[setting] = measure_(setting);
    result_.measured.push_back(setting);
  }

  bool acceptable(const Outcome& outcome) const { return outcome.error <= options_.bound; }

  /// The setting farthest from all that were tried; at first, the one nearest to the middle.
  std::optional<std::size_t> farthest() const {
    std::optional<std::size_t> found;
    double largest = -std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < settings_.size(); ++i) {
      if (tried_[i]) continue;
      double nearest = std::numeric_limits<double>::infinity();
      for (std::size_t j = 0; j < settings_.size(); ++j) {
        if (tried_[j]) nearest = std::min(nearest, distance2(settings_[i], settings_[j]));
      }
      if (std::isinf(nearest)) nearest = -distance2(settings_[i], std::vector<double>(settings_[i].size(), 0.5));
      if (nearest > largest) {
        largest = nearest;
        found = i;
      }
    }
    return found;
  }

  double error_value(double error) const { return options_.errors_positive ? std::log(std::max(error, 1e-12)) : error; }

  Surrogate error_model() const {
    std::vector<std::vector<double>> places;
    std::vector<double> values;
    for (std::size_t i = 0; i < settings_.size(); ++i) {
      if (!outcomes_[i]) continue;
      places.push_back(settings_[i]);
      values.push_back(error_value(outcomes_[i]->error));
    }
    return {std::move(places), std::move(values), kErrorNoise};
  }
  /// The model of the logarithm of cost, without costs that the others contradict.
  Surrogate cost_model() const {
    std::vector<std::vector<double>> places;
    std::vector<double> values;
    for (std::size_t i = 0; i < settings_.size(); ++i) {
      if (!outcomes_[i]) continue;
      places.push_back(settings_[i]);
      values.push_back(
          std::log(std::max(outcomes_[i]->least_cost > 0 ? outcomes_[i]->least_cost : outcomes_[i]->cost, 1e-12)));
    }
    if (places.size() >= kFewest && places.size() <= kMost) {
      std::vector<std::size_t> contradicted;
      for (std::size_t i = 0; i < places.size(); ++i) {
        std::vector<std::vector<double>> other_places = places;
        std::vector<double> other_values = values;
        other_places.erase(other_places.begin() + static_cast<std::ptrdiff_t>(i));
        other_values.erase(other_values.begin() + static_cast<std::ptrdiff_t>(i));
        const Prediction told = Surrogate(std::move(other_places), std::move(other_values), kCostNoise).at(places[i]);
        if (values[i] - told.mean > std::max(kOutlier, 2 * told.deviation)) contradicted.push_back(i);
      }
      for (auto i = contradicted.rbegin(); i != contradicted.rend(); ++i) {
        places.erase(places.begin() + static_cast<std::ptrdiff_t>(*i));
        values.erase(values.begin() + static_cast<std::ptrdiff_t>(*i));
      }
    }
    return {std::move(places), std::move(values), kCostNoise};
  }

  /// The least cost that an acceptable setting seems to have, in its logarithm: not the luckiest measurement.
  std::optional<double> least_cost(const Surrogate& cost) const {
    std::optional<double> least;
    for (std::size_t i = 0; i < outcomes_.size(); ++i) {
      if (outcomes_[i] && acceptable(*outcomes_[i]))
        least = std::min(least.value_or(1e300), cost.at(settings_[i]).mean);
    }
    return least;
  }

  std::optional<std::size_t> most_promising() const {
    const Surrogate cost = cost_model();
    const Surrogate error = error_model();
    const std::optional<double> so_far = least_cost(cost);
    const double limit = so_far.value_or(0);
    std::optional<std::size_t> found;
    double largest = so_far ? kSettled : 0;
    for (std::size_t i = 0; i < settings_.size(); ++i) {
      if (tried_[i]) continue;
      const Prediction e = error.at(settings_[i]);
      const double z = (error_value(options_.bound) - e.mean) / std::max(e.deviation, 1e-9);
      double promise = normal_below(z);
      if (so_far) {
        const Prediction c = cost.at(settings_[i]);
        const double deviation = std::max(c.deviation, 1e-9);
        const double u = (limit - c.mean) / deviation;
        promise *= deviation * (u * normal_below(u) + normal_density(u));
      }
      if (promise > largest) {
        largest = promise;
        found = i;
      }
    }
    // Without an acceptable setting yet, and none that promises to be one, the unknown is all that is left.
    return !found && !so_far ? farthest() : found;
  }

  const std::vector<std::vector<double>>& settings_;
  const SearchOptions& options_;
  const std::function<std::optional<Outcome>(std::size_t)>& measure_;
  std::vector<std::optional<Outcome>> outcomes_;
  std::vector<bool> tried_;
  std::size_t spent_ = 0;
  SearchResult result_;
};

}  // namespace

SearchResult search_cheapest(const std::vector<std::vector<double>>& settings, const SearchOptions& options,
                             const std::vector<std::optional<Outcome>>& known,
                             const std::function<std::optional<Outcome>(std::size_t)>& measure) {
  return Search(settings, options, known, measure).run();
}

std::vector<std::size_t> front(const std::vector<std::optional<Outcome>>& outcomes) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    if (outcomes[i]) order.push_back(i);
  }
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return outcomes[a]->cost != outcomes[b]->cost ? outcomes[a]->cost < outcomes[b]->cost
                                                  : outcomes[a]->error < outcomes[b]->error;
  });
  std::vector<std::size_t> result;
  for (const std::size_t i : order) {
    if (result.empty() || outcomes[i]->error < outcomes[result.back()]->error) result.push_back(i);
  }
  return result;
}

}  // namespace pellucid::sweeps
