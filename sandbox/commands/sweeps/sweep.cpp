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

#include "algorithms/scene/files/tell.hpp"
#include "algorithms/technique.hpp"
#include "algorithms/technique_code.hpp"
#include "gl/error.hpp"
#include "sandbox/commands/commands.hpp"
#include "sandbox/commands/sweeps/sweep_dry_run.hpp"
#include "sweeps/cluster/slurm.hpp"
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
  std::string shard, references, only;
  std::vector<int> devices;
  std::size_t limit = 0;
  std::size_t fail_after = 0;
  bool preview = false, dry_run = false, list = false, retry_failed = false, quiet = false, as_json = false;
};

json blocks_json(const std::vector<BlockStatus>& blocks) {
  json out = json::array();
  for (const BlockStatus& b : blocks) {
    out.push_back({{"sweep", b.sweep},
                   {"block", b.block},
                   {"planned", b.planned},
                   {"done", b.done},
                   {"failed", b.failed},
                   {"left", b.left()}});
    if (!b.device.empty()) out.back()["device"] = b.device;
  }
  return out;
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
  tell("{} of the store's {} rows {} made by other code; `sweep run` measures their points anew", other, points.size(),
       other == 1 ? "was" : "were");
}

/// Where the wall time of a store's runs went, a line for each sweep and device.
void print_runs(const std::vector<RunRecord>& runs) {
  std::map<std::string, RunRecord> sums;
  for (const RunRecord& run : runs) {
    RunRecord& sum = sums[fmt::format("{} on {}", run.sweep, run.device)];
    sum.wall_s += run.wall_s;
    sum.measuring_s += run.measuring_s;
    sum.starting_s += run.starting_s;
    sum.storing_s += run.storing_s;
    sum.points += run.points;
  }
  for (const auto& [name, sum] : sums) {
    if (!(sum.wall_s > 0)) continue;
    const double rest_s = std::max(0.0, sum.wall_s - sum.measuring_s - sum.starting_s - sum.storing_s);
    fmt::print(
        "{}: {} points in {}: {:.1f} % drawing, timing and measuring; {:.1f} s starting workers, {:.1f} s storing, "
        "{:.1f} s else\n",
        name, sum.points, duration_text(sum.wall_s), 100 * sum.measuring_s / sum.wall_s, sum.starting_s, sum.storing_s,
        rest_s);
  }
}

int print_summary(const Spec& spec, const SweepSummary& summary, const SweepArguments& arguments) {
  if (arguments.as_json) {
    const json drift = summary.baseline_drift ? json(*summary.baseline_drift) : json();
    fmt::print("{}\n", json{{"sweep", spec.name},
                            {"store", arguments.store},
                            {"shard", arguments.shard.empty() ? json() : json(arguments.shard)},
                            {"device", summary.device},
                            {"planned", summary.planned},
                            {"reused", summary.reused},
                            {"measured", summary.measured},
                            {"failed", summary.failed},
                            {"unconverged", summary.unconverged},
                            {"left", summary.left},
                            {"interrupted", summary.interrupted},
                            {"gave_up", summary.gave_up},
                            {"baseline_drift_max", drift},
                            {"wall_s", summary.wall_s}}
                           .dump(2));
  }
  std::string line;
  const auto add = [&](const std::string& text) { line += (line.empty() ? "" : ", ") + text; };
  if (summary.measured > 0) add(fmt::format("{} measured", summary.measured));
  if (summary.reused > 0) {
    add(fmt::format(
        "{} in the store already{}", summary.reused,
        summary.measured + summary.failed == 0 && !summary.device.empty() ? ", measured on " + summary.device : ""));
  }
  if (summary.unconverged > 0) add(fmt::format("{} unconverged", summary.unconverged));
  if (summary.failed > 0) add(fmt::format("{} failed", summary.failed));
  if (summary.left > 0) add(fmt::format("{} left", summary.left));
  if (summary.baseline_drift) add(fmt::format("baseline drift at most {:.1f} %", 100 * *summary.baseline_drift));
  const bool worked = summary.measured + summary.failed > 0;
  const std::string part = arguments.shard.empty() ? "" : fmt::format(" (shard {})", arguments.shard);
  tell("{}{}{}: {} points: {}{} in {}",
       summary.interrupted ? "interrupted: "
       : summary.gave_up   ? "gave up: "
                           : "",
       spec.name, part, summary.planned, line, worked ? fmt::format("; {}", duration_text(summary.wall_s)) : "",
       arguments.store);
  if (summary.left > 0) tell("the same command goes on where this one stopped");
  return summary.interrupted || summary.failed > 0 ? kFailed : kDone;
}

Spec load_spec_of(const SweepArguments& arguments) {
  return load_spec(arguments.spec, installed_names(), arguments.preview ? Extent::preview : Extent::full);
}

int run(const SweepArguments& arguments) {
  const Spec spec = load_spec_of(arguments);
  const Plan plan = make_plan(spec);
  if (arguments.list && !arguments.dry_run) throw InputError("--list is of --dry-run");
  if (arguments.dry_run) {
    if (arguments.as_json) {
      print_dry_run_json(plan, arguments.store);
    } else {
      print_dry_run(spec, plan, arguments.store, arguments.list);
    }
    return kDone;
  }
  if (arguments.store.empty()) throw InputError("--store S.db is missing: where the rows go");
  RunOptions options;
  options.devices = arguments.devices;
  if (!arguments.shard.empty()) options.shard = parse_shard(arguments.shard);
  if (!arguments.references.empty()) options.references = arguments.references;
  if (!arguments.only.empty()) options.timed = arguments.only == "timed";
  options.limit = arguments.limit;
  options.fail_after = arguments.fail_after;
  options.retry_failed = arguments.retry_failed;
  options.quiet = arguments.quiet;
  return print_summary(spec, run_sweep(spec, plan, arguments.store, options), arguments);
}

/// Traces all references into one folder, before shards that share it.
int references(const SweepArguments& arguments) {
  const Spec spec = load_spec_of(arguments);
  RunOptions options;
  options.devices = arguments.devices;
  options.quiet = arguments.quiet;
  const ReferencesSummary summary = trace_references(spec, make_plan(spec), arguments.references, options);
  tell("{}{}: {} references: {} in {}, {} failed", summary.interrupted ? "interrupted: " : "", spec.name,
       summary.planned, summary.done, arguments.references, summary.failures.size());
  return summary.interrupted || !summary.failures.empty() ? kFailed : kDone;
}

/// Queue and progress of a folder that `sweep slurm` made.
int cluster_status(const std::filesystem::path& folder, bool as_json) {
  json jobs = json::object();
  for (const auto& [name, id] : slurm_jobs(folder)) {
    const auto states = slurm_states(id);
    jobs[name] = {{"id", id}, {"tasks", states}};
    std::string text;
    for (const auto& [state, tasks] : states)
      text += fmt::format("{}{} {}", text.empty() ? "" : ", ", tasks, state);
    if (!as_json) fmt::print("{:12} {:>10}  {}\n", name, id, text.empty() ? "over" : text);
  }
  std::map<std::string, BlockStatus> sums;
  std::vector<std::string> order;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder / "shards", error)) {
    if (entry.path().extension() != ".db") continue;
    for (const BlockStatus& block : Store(entry.path(), Access::read).status()) {
      const auto [at, is_new] = sums.try_emplace(block.sweep + " " + block.block + " " + block.device, block);
      if (is_new) order.push_back(at->first);
      if (is_new) continue;
      at->second.done += block.done;
      at->second.failed += block.failed;
    }
  }
  if (error) throw InputError(fmt::format("'{}' is no folder of `sweep slurm`", folder.string()));
  std::vector<BlockStatus> blocks;
  const bool started =
      std::any_of(sums.begin(), sums.end(), [](const auto& sum) { return !sum.second.device.empty(); });
  for (const std::string& key : order) {
    // A shard that has no row yet knows no device; its points are left in the others' counts.
    if (!started || !sums.at(key).device.empty()) blocks.push_back(sums.at(key));
  }
  if (as_json) {
    fmt::print("{}\n", json{{"jobs", jobs}, {"blocks", blocks_json(blocks)}}.dump(2));
  } else {
    fmt::print("\n");
    print_blocks(blocks);
  }
  return kDone;
}

int status(const SweepArguments& arguments) {
  std::error_code error;
  if (arguments.store.empty() && std::filesystem::is_directory(arguments.spec, error))
    return cluster_status(arguments.spec, arguments.as_json);
  std::vector<BlockStatus> blocks;
  std::vector<RunRecord> runs;
  if (arguments.store.empty()) {
    if (arguments.preview) throw InputError("--preview goes with --store: a store knows its sweeps by itself");
    const Store store(arguments.spec, Access::read);
    blocks = store.status();
    runs = store.runs();
  } else {
    const Spec spec = load_spec_of(arguments);
    blocks = count_blocks(spec, make_plan(spec), stored_points(arguments.store));
  }
  if (arguments.as_json) {
    fmt::print("{}\n", blocks_json(blocks).dump(2));
    return kDone;
  }
  print_blocks(blocks);
  if (!runs.empty()) fmt::print("\n");
  print_runs(runs);
  const std::string store = arguments.store.empty() ? arguments.spec : arguments.store;
  if (std::filesystem::exists(store, error)) print_other_code(store);
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
  run_app->add_flag("--dry-run", running->dry_run, "expand and check the spec, count its points, draw nothing");
  run_app->add_flag("--list", running->list, "with --dry-run: print every point");
  run_app
      ->add_option("--device", running->devices,
                   "EGL device of the worker (pellucid devices), or several of one model: --device 0,1,3")
      ->delimiter(',');
  run_app->add_option("--shard", running->shard,
                      "measure only part i of N, as --shard 2/16; `sweep merge` joins the stores");
  run_app->add_option("--only", running->only, "measure only points that are timed, or untimed")
      ->check(cli::IsMember({"timed", "untimed"}));
  run_app->add_option("--references", running->references,
                      "folder of traced references, which several sweeps may share (default: STORE.references)");
  run_app->add_option("--limit", running->limit, "stop after so many points")
      ->check(cli::Range(std::size_t{1}, std::size_t{1} << 30));
  run_app->add_option("--fail-after", running->fail_after, "give up when so many points have failed")
      ->check(cli::Range(std::size_t{1}, std::size_t{1} << 30));
  run_app->add_flag("--retry-failed", running->retry_failed, "measure points again that are recorded as failed");
  run_app->add_flag("--quiet", running->quiet, "no progress");
  run_app->add_flag("--json", running->as_json, "print the summary (with --dry-run: the points) as JSON");
  run_app->footer(
      "Examples:\n"
      "  pellucid sweep run my.toml --store my.db\n"
      "  pellucid sweep run my.toml --preview --store quick.db\n"
      "  pellucid sweep run my.toml --dry-run\n"
      "  pellucid sweep run my.toml --store part2.db --shard 2/4\n"
      "A sweep that was stopped or killed goes on when it is run again. Status 1: interrupted, or a point failed.");
  commands.push_back({run_app, [running] { return run(*running); }});

  auto tracing = std::make_shared<SweepArguments>();
  cli::App* references_app =
      sweep->add_subcommand("references", "Trace the references of a spec's points, for sweeps that share them");
  references_app->add_option("spec", tracing->spec, "a file SPEC.toml, or the name of a built-in spec")->required();
  references_app->add_option("--references", tracing->references, "the folder; what it holds is not traced again")
      ->required();
  references_app->add_option("--device", tracing->devices, "EGL device of the worker (pellucid devices)");
  references_app->add_flag("--preview", tracing->preview, "of the spec as its [preview] changes it");
  references_app->add_flag("--quiet", tracing->quiet, "no progress");
  references_app->footer(
      "Example: pellucid sweep references my.toml --references shared/references\n"
      "then, on each machine: pellucid sweep run my.toml --store part1.db --shard 1/4 --references shared/references");
  commands.push_back({references_app, [tracing] { return references(*tracing); }});

  auto asking = std::make_shared<SweepArguments>();
  cli::App* status_app = sweep->add_subcommand("status", "Count the points that are done, failed and left, by block");
  status_app->add_option("store_or_spec", asking->spec, "a store, or a folder of `sweep slurm`; with --store, a spec")
      ->required();
  status_app->add_option("--store", asking->store, "the store to count a spec's points in");
  status_app->add_flag("--preview", asking->preview, "with --store: of the spec's preview");
  status_app->add_flag("--json", asking->as_json, "print JSON");
  status_app->footer(
      "Examples:\n  pellucid sweep status results/hulls.db\n  pellucid sweep status my.toml --store my.db --json");
  commands.push_back({status_app, [asking] { return status(*asking); }});

  add_sweep_merge(*sweep, commands);
  add_sweep_questions(*sweep, commands);
  add_sweep_slurm(*sweep, commands);

  auto device = std::make_shared<std::optional<int>>();
  auto quiet = std::make_shared<std::string>();
  cli::App* worker_app = root.add_subcommand("worker", "Measure the points that `sweep run` sends");
  worker_app->group("");  // not for people
  worker_app->add_option("--device", *device, "EGL device");
  worker_app->add_option("--quiet-lock", *quiet, "file that the workers of several devices share");
  commands.push_back({worker_app, [device, quiet] { return run_worker(*device, *quiet); }});
}

}  // namespace pellucid::sandbox
