#include "sweeps/tune/tune.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <map>
#include <set>
#include <utility>
#include <variant>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "algorithms/parameters.hpp"
#include "gl/error.hpp"
#include "sweeps/measure/stopping.hpp"
#include "sweeps/tune/median_interval.hpp"

namespace pellucid::sweeps {
namespace {

using nlohmann::json;

constexpr std::size_t kAtLeast = 6;
constexpr std::size_t kFinalsAtLeast = 2;

double field(const json& row, const std::string& name) {
  const auto found = row.find(name);
  if (found != row.end() && found->is_number()) return found->get<double>();
  std::vector<std::string> names;
  for (const auto& [other, value] : row.items()) {
    if (value.is_number()) names.push_back(other);
  }
  const std::string near = nearest_name(name, names);
  throw InputError(near.empty()
                       ? fmt::format("the rows have no number '{}'; they have {}", name, fmt::join(names, ", "))
                       : fmt::format("the rows have no number '{}'; did you mean '{}'?", name, near));
}

}  // namespace

std::vector<TuneGroup> tune_groups(const Plan& plan) {
  std::vector<TuneGroup> groups;
  for (std::size_t i = 0; i < plan.points.size(); ++i) {
    const Point& point = plan.points[i];
    const auto same = [&](const TuneGroup& g) {
      return g.scene == point.scene && g.view == point.view && g.size.width == point.size.width &&
             g.size.height == point.size.height;
    };
    auto group = std::find_if(groups.begin(), groups.end(), same);
    if (group == groups.end()) group = groups.insert(groups.end(), {point.scene, point.view, point.size, {}});
    group->points.push_back(i);
  }
  return groups;
}

std::vector<std::vector<double>> coordinates(const Plan& plan, const TuneGroup& group) {
  // Every value of every parameter, the technique among them. A technique lacks the parameters of another.
  std::map<std::string, std::set<double>> numbers;
  std::map<std::string, std::set<std::string>> words;
  const auto visit = [&](const Point& point, const auto& number, const auto& word) {
    word("technique", point.technique);
    for (const auto& [name, value] : point.parameters) {
      if (const auto* i = std::get_if<std::int64_t>(&value)) {
        number(name, static_cast<double>(*i));
      } else if (const auto* d = std::get_if<double>(&value)) {
        number(name, *d);
      } else {
        word(name, to_text(value));
      }
    }
  };
  for (const std::size_t i : group.points) {
    visit(
        plan.points[i], [&](const std::string& name, double value) { numbers[name].insert(value); },
        [&](const std::string& name, const std::string& value) { words[name].insert(value); });
  }
  std::erase_if(numbers, [](const auto& entry) { return entry.second.size() < 2; });
  std::erase_if(words, [](const auto& entry) { return entry.second.size() < 2; });

  std::vector<std::vector<double>> result;
  for (const std::size_t i : group.points) {
    std::map<std::string, double> place;
    for (const auto& [name, values] : numbers)
      place[name] = 0.5;
    for (const auto& [name, values] : words) {
      for (const std::string& value : values)
        place[name + "=" + value] = 0;
    }
    visit(
        plan.points[i],
        [&](const std::string& name, double value) {
          const auto known = numbers.find(name);
          if (known == numbers.end()) return;
          const auto rank = std::distance(known->second.begin(), known->second.find(value));
          place[name] = static_cast<double>(rank) / static_cast<double>(known->second.size() - 1);
        },
        [&](const std::string& name, const std::string& value) {
          if (words.contains(name)) place[name + "=" + value] = 1;
        });
    std::vector<double>& coordinates = result.emplace_back();
    for (const auto& [name, value] : place)
      coordinates.push_back(value);
  }
  return result;
}

std::optional<Outcome> outcome_of(const json& row, const TuneOptions& options) {
  if (row.value("status", "") != "ok") return std::nullopt;
  Outcome outcome;
  outcome.cost = outcome.cost_low = outcome.cost_high = field(row, options.cost);
  if (options.cost == "frame_ms_median") {
    outcome.cost_low = row.value("frame_ms_ci95_low", outcome.cost);
    outcome.cost_high = row.value("frame_ms_ci95_high", outcome.cost);
    if (const auto samples = row.find("frame_ms_samples"); samples != row.end() && !samples->empty())
      outcome.least_cost = std::min_element(samples->begin(), samples->end())->get<double>();
  }
  // Equal images have an infinite psnr, which a row cannot hold.
  const auto quantity = row.find(options.quantity);
  const bool infinite = quantity != row.end() && quantity->is_null() && options.at_least;
  outcome.error = infinite ? 1e300 : field(row, options.quantity);
  if (options.at_least) outcome.error = -outcome.error;
  return outcome;
}

std::vector<Finalist> rank_finalists(const std::vector<std::size_t>& points,
                                     const std::vector<std::vector<double>>& round_ms) {
  std::vector<Finalist> result;
  std::vector<std::size_t> timed;  // of `points`
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!round_ms[i].empty()) timed.push_back(i);
  }
  if (timed.empty()) return result;
  // The logarithm of each time over the round's mean: what a round has in common falls out.
  std::vector<std::vector<double>> relative(points.size());
  for (std::size_t round = 0; round < round_ms[timed.front()].size(); ++round) {
    double mean = 0;
    for (const std::size_t i : timed)
      mean += std::log(round_ms[i][round]) / static_cast<double>(timed.size());
    for (const std::size_t i : timed)
      relative[i].push_back(std::log(round_ms[i][round]) - mean);
  }
  const std::size_t best = *std::min_element(timed.begin(), timed.end(), [&](std::size_t a, std::size_t b) {
    return median_of(relative[a]) < median_of(relative[b]);
  });
  for (const std::size_t i : timed) {
    std::vector<double> ratios;
    for (std::size_t round = 0; round < relative[i].size(); ++round)
      ratios.push_back(std::exp(relative[i][round] - relative[best][round]));
    const auto [least, most] = std::minmax_element(ratios.begin(), ratios.end());
    result.push_back({points[i], median_of(ratios), median_interval(ratios, 0.95).value_or(Interval{*least, *most})});
  }
  std::stable_sort(result.begin(), result.end(), [&](const Finalist& a, const Finalist& b) {
    const bool a_best = a.point == points[best];
    const bool b_best = b.point == points[best];
    return a_best != b_best ? a_best : a.ratio < b.ratio;
  });
  return result;
}

namespace {

/// Acceptable settings that cost at most this factor more than the cheapest may be the cheapest in truth.
constexpr double kFinalFactor = 1.5;

/// The settings to compare in turns, by their places in the group.
std::vector<std::size_t> choose_finalists(const SearchResult& found, std::size_t most) {
  std::vector<std::size_t> chosen;
  for (std::size_t i = 0; i < found.acceptable.size() && chosen.size() < most; ++i) {
    if (found.seeming_cost[i] <= kFinalFactor * found.seeming_cost.front()) chosen.push_back(found.acceptable[i]);
  }
  return chosen;
}

}  // namespace

std::vector<TuneAnswer> tune(const Plan& plan, const TuneOptions& options, const TuneHooks& hooks) {
  std::vector<TuneAnswer> answers;
  for (TuneGroup& group : tune_groups(plan)) {
    TuneAnswer answer;
    std::vector<std::optional<Outcome>> known;
    for (const std::size_t point : group.points) {
      const json* row = hooks.row_of(point);
      known.push_back(row != nullptr ? outcome_of(*row, options) : std::nullopt);
    }
    SearchOptions search;
    search.bound = options.at_least ? -options.bound : options.bound;
    search.errors_positive = !options.at_least;
    const std::size_t renders = std::max(
        kAtLeast, static_cast<std::size_t>(std::floor(options.share * static_cast<double>(group.points.size()))));
    // Times alone are compared in turns; a finalist's frames are about as many as those of a point.
    const std::size_t for_finals = options.cost == "frame_ms_median" ? std::max(kFinalsAtLeast, renders / 4) : 0;
    search.budget = renders - for_finals;
    const auto look = [&] {
      const std::vector<std::optional<Outcome>> before = known;
      SearchResult found =
          search_cheapest(coordinates(plan, group), search, before, [&](std::size_t i) -> std::optional<Outcome> {
            hooks.measure(group.points[i]);
            const json* row = hooks.row_of(group.points[i]);
            known[i] = row != nullptr ? outcome_of(*row, options) : std::nullopt;
            return known[i];
          });
      for (const std::size_t i : found.measured)
        answer.measured.push_back(group.points[i]);
      return found;
    };
    SearchResult found = look();
    // Renders that the finals do not need go on looking.
    if (const std::size_t needed = std::max(kFinalsAtLeast, choose_finalists(found, for_finals).size());
        needed < for_finals && !found.settled) {
      search.budget = for_finals - needed;
      found = look();
    }
    answer.settled = found.settled;
    for (const std::size_t i : front(known))
      answer.front.push_back(group.points[i]);
    if (found.best) answer.best = group.points[*found.best];
    std::vector<std::size_t> finalists;
    for (const std::size_t i : choose_finalists(found, std::min(for_finals, renders - answer.measured.size())))
      finalists.push_back(group.points[i]);
    if (finalists.size() > 1) answer.finalists = rank_finalists(finalists, hooks.time_in_turns(finalists, kTuneRounds));
    if (!answer.finalists.empty()) {
      answer.best = answer.finalists.front().point;
      for (const Finalist& finalist : answer.finalists) {
        if (finalist.point != *answer.best && finalist.range.low <= 1) answer.rivals.push_back(finalist.point);
      }
    } else if (found.best) {
      for (const std::size_t i : found.acceptable) {
        if (i != *found.best && known[i]->cost_low <= known[*found.best]->cost_high)
          answer.rivals.push_back(group.points[i]);
      }
    }
    answer.outcomes = std::move(known);
    answer.group = std::move(group);
    answers.push_back(std::move(answer));
  }
  return answers;
}

}  // namespace pellucid::sweeps
