#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "algorithms/scene/images/frame_size.hpp"
#include "sweeps/measure/stopping.hpp"
#include "sweeps/spec/plan.hpp"
#include "sweeps/spec/spec.hpp"
#include "sweeps/tune/search.hpp"

/// The cheapest setting whose error stays below a bound: the last step of Imagire et al. 2007 (Sec. 5), which they do
/// by eye and leave to future work, for any technique, scene and quantity.
namespace pellucid::sweeps {

struct TuneOptions {
  std::string quantity = "flip_mean";  ///< a field of the rows that says how far a setting is off
  double bound = 0;
  bool at_least = false;                 ///< the quantity is to be at least the bound, as psnr is
  std::string cost = "frame_ms_median";  ///< a field of which less is better
  double share = 0.1;                    ///< of the grid's points that may be drawn, but six in any case
};

/// One question: all settings of a spec in one scene, view and size.
struct TuneGroup {
  std::string scene, view;
  FrameSize size;
  std::vector<std::size_t> points;  ///< of Plan::points
};

/// A setting that was timed again, in turns with the others that seem cheapest: what slows the machine for a while
/// slows all of them.
struct Finalist {
  std::size_t point;  ///< of Plan::points
  double ratio = 1;   ///< its frame time over the best's, median of the rounds
  Interval range{};   ///< 95 %
};

struct TuneAnswer {
  TuneGroup group;
  std::optional<std::size_t> best;               ///< of Plan::points
  std::vector<std::size_t> measured;             ///< in this search, in order
  std::vector<Finalist> finalists;               ///< by their ratio; empty unless frame times were compared in turns
  std::vector<std::size_t> rivals;               ///< acceptable ones that are not known to cost more than the best
  std::vector<std::size_t> front;                ///< no measured one beats them in both, by cost
  std::vector<std::optional<Outcome>> outcomes;  ///< by place in group.points; nothing where not measured
  bool settled = false;                          ///< nothing unmeasured promised more
};

/// A plan's points by the question they answer.
std::vector<TuneGroup> tune_groups(const Plan&);

/// Where a setting lies among the others of its group: a number's rank among the values that occur, a choice as a
/// coordinate for each of its values.
std::vector<std::vector<double>> coordinates(const Plan&, const TuneGroup&);

/// The outcome of a row; nothing for one that has failed or lacks the fields. Throws InputError when a row that did not
/// fail has no such field, with the nearest name.
std::optional<Outcome> outcome_of(const nlohmann::json& row, const TuneOptions&);

/// The questions that the search asks of its surroundings.
struct TuneHooks {
  std::function<const nlohmann::json*(std::size_t point)> row_of;  ///< the store's row, or null
  std::function<void(std::size_t point)> measure;                  ///< so that it has a row
  /// Frame times of the points in turns [ms], by point and round; those of a point that cannot be timed are empty.
  std::function<std::vector<std::vector<double>>(const std::vector<std::size_t>& points, int rounds)> time_in_turns;
};

/// Rounds in which finalists are timed: odd, and enough for order statistics to give a 95 % interval of the median.
inline constexpr int kTuneRounds = 7;

/// Compares finalists by their times in each round. The first is the best.
std::vector<Finalist> rank_finalists(const std::vector<std::size_t>& points,
                                     const std::vector<std::vector<double>>& round_ms);

/// Answers each question of the plan. Timing the finalists again takes a part of the renders allowed.
std::vector<TuneAnswer> tune(const Plan&, const TuneOptions&, const TuneHooks&);

}  // namespace pellucid::sweeps
