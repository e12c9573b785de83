#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "algorithms/technique.hpp"
#include "algorithms/technique_code.hpp"
#include "gl/error.hpp"
#include "sandbox/commands/commands.hpp"
#include "sweeps/spec/plan.hpp"
#include "sweeps/spec/point_json.hpp"
#include "sweeps/spec/spec.hpp"
#include "sweeps/store/store.hpp"
#include "sweeps/workers/progress.hpp"
#include "sweeps/workers/run.hpp"
#include "sweeps/workers/worker.hpp"

namespace pellucid::sandbox {
namespace {

using nlohmann::json;
using namespace pellucid::sweeps;

struct SweepArguments {
  std::string spec;
  std::string store;
  std::optional<int> device;
  std::size_t limit = 0;
  bool preview = false, dry_run = false, retry_failed = false, quiet = false, as_json = false;
};

/// What a store holds of a plan's points; empty when there is no store yet.
std::map<std::string, StoredPoint> stored_points(const std::string& path) {
  std::map<std::string, StoredPoint> result;
  std::error_code error;
  if (path.empty() || !std::filesystem::exists(path, error)) return result;
  for (StoredPoint& point : Store(path, Access::read).points())
    result.emplace(point.id, std::move(point));
  return result;
}

std::vector<BlockStatus> count_blocks(const Spec& spec, const Plan& plan,
                                      const std::map<std::string, StoredPoint>& stored) {
  std::vector<BlockStatus> blocks;
  for (const Member& member : plan.members) {
    if (blocks.empty() || blocks.back().block != member.block) blocks.push_back({spec.name, member.block, 0, 0, 0});
    BlockStatus& status = blocks.back();
    ++status.planned;
    const auto found = stored.find(plan.points[member.point].id);
    if (found != stored.end()) ++(found->second.failed ? status.failed : status.done);
  }
  return blocks;
}

void print_status(const std::vector<BlockStatus>& blocks, bool as_json) {
  if (as_json) {
    json out = json::array();
    for (const BlockStatus& b : blocks) {
      out.push_back({{"sweep", b.sweep},
                     {"block", b.block},
                     {"planned", b.planned},
                     {"done", b.done},
                     {"failed", b.failed},
                     {"left", b.left()}});
    }
    fmt::print("{}\n", out.dump(2));
    return;
  }
  std::size_t width = 5;
  for (const BlockStatus& b : blocks)
    width = std::max({width, b.block.size(), b.sweep.size()});
  fmt::print("{:{}}  {:{}}  {:>7}  {:>7}  {:>7}  {:>7}\n", "sweep", width, "block", width, "planned", "done", "failed",
             "left");
  BlockStatus total;
  for (const BlockStatus& b : blocks) {
    fmt::print("{:{}}  {:{}}  {:>7}  {:>7}  {:>7}  {:>7}\n", b.sweep, width, b.block, width, b.planned, b.done,
               b.failed, b.left());
    total.planned += b.planned;
    total.done += b.done;
    total.failed += b.failed;
  }
  if (blocks.size() > 1) {
    fmt::print("{:{}}  {:{}}  {:>7}  {:>7}  {:>7}  {:>7}\n", "", width, "total", width, total.planned, total.done,
               total.failed, total.left());
  }
}

/// Rows that code other than this program's has made: an older version, a later one, or shaders that were edited since.
std::size_t count_of_other_code(const std::vector<StoredPoint>& points) {
  std::map<std::string, std::string> current;
  for (const TechniqueInfo& info : techniques())
    current.emplace(info.name, code_hash(info.name));
  return static_cast<std::size_t>(std::count_if(points.begin(), points.end(), [&](const StoredPoint& point) {
    const auto code = current.find(point.technique);
    return code == current.end() || code->second != point.code_hash;
  }));
}

void print_other_code(const std::string& store) {
  const std::vector<StoredPoint> points = Store(store, Access::read).points();
  const std::size_t other = count_of_other_code(points);
  if (other == 0) return;
  fmt::print(stderr, "{} of the store's {} rows {} made by other code; `sweep run` measures their points anew\n", other,
             points.size(), other == 1 ? "was" : "were");
}

/// The points, the blocks and how long it may take, without GL.
int dry_run(const Spec& spec, const Plan& plan, const SweepArguments& arguments) {
  const auto stored = stored_points(arguments.store);
  double known_s = 0;
  std::size_t known = 0;
  std::size_t left = 0;
  double limit_s = 0;
  for (const Point& point : plan.points) {
    if (const auto found = stored.find(point.id); found != stored.end()) {
      known_s += found->second.wall_s;
      ++known;
      continue;
    }
    ++left;
    if (point.timing.enabled) limit_s += point.timing.max_seconds;
  }
  if (arguments.as_json) {
    json points = json::array();
    for (const std::size_t index : plan.order) {
      json point = point_to_json(plan.points[index]);
      point["repeat"] = repeat_command(plan.points[index]);
      point["stored"] = stored.contains(plan.points[index].id);
      points.push_back(std::move(point));
    }
    fmt::print("{}\n", points.dump(2));
    return kDone;
  }
  for (const std::size_t index : plan.order) {
    const Point& point = plan.points[index];
    fmt::print("{} {}{}\n", point.id, repeat_command(point), stored.contains(point.id) ? "  # stored" : "");
  }
  fmt::print("\n");
  print_status(count_blocks(spec, plan, stored), false);
  fmt::print("\n{} distinct points, {} to measure", plan.points.size(), left);
  if (known > 0 && left > 0) {
    fmt::print("; about {} at the stored points' pace",
               duration_text(known_s / static_cast<double>(known) * static_cast<double>(left)));
  }
  if (limit_s > 0) fmt::print("; at most {} of timing", duration_text(limit_s));
  fmt::print("\n");
  return kDone;
}

int print_summary(const Spec& spec, const SweepSummary& summary, const SweepArguments& arguments) {
  if (arguments.as_json) {
    const json drift = summary.baseline_drift ? json(*summary.baseline_drift) : json();
    fmt::print("{}\n", json{{"sweep", spec.name},
                            {"store", arguments.store},
                            {"planned", summary.planned},
                            {"reused", summary.reused},
                            {"measured", summary.measured},
                            {"failed", summary.failed},
                            {"unconverged", summary.unconverged},
                            {"left", summary.left},
                            {"interrupted", summary.interrupted},
                            {"baseline_drift_max", drift},
                            {"wall_s", summary.wall_s}}
                           .dump(2));
  }
  std::string line;
  const auto add = [&](const std::string& text) { line += (line.empty() ? "" : ", ") + text; };
  if (summary.measured > 0) add(fmt::format("{} measured", summary.measured));
  if (summary.reused > 0) add(fmt::format("{} in the store already", summary.reused));
  if (summary.unconverged > 0) add(fmt::format("{} unconverged", summary.unconverged));
  if (summary.failed > 0) add(fmt::format("{} failed", summary.failed));
  if (summary.left > 0) add(fmt::format("{} left", summary.left));
  if (summary.baseline_drift) add(fmt::format("baseline drift at most {:.1f} %", 100 * *summary.baseline_drift));
  const bool worked = summary.measured + summary.failed > 0;
  fmt::print(stderr, "{}{}: {} points: {}{} in {}\n", summary.interrupted ? "interrupted: " : "", spec.name,
             summary.planned, line, worked ? fmt::format("; {}", duration_text(summary.wall_s)) : "", arguments.store);
  if (summary.left > 0) fmt::print(stderr, "the same command goes on where this one stopped\n");
  return summary.interrupted || summary.failed > 0 ? kFailed : kDone;
}

int run(const SweepArguments& arguments) {
  const Spec spec =
      load_spec(arguments.spec, installed_catalogue(), arguments.preview ? Extent::preview : Extent::full);
  const Plan plan = make_plan(spec);
  if (arguments.dry_run) return dry_run(spec, plan, arguments);
  if (arguments.store.empty()) throw InputError("--store S.db is missing: where the rows go");
  RunOptions options;
  options.device = arguments.device;
  options.limit = arguments.limit;
  options.retry_failed = arguments.retry_failed;
  options.quiet = arguments.quiet;
  return print_summary(spec, run_sweep(spec, plan, arguments.store, options), arguments);
}

int status(const SweepArguments& arguments) {
  if (arguments.store.empty()) {
    if (arguments.preview) throw InputError("--preview goes with --store: a store knows its sweeps by itself");
    print_status(Store(arguments.spec, Access::read).status(), arguments.as_json);
    print_other_code(arguments.spec);
    return kDone;
  }
  const Spec spec =
      load_spec(arguments.spec, installed_catalogue(), arguments.preview ? Extent::preview : Extent::full);
  const auto stored = stored_points(arguments.store);
  print_status(count_blocks(spec, make_plan(spec), stored), arguments.as_json);
  if (!stored.empty()) print_other_code(arguments.store);
  return kDone;
}

}  // namespace

void add_sweep(cli::App& root, std::vector<Command>& commands) {
  cli::App* sweep = root.add_subcommand("sweep", "Measure a technique over its parameters");
  sweep->require_subcommand(1);
  sweep->footer("The format of a spec, and what resuming means: sweeps/README.md");

  auto running = std::make_shared<SweepArguments>();
  cli::App* run_app = sweep->add_subcommand("run", "Measure every point of a spec that the store does not hold");
  run_app->add_option("spec", running->spec, "a file SPEC.toml, or the name of a built-in spec")->required();
  run_app->add_option("--store", running->store, "SQLite file that rows go to; made when missing");
  run_app->add_flag("--preview", running->preview, "the spec as its [preview] changes it: a quick run");
  run_app->add_flag("--dry-run", running->dry_run, "expand and check the spec, print its points, draw nothing");
  run_app->add_option("--device", running->device, "EGL device of the workers (pellucid devices)");
  run_app->add_option("--limit", running->limit, "stop after so many points")
      ->check(cli::Range(std::size_t{1}, std::size_t{1} << 30));
  run_app->add_flag("--retry-failed", running->retry_failed, "measure points again that are recorded as failed");
  run_app->add_flag("--quiet", running->quiet, "no progress");
  run_app->add_flag("--json", running->as_json, "print the summary (with --dry-run: the points) as JSON");
  run_app->footer(
      "Examples:\n"
      "  pellucid sweep run my.toml --store my.db\n"
      "  pellucid sweep run my.toml --preview --store quick.db\n"
      "  pellucid sweep run my.toml --dry-run\n"
      "A sweep that was stopped or killed goes on when it is run again. Status 1: interrupted, or a point failed.");
  commands.push_back({run_app, [running] { return run(*running); }});

  auto asking = std::make_shared<SweepArguments>();
  cli::App* status_app = sweep->add_subcommand("status", "Count the points that are done, failed and left, by block");
  status_app->add_option("store_or_spec", asking->spec, "a store; with --store, a spec")->required();
  status_app->add_option("--store", asking->store, "the store to count a spec's points in");
  status_app->add_flag("--preview", asking->preview, "with --store: of the spec's preview");
  status_app->add_flag("--json", asking->as_json, "print JSON");
  status_app->footer(
      "Examples:\n  pellucid sweep status results/hulls.db\n  pellucid sweep status my.toml --store my.db --json");
  commands.push_back({status_app, [asking] { return status(*asking); }});

  auto device = std::make_shared<std::optional<int>>();
  cli::App* worker_app = root.add_subcommand("worker", "Measure the points that `sweep run` sends");
  worker_app->group("");  // not for people
  worker_app->add_option("--device", *device, "EGL device");
  commands.push_back({worker_app, [device] { return run_worker(*device); }});
}

}  // namespace pellucid::sandbox
