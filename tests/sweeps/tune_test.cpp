#include "sweeps/tune/tune.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <random>
#include <string>
#include <variant>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "sweeps/spec/plan.hpp"
#include "tests/sweeps/fake_known_names.hpp"

namespace pellucid::sweeps {
namespace {

using nlohmann::json;

TEST(Finalists, AreComparedWithinEachRound) {
  // The second is 10 % slower, and the machine's pace doubles half-way.
  const std::vector<double> pace{1, 1.01, 0.99, 2, 2.02, 1.98, 2};
  std::vector<std::vector<double>> ms(3);
  for (const double p : pace) {
    ms[0].push_back(11 * p);
    ms[1].push_back(10 * p);
  }
  const std::vector<Finalist> ranked = rank_finalists({7, 8, 9}, ms);  // the third could not be timed
  ASSERT_EQ(ranked.size(), 2U);
  EXPECT_EQ(ranked[0].point, 8U);
  EXPECT_DOUBLE_EQ(ranked[0].ratio, 1);
  EXPECT_EQ(ranked[1].point, 7U);
  EXPECT_NEAR(ranked[1].ratio, 1.1, 1e-12);
  EXPECT_GT(ranked[1].range.low, 1.09);
  EXPECT_LT(ranked[1].range.high, 1.11);
  EXPECT_TRUE(rank_finalists({1}, {{}}).empty());
}

/// A grid of 16 by 16 settings whose costs and errors behave as those of sampling hulls, on a machine whose pace
/// wanders.
class NoisyMachine {
 public:
  NoisyMachine(unsigned seed, double single, double in_turn) : random_(seed), single_(single), in_turn_(in_turn) {}

  const Plan& plan() const { return plan_; }
  double cost(std::size_t point) const {
    return 0.5 + 0.2 * value(point, "hulls") + 0.05 * value(point, "hulls") * value(point, "samples");
  }
  double error(std::size_t point) const {
    return 0.01 + 0.4 / std::pow(value(point, "samples"), 1.2) / std::pow(value(point, "hulls"), 0.7);
  }
  TuneHooks hooks() {
    return {[this](std::size_t i) {
              const auto found = rows_.find(i);
              return found == rows_.end() ? nullptr : &found->second;
            },
            [this](std::size_t i) {
              ++drawn;
              const double longer = random_() % 8 == 0 ? spike : 1;
              const double ms = cost(i) * std::exp(single_ * normal_(random_)) * longer;
              rows_[i] = {{"status", "ok"},
                          {"frame_ms_median", ms},
                          {"frame_ms_ci95_low", 0.99 * ms},
                          {"frame_ms_ci95_high", 1.01 * ms},
                          {"flip_mean", error(i)}};
            },
            [this](const std::vector<std::size_t>& points, int rounds) {
              drawn += points.size();
              std::vector<std::vector<double>> ms(points.size());
              for (int round = 0; round < rounds; ++round) {
                const double pace = std::exp(single_ * normal_(random_));
                for (std::size_t i = 0; i < points.size(); ++i)
                  ms[i].push_back(cost(points[i]) * pace * std::exp(in_turn_ * normal_(random_)));
              }
              return ms;
            }};
  }
  std::size_t drawn = 0;
  double spike = 1;  ///< by which every eighth measurement takes longer

 private:
  double value(std::size_t point, const char* name) const {
    return static_cast<double>(std::get<std::int64_t>(plan_.points[point].parameters.at(name)));
  }
  test::FakeKnownNames known_names_;
  Plan plan_ =
      make_plan(parse_spec("name = 's'\n[[run]]\nname = 'a'\ntechniques = ['hulls']\nscenes = ['forest']\n[run.axes]\n"
                           "hulls = { from = 1, to = 16, steps = 16 }\nsamples = { from = 1, to = 16, steps = 16 }\n",
                           "s.toml", known_names_),
                known_names_);
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
  double single_, in_turn_;
  std::map<std::size_t, json> rows_;
};

// How far, at most and in the mean, the choice's true cost lies above that of the cheapest acceptable setting.
std::pair<double, double> regret(double single, double in_turn, double spike = 1) {
  double most = 0;
  double sum = 0;
  int trials = 0;
  for (unsigned seed = 0; seed < 8; ++seed) {
    for (const double bound : {0.02, 0.04, 0.08}) {
      NoisyMachine machine(seed, single, in_turn);
      machine.spike = spike;
      TuneOptions options;
      options.bound = bound;
      const std::vector<TuneAnswer> answers = tune(machine.plan(), options, machine.hooks());
      EXPECT_LE(machine.drawn, 25U) << "a tenth of 256";
      if (answers.size() != 1 || !answers[0].best) {
        ADD_FAILURE() << "no choice";
        continue;
      }
      EXPECT_LE(machine.error(*answers[0].best), bound);
      double least = 1e300;
      for (std::size_t i = 0; i < machine.plan().points.size(); ++i) {
        if (machine.error(i) <= bound) least = std::min(least, machine.cost(i));
      }
      const double above = machine.cost(*answers[0].best) / least - 1;
      most = std::max(most, above);
      sum += above;
      ++trials;
    }
  }
  return {most, sum / trials};
}

// Neighbours differ by 5 to 20 % in cost. A quiet machine leaves the search's own reach, a tenth of the grid.
TEST(Tune, FindsTheCheapestOnAQuietMachine) {
  const auto [most, mean] = regret(0.01, 0.01);
  EXPECT_LE(most, 0.05);
  EXPECT_LE(mean, 0.01);
}

// Single measurements are wrong by 10 %, those within a round by 2 %.
TEST(Tune, IsNotLedAstrayByABusyOne) {
  const auto [most, mean] = regret(0.1, 0.02);
  EXPECT_LE(most, 0.15);
  EXPECT_LE(mean, 0.04);
}

// Every eighth measurement takes five times as long, since somebody else computes.
TEST(Tune, IsNotLedAstrayBySpikes) {
  const auto [most, mean] = regret(0.05, 0.02, 5);
  EXPECT_LE(most, 0.5);  // one of 24 searches does not come to the row of the cheapest
  EXPECT_LE(mean, 0.05);
}

}  // namespace
}  // namespace pellucid::sweeps
