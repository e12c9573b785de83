#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

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
  double share = 0.1;                    ///< of the grid's points that may be measured, but six in any case
};

/// One question: all settings of a spec in one scene, view and size.
struct TuneGroup {
  std::string scene, view;
  Size size;
  std::vector<std::size_t> points;  ///< of Plan::points
};

struct TuneAnswer {
  TuneGroup group;
  std::optional<std::size_t> best;               ///< of Plan::points
  std::vector<std::size_t> measured;             ///< in this search, in order
  std::vector<std::size_t> rivals;               ///< acceptable ones whose cost's interval reaches into the best's
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

/// Answers each question of the plan. `row_of` gives the store's row of a point, or null; `measure` measures a point so
/// that it has one.
std::vector<TuneAnswer> tune(const Plan&, const TuneOptions&,
                             const std::function<const nlohmann::json*(std::size_t)>& row_of,
                             const std::function<void(std::size_t)>& measure);

}  // namespace pellucid::sweeps
