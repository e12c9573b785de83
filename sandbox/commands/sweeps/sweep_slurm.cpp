// pellucid sweep slurm.
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <sys/wait.h>

#include "algorithms/scene/files/tell.hpp"
#include "gl/error.hpp"
#include "sandbox/commands/commands.hpp"
#include "sweeps/cluster/slurm.hpp"
#include "sweeps/spec/plan.hpp"
#include "sweeps/spec/provenance.hpp"

namespace pellucid::sandbox {
namespace {

using namespace pellucid::sweeps;

struct SlurmArguments {
  SlurmOptions options;
  std::string spec, folder, references;
  bool dry_run = false;
};

int slurm(SlurmArguments arguments) {
  const Spec spec = load_spec(arguments.spec);
  const Plan plan = make_plan(spec);
  SlurmOptions& options = arguments.options;
  options.name = spec.name;
  options.spec =
      arguments.spec.ends_with(".toml") ? std::filesystem::absolute(arguments.spec).string() : arguments.spec;
  options.folder = std::filesystem::absolute(arguments.folder.empty() ? spec.name + ".slurm" : arguments.folder);
  if (!arguments.references.empty()) options.references = std::filesystem::absolute(arguments.references);
  if (options.program.empty()) options.program = std::filesystem::read_symlink("/proc/self/exe").string();
  for (const Point& point : plan.points) {
    (point.timing.enabled ? options.timed : options.untimed) = true;
    options.metrics = options.metrics || !point.metrics.empty();
  }
  write_slurm_scripts(options);
  const std::string submit = (options.folder / "submit.sh").string();
  if (arguments.dry_run) {
    for (const auto& [name, text] : slurm_scripts(options))
      fmt::print("{}\n", (options.folder / name).string());
    tell("to submit them: sh {}", shell_word(submit));
    return kDone;
  }
  const int status = std::system(shell_line({"sh", submit}).c_str());  // NOLINT: our own script, in the foreground
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
    throw RuntimeError(fmt::format("{} did not submit everything; its words are above", submit));
  tell("submitted; to follow: pellucid sweep status {}", shell_word(options.folder.string()));
  return kDone;
}

}  // namespace

void add_sweep_slurm(cli::App& sweep, std::vector<Command>& commands) {
  auto arguments = std::make_shared<SlurmArguments>();
  SlurmOptions& options = arguments->options;
  cli::App* app = sweep.add_subcommand("slurm", "Run a sweep on a cluster: write Slurm batch scripts and submit them");
  app->add_option("spec", arguments->spec, "a file SPEC.toml, or the name of a built-in spec")->required();
  app->add_option("-o,--output", arguments->folder,
                  "folder for scripts, logs, shards and the merged all.db, on a file system that all nodes see "
                  "(default: NAME.slurm)");
  app->add_option("--shards", options.shards, "tasks that the points are divided among")
      ->check(cli::Range(std::size_t{1}, std::size_t{100'000}))
      ->capture_default_str();
  app->add_option("--at-once", options.at_once, "tasks of an array that run at a time (default: all)")
      ->check(cli::PositiveNumber);
  app->add_option("--partition", options.partition, "as sbatch takes it");
  app->add_option("--gpus-per-task", options.gpus_per_task, "as sbatch takes it, 1 or a100:1");
  app->add_option("--cpus-per-task", options.cpus_per_task, "as sbatch takes it")->check(cli::PositiveNumber);
  app->add_option("--constraint", options.constraint, "features of the nodes, so that all are of one kind");
  app->add_option("--time", options.time, "limit of a task; one that reaches it is requeued and goes on");
  app->add_option("--account", options.account, "as sbatch takes it");
  app->add_option("--sbatch", options.sbatch, "one more option of sbatch, as --sbatch=--mem=8G; repeatable");
  app->add_option("--references", arguments->references, "shared folder of traced references (default: in the output)");
  app->add_option("--program", options.program, "pellucid as the nodes see it (default: this program's path)");
  app->add_flag("--dry-run", arguments->dry_run, "write the scripts and submit nothing");
  app->footer(
      "Example: pellucid sweep slurm my.toml --partition gpu --gpus-per-task 1 --shards 16 --at-once 8 --constraint "
      "a100\n"
      "References are traced first; untimed points may share nodes, timed ones get nodes of their own. A preempted "
      "task\n"
      "goes on where it was. `pellucid sweep status NAME.slurm` follows queue and progress.");
  commands.push_back({app, [arguments] { return slurm(*arguments); }});
}

}  // namespace pellucid::sandbox
