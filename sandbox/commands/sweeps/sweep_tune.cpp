// pellucid sweep tune and sweep compare: questions asked of sweeps.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "algorithms/scene/files/tell.hpp"
#include "gl/error.hpp"
#include "sandbox/commands/commands.hpp"
#include "sweeps/spec/plan.hpp"
#include "sweeps/spec/point_json.hpp"
#include "sweeps/store/store.hpp"
#include "sweeps/tune/compare_rows.hpp"
#include "sweeps/tune/tune.hpp"
#include "sweeps/workers/run.hpp"

namespace pellucid::sandbox {
namespace {

using nlohmann::json;
using namespace pellucid::sweeps;

struct CompareArguments {
  std::string a, b, device_name;
  std::vector<std::string> commits;
  CompareOptions options;
  bool all = false, as_json = false, to_baseline = false;
};

/// One side of a comparison.
struct Side {
  std::string name;
  std::vector<json> rows;
  std::vector<std::string> parameters;
  std::vector<double> baselines;
};

/// Turns the rows' frame times into multiples of what the baseline took at that time.
void divide_by_baseline(Side& side) {
  for (json& row : side.rows) {
    const auto drift = row.find("baseline_drift");
    if (!row.contains("frame_ms_median")) continue;
    if (drift == row.end() || !drift->is_number() || side.baselines.empty())
      throw InputError(
          fmt::format("{} has no baseline to compare with (`baseline = true` in a block of the spec)", side.name));
    const double baseline_ms = side.baselines.front() * (1 + drift->get<double>());
    row["frame_ms_median"] = row.at("frame_ms_median").get<double>() / baseline_ms;
    for (json& sample : row.at("frame_ms_samples"))
      sample = sample.get<double>() / baseline_ms;
  }
}

Side read_side(const std::string& path, const std::string& commit, const std::string& device_name) {
  const Store store(path, Access::read);
  Side side{
      commit.empty() ? path : path + " at " + commit, store.rows(true, !commit.empty()), store.parameter_names(), {}};
  if (side.parameters.empty()) side.parameters = guess_parameters(side.rows);
  std::erase_if(side.rows, [&](const json& row) {
    const std::string machine = row.value("device", "") + ", " + row.value("driver", "");
    return !row.value("commit", "").starts_with(commit) || machine.find(device_name) == std::string::npos;
  });
  if (side.rows.empty()) throw InputError(fmt::format("{} has no rows to compare", side.name));
  double first_s = 1e300;
  double last_s = 0;
  std::vector<std::string> machines;
  for (const json& row : side.rows) {
    machines.push_back(row.value("device", "") + row.value("driver", "") + row.value("host", ""));
    first_s = std::min(first_s, row.value("done_unix_s", 0.0));
    last_s = std::max(last_s, row.value("done_unix_s", 0.0));
  }
  for (const auto& [sweep, sample] : store.all_baselines()) {
    const bool of_rows =
        std::find(machines.begin(), machines.end(), sample.device + sample.driver + sample.host) != machines.end();
    // An hour's margin: the first baseline stands before the first row.
    if (of_rows && sample.unix_s > first_s - 3600 && sample.unix_s < last_s + 3600)
      side.baselines.push_back(sample.frame_ms_median);
  }
  return side;
}

json compared_json(const ComparedPoint& p) {
  json metrics = json::object();
  for (const auto& [name, values] : p.metrics)
    metrics[name] = {{"a", values.first}, {"b", values.second}};
  return {{"point", p.point},
          {"device", p.device},
          {"time", name(p.time)},
          {"ratio", p.time == TimeChange::untimed ? json() : json(p.ratio)},
          {"ratio_low", p.range ? json(p.range->low) : json()},
          {"ratio_high", p.range ? json(p.range->high) : json()},
          {"quality", name(p.quality)},
          {"metrics", metrics},
          {"regression", p.regression}};
}

int compare(CompareArguments arguments) {
  const bool commits = !arguments.commits.empty();
  if (commits == !arguments.b.empty())
    throw InputError("compare two stores, A.db B.db, or two commits in one, A.db --commits OLD,NEW");
  if (commits && arguments.commits.size() != 2)
    throw InputError(fmt::format("--commits takes two, OLD,NEW, and {} are given", arguments.commits.size()));
  Side a = read_side(arguments.a, commits ? arguments.commits[0] : "", arguments.device_name);
  Side b = read_side(commits ? arguments.a : arguments.b, commits ? arguments.commits[1] : "", arguments.device_name);
  std::vector<std::string> parameters = a.parameters;
  for (const std::string& name : b.parameters) {
    if (std::find(parameters.begin(), parameters.end(), name) == parameters.end()) parameters.push_back(name);
  }
  arguments.options.between_runs = !arguments.to_baseline;
  if (arguments.to_baseline) {
    divide_by_baseline(a);
    divide_by_baseline(b);
  }
  const RowComparison result = compare_rows(a.rows, b.rows, parameters, a.baselines, b.baselines, arguments.options);
  if (result.points.empty()) throw InputError(fmt::format("{} and {} have no point in common", a.name, b.name));
  json counts = json::object();
  for (const TimeChange c :
       {TimeChange::faster, TimeChange::slower, TimeChange::same, TimeChange::undecided, TimeChange::untimed})
    counts[name(c)] = result.count(c);
  for (const QualityChange c : {QualityChange::better, QualityChange::worse})
    counts[name(c)] = result.count(c);
  counts["same_quality"] = result.count(QualityChange::same);
  if (arguments.as_json) {
    json points = json::array();
    for (const ComparedPoint& point : result.points)
      points.push_back(compared_json(point));
    fmt::print("{}\n", json{{"a", a.name},
                            {"b", b.name},
                            {"counts", counts},
                            {"regressions", result.regressions()},
                            {"only_in_a", result.only_in_a},
                            {"only_in_b", result.only_in_b},
                            {"confidence", result.confidence},
                            {"between_runs_deviation", result.between_runs},
                            {"points", points}}
                           .dump(2));
  } else {
    for (const ComparedPoint& p : result.points) {
      const bool news = p.time == TimeChange::faster || p.time == TimeChange::slower ||
                        p.quality == QualityChange::better || p.quality == QualityChange::worse;
      if (!news && !arguments.all) continue;
      std::string text = p.time == TimeChange::untimed ? "untimed" : fmt::format("{} {:.3f}", name(p.time), p.ratio);
      if (p.range) text += fmt::format(" [{:.3f}, {:.3f}]", p.range->low, p.range->high);
      if (p.quality != QualityChange::unknown) text += fmt::format(", quality {}", name(p.quality));
      for (const auto& [metric, values] : p.metrics)
        text += fmt::format(", {} {:.4g} -> {:.4g}", metric, values.first, values.second);
      fmt::print("{}{}: {}\n", p.regression ? "REGRESSION " : "", p.point, text);
    }
    fmt::print("{} points: {} faster, {} slower, {} same, {} undecided; quality {} better, {} worse, {} same\n",
               result.points.size(), result.count(TimeChange::faster), result.count(TimeChange::slower),
               result.count(TimeChange::same), result.count(TimeChange::undecided), result.count(QualityChange::better),
               result.count(QualityChange::worse), result.count(QualityChange::same));
    fmt::print(
        "intervals of each ratio hold with {:.4g} %, all together with {:.4g} %; runs of the same code differ by "
        "{:.2g} %\n",
        100 * result.confidence, 100 * (1 - arguments.options.alpha), 100 * result.between_runs);
    const auto differ = std::count_if(result.points.begin(), result.points.end(), [&](const ComparedPoint& p) {
      return p.range && std::abs(p.ratio - 1) > arguments.options.tolerance && (p.range->low > 1 || p.range->high < 1);
    });
    fmt::print("{} of {} points differ in time by more than {:g} % and beyond their intervals\n", differ,
               result.points.size(), 100 * arguments.options.tolerance);
    if (result.only_in_a + result.only_in_b > 0)
      fmt::print("{} points are in the first alone, {} in the second\n", result.only_in_a, result.only_in_b);
  }
  if (result.regressions() == 0) return kDone;
  tell("{} of {} points are worse by more than {:g} %", result.regressions(), result.points.size(),
       100 * arguments.options.tolerance);
  return kRegression;
}

void add_compare_command(cli::App& sweep, std::vector<Command>& commands) {
  auto arguments = std::make_shared<CompareArguments>();
  cli::App* app =
      sweep.add_subcommand("compare", "Tell which points of two runs became faster or slower, better or worse");
  app->add_option("a", arguments->a, "the store that is compared with")->required();
  app->add_option("b", arguments->b, "the store to judge");
  app->add_option("--commits", arguments->commits, "two commits whose rows are in one store: --commits OLD,NEW")
      ->delimiter(',');
  app->add_option("--device-name", arguments->device_name, "only rows whose device and driver contain this");
  app->add_option("--alpha", arguments->options.alpha,
                  "chance that any point of two runs of the same code is called different")
      ->check(cli::Range(1e-9, 0.5))
      ->capture_default_str();
  app->add_option("--tolerance", arguments->options.tolerance, "a change beyond this share is a regression")
      ->check(cli::Range(0.0, 10.0))
      ->capture_default_str();
  app->add_option("-m,--metrics", arguments->options.metrics, "judge quality by these columns (default: all metrics)")
      ->delimiter(',');
  app->add_flag("--to-baseline", arguments->to_baseline,
                "compare times over the baseline's at that moment, by the intervals of the samples alone");
  app->add_flag("--all", arguments->all, "print every point, not only those that changed");
  app->add_flag("--json", arguments->as_json, "print JSON");
  app->footer(
      "Example: pellucid sweep compare before.db after.db --tolerance 0.05\n"
      "Points are matched by what was measured, whatever the commit. Intervals are of the ratio of medians, corrected\n"
      "for the number of points (Šidák) and widened by what the baseline's re-measurements scatter. Status 3: a "
      "regression.");
  commands.push_back({app, [arguments] { return compare(*arguments); }});
}

struct TuneArguments {
  std::string spec, store, references;
  std::vector<int> devices;
  std::optional<double> below, at_least;
  TuneOptions options;
  bool as_json = false, quiet = false;
};

json setting_json(const Plan& plan, std::size_t index, const Outcome& outcome, const TuneOptions& options) {
  const Point& point = plan.points[index];
  json settings = json::object();
  for (const std::string& name : point.assigned)
    settings[name] = value_to_json(point.parameters.at(name));
  return {{"point", point.id},
          {"technique", point.technique},
          {"settings", settings},
          {options.cost, outcome.cost},
          {options.quantity, options.at_least ? -outcome.error : outcome.error},
          {"repeat", repeat_command(point)}};
}

std::string setting_text(const Plan& plan, std::size_t index, const Outcome& outcome, const TuneOptions& options) {
  const Point& point = plan.points[index];
  std::string text = point.technique;
  for (const std::string& name : point.assigned)
    text += fmt::format(" {}={}", name, to_text(point.parameters.at(name)));
  return fmt::format("{}: {} {:.4g}, {} {:.4g}", text, options.cost, outcome.cost, options.quantity,
                     options.at_least ? -outcome.error : outcome.error);
}

/// Frames of a finalist in each round; seven rounds of them are about what a point takes at least.
constexpr int kFramesInTurn = 5;

json finalists_json(const Plan& plan, const std::vector<Finalist>& finalists) {
  json items = json::array();
  for (const Finalist& f : finalists) {
    items.push_back({{"point", plan.points[f.point].id},
                     {"ratio", f.ratio},
                     {"ratio_ci95_low", f.range.low},
                     {"ratio_ci95_high", f.range.high}});
  }
  return items;
}

int tune_command(TuneArguments arguments) {
  if (arguments.below.has_value() == arguments.at_least.has_value())
    throw InputError("give one bound: --below E, or --at-least Q for a quantity of which more is better");
  arguments.options.bound = arguments.below ? *arguments.below : *arguments.at_least;
  arguments.options.at_least = arguments.at_least.has_value();
  const Spec spec = load_spec(arguments.spec);
  const Plan plan = make_plan(spec);
  RunOptions run;
  run.devices = arguments.devices;
  run.quiet = arguments.quiet;
  if (!arguments.references.empty()) run.references = arguments.references;

  std::map<std::string, json> rows;
  std::string device;
  const auto read = [&] {
    rows.clear();
    std::error_code error;
    if (!std::filesystem::exists(arguments.store, error)) return;
    for (json& row : Store(arguments.store, Access::read).rows(true, true)) {
      if (!device.empty() && row.value("device", "") + ", " + row.value("driver", "") != device) continue;
      std::string id = row.at("point").get<std::string>();  // before the row is moved
      rows[std::move(id)] = std::move(row);
    }
  };
  read();
  const auto row_of = [&](std::size_t index) {
    const auto found = rows.find(plan.points[index].id);
    return found == rows.end() ? nullptr : &found->second;
  };
  bool interrupted = false;
  Plan part = plan;
  part.baseline.reset();  // finalists are timed in turns instead
  const auto measure = [&](std::size_t index) {
    if (interrupted) return;
    part.order = {index};
    const SweepSummary summary = run_sweep(spec, part, arguments.store, run);
    interrupted = summary.interrupted;
    device = summary.device;
    read();
  };
  const auto in_turns = [&](const std::vector<std::size_t>& points, int rounds) {
    if (interrupted) return std::vector<std::vector<double>>(points.size());
    std::vector<const Point*> chosen;
    for (const std::size_t index : points)
      chosen.push_back(&plan.points[index]);
    return time_in_turns(spec, chosen, rounds, kFramesInTurn, run);
  };
  const std::vector<TuneAnswer> answers = tune(plan, arguments.options, {row_of, measure, in_turns});

  json out = json::array();
  bool found_all = true;
  for (const TuneAnswer& answer : answers) {
    const auto outcome = [&](std::size_t index) -> const Outcome& {
      const auto at = std::find(answer.group.points.begin(), answer.group.points.end(), index);
      return *answer.outcomes[static_cast<std::size_t>(at - answer.group.points.begin())];
    };
    found_all = found_all && answer.best.has_value();
    const auto list = [&](const std::vector<std::size_t>& points) {
      json items = json::array();
      for (const std::size_t index : points)
        items.push_back(setting_json(plan, index, outcome(index), arguments.options));
      return items;
    };
    if (arguments.as_json) {
      std::vector<std::size_t> tried;
      for (const std::size_t index : answer.measured) {
        const auto at = std::find(answer.group.points.begin(), answer.group.points.end(), index);
        if (answer.outcomes[static_cast<std::size_t>(at - answer.group.points.begin())]) tried.push_back(index);
      }
      out.push_back(
          {{"scene", answer.group.scene},
           {"view", answer.group.view},
           {"width", answer.group.size.width},
           {"height", answer.group.size.height},
           {"points", answer.group.points.size()},
           {"measured", answer.measured.size()},
           {"settled", answer.settled},
           {"best", answer.best ? setting_json(plan, *answer.best, outcome(*answer.best), arguments.options) : json()},
           {"within_its_interval", list(answer.rivals)},
           {"finalists", finalists_json(plan, answer.finalists)},
           {"front", list(answer.front)},
           {"evidence", list(tried)}});
      continue;
    }
    fmt::print("{}, {}, {}x{}: {} of {} settings measured{}\n", answer.group.scene, answer.group.view,
               answer.group.size.width, answer.group.size.height, answer.measured.size(), answer.group.points.size(),
               answer.settled ? "; nothing else promises more" : "");
    if (answer.best) {
      fmt::print("  best  {}\n", setting_text(plan, *answer.best, outcome(*answer.best), arguments.options));
      fmt::print("        {}\n", repeat_command(plan.points[*answer.best]));
    } else {
      fmt::print("  none of them keeps {} {} {:g}\n", arguments.options.quantity,
                 arguments.options.at_least ? "at or above" : "at or below", arguments.options.bound);
    }
    for (const Finalist& finalist : answer.finalists) {
      fmt::print("  timed in turns  {:.3f} [{:.3f}, {:.3f}] of the best's time  {}\n", finalist.ratio,
                 finalist.range.low, finalist.range.high,
                 setting_text(plan, finalist.point, outcome(finalist.point), arguments.options));
    }
    for (const std::size_t index : answer.rivals)
      fmt::print("  as fast within the interval  {}\n", setting_text(plan, index, outcome(index), arguments.options));
    fmt::print("  front of {} and {}:\n", arguments.options.cost, arguments.options.quantity);
    for (const std::size_t index : answer.front)
      fmt::print("    {}\n", setting_text(plan, index, outcome(index), arguments.options));
  }
  if (arguments.as_json) fmt::print("{}\n", out.dump(2));
  return interrupted || !found_all ? kFailed : kDone;
}

}  // namespace

void add_sweep_questions(cli::App& sweep, std::vector<Command>& commands) {
  add_compare_command(sweep, commands);
  auto arguments = std::make_shared<TuneArguments>();
  cli::App* app = sweep.add_subcommand("tune", "Find the cheapest setting of a spec whose error stays below a bound");
  app->add_option("spec", arguments->spec,
                  "a file SPEC.toml, or the name of a built-in spec: the settings to choose from")
      ->required();
  app->add_option("--store", arguments->store, "where the measured points go; points that it holds cost nothing")
      ->required();
  app->add_option("--quantity", arguments->options.quantity, "what is bounded: a column of the rows")
      ->capture_default_str();
  app->add_option("--below", arguments->below, "the quantity's largest acceptable value");
  app->add_option("--at-least", arguments->at_least, "the quantity's least acceptable value, for psnr or ssim");
  app->add_option("--cost", arguments->options.cost, "what is to be small: a column of the rows")
      ->capture_default_str();
  app->add_option(
         "--share", arguments->options.share,
         "the part of a scene's settings that may be drawn (six in any case); a finalist that is timed again counts")
      ->check(cli::Range(0.0, 1.0))
      ->capture_default_str();
  app->add_option("--device", arguments->devices, "EGL device of the worker (pellucid devices)")->delimiter(',');
  app->add_option("--references", arguments->references, "folder of traced references (default: STORE.references)");
  app->add_flag("--quiet", arguments->quiet, "no progress");
  app->add_flag("--json", arguments->as_json, "print the answer, the front and the evidence as JSON");
  app->footer(
      "Example: pellucid sweep tune my.toml --store my.db --quantity flip_mean --below 0.02\n"
      "Each scene, view and size is a question of its own. The settings that seem cheapest are timed again in turns, "
      "so that\na busy machine does not decide. Status 1: a question has no acceptable setting.");
  commands.push_back({app, [arguments] { return tune_command(*arguments); }});
}

}  // namespace pellucid::sandbox
