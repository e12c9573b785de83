#include "sweeps/tune/search.hpp"

#include <cmath>
#include <cstddef>
#include <optional>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "sweeps/tune/surrogate.hpp"

namespace pellucid::sweeps {
namespace {

/// A grid of `side` by `side` settings, each coordinate a rank.
std::vector<std::vector<double>> grid(std::size_t side) {
  std::vector<std::vector<double>> settings;
  for (std::size_t i = 0; i < side; ++i) {
    for (std::size_t j = 0; j < side; ++j)
      settings.push_back({static_cast<double>(i) / static_cast<double>(side - 1),
                          static_cast<double>(j) / static_cast<double>(side - 1)});
  }
  return settings;
}

std::optional<std::size_t> exhaustive(const std::vector<Outcome>& outcomes, double bound) {
  std::optional<std::size_t> best;
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    if (outcomes[i].error <= bound && (!best || outcomes[i].cost < outcomes[*best].cost)) best = i;
  }
  return best;
}

TEST(Surrogate, MeetsItsMeasurementsAndDoubtsTheRest) {
  const Surrogate s({{0.0}, {0.5}, {1.0}}, {1.0, 2.0, 5.0}, 1e-4);
  EXPECT_NEAR(s.at({0.5}).mean, 2, 0.02);
  EXPECT_LT(s.at({0.5}).deviation, 0.02);
  EXPECT_GT(s.at({0.25}).deviation, s.at({0.5}).deviation);
  EXPECT_GT(s.at({0.8}).mean, 2);
  EXPECT_LT(s.at({0.8}).mean, 5);
}

// Hulls and samples as they behave: cost grows with their product and their sum, error falls with both to a floor.
TEST(Search, FindsTheCheapestAcceptableSettingWithATenthOfTheGrid) {
  const auto settings = grid(16);
  int same = 0;
  int trials = 0;
  for (unsigned seed = 0; seed < 8; ++seed) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> noise(0, 0.01);
    std::vector<Outcome> truth;
    for (std::size_t i = 0; i < settings.size(); ++i) {
      const double hulls = 1 + static_cast<double>(i / 16);
      const double samples = 1 + static_cast<double>(i % 16);
      const double cost = (0.5 + 0.2 * hulls + 0.05 * hulls * samples) * std::exp(noise(random));
      const double error = 0.01 + 0.4 / std::pow(samples, 1.2) / std::pow(hulls, 0.7);
      truth.push_back({cost, cost * 0.98, cost * 1.02, error});
    }
    for (const double bound : {0.02, 0.04, 0.08}) {
      std::size_t renders = 0;
      const SearchResult found = search_cheapest(settings, {.bound = bound, .budget = 25}, {}, [&](std::size_t i) {
        ++renders;
        return std::optional(truth[i]);
      });
      EXPECT_LE(renders, 25U);  // a tenth of 256
      const auto best = exhaustive(truth, bound);
      ++trials;
      ASSERT_TRUE(found.best.has_value()) << seed << " " << bound;
      // The same choice, or one that is within its interval.
      if (*found.best == *best || truth[*found.best].cost_low <= truth[*best].cost_high) ++same;
    }
  }
  EXPECT_EQ(same, trials);
}

TEST(Search, UsesWhatIsKnownAlready) {
  const auto settings = grid(4);
  std::vector<std::optional<Outcome>> known;
  for (std::size_t i = 0; i < settings.size(); ++i)
    known.push_back(Outcome{1.0 + static_cast<double>(i), 0, 0, 1.0 / (1.0 + static_cast<double>(i))});
  const SearchResult found =
      search_cheapest(settings, {.bound = 0.2, .budget = 5}, known, [](std::size_t) -> std::optional<Outcome> {
        ADD_FAILURE() << "nothing is unknown";
        return std::nullopt;
      });
  EXPECT_EQ(found.best, 4U);
  EXPECT_TRUE(found.settled);
}

TEST(Search, SaysWhenNothingIsAcceptableAndSurvivesFailures) {
  const auto settings = grid(4);
  std::size_t asked = 0;
  const SearchResult none = search_cheapest(settings, {.bound = 0.001, .budget = 16}, {}, [&](std::size_t i) {
    ++asked;
    return i % 2 == 0 ? std::optional<Outcome>{} : std::optional(Outcome{1, 1, 1, 0.5});
  });
  EXPECT_FALSE(none.best.has_value());
  EXPECT_EQ(asked, 16U);
}

TEST(Search, TheFrontHasWhatNothingBeats) {
  const std::vector<std::optional<Outcome>> outcomes{Outcome{1, 0, 0, 9}, Outcome{2, 0, 0, 5}, std::nullopt,
                                                     Outcome{3, 0, 0, 6}, Outcome{4, 0, 0, 1}};
  EXPECT_EQ(front(outcomes), (std::vector<std::size_t>{0, 1, 4}));
}

}  // namespace
}  // namespace pellucid::sweeps
