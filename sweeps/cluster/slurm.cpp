#include "sweeps/cluster/slurm.hpp"

#include <array>
#include <cstdio>
#include <fstream>
#include <memory>
#include <sstream>

#include <fmt/format.h>

#include "algorithms/scene/files/atomic_file.hpp"
#include "gl/error.hpp"
#include "sweeps/spec/provenance.hpp"

namespace pellucid::sweeps {
namespace {

/// The lines that tell sbatch what a job needs.
std::string heading(const SlurmOptions& o, const std::string& job, bool array, bool gpu) {
  std::string text = "#!/bin/bash\n";
  const auto option = [&](const std::string& words) { text += fmt::format("#SBATCH {}\n", words); };
  option(fmt::format("--job-name={}-{}", o.name, job));
  option(fmt::format("--output={}/logs/{}-%{}.log", o.folder.string(), job, array ? "A_%a" : "j"));
  option("--open-mode=append");  // a requeued task goes on in the same log
  option("--requeue");
  option("--ntasks=1");
  if (array) {
    option(fmt::format("--array=1-{}{}", o.shards, o.at_once > 0 ? fmt::format("%{}", o.at_once) : ""));
    option("--signal=B:USR1@120");  // two minutes before the time is up
  }
  if (!o.partition.empty()) option("--partition=" + o.partition);
  if (!o.account.empty()) option("--account=" + o.account);
  if (!o.time.empty()) option("--time=" + o.time);
  if (gpu && !o.gpus_per_task.empty()) option("--gpus-per-task=" + o.gpus_per_task);
  if (gpu && o.cpus_per_task > 0) option(fmt::format("--cpus-per-task={}", o.cpus_per_task));
  if (gpu && !o.constraint.empty()) option("--constraint=" + o.constraint);
  for (const std::string& more : o.sbatch)
    option(more);
  return text;
}

/// The names that all scripts use.
std::string names(const SlurmOptions& o) {
  return fmt::format("program={}\nspec={}\nfolder={}\nreferences={}\n", shell_word(o.program), shell_word(o.spec),
                     shell_word(o.folder.string()), shell_word(o.references.string()));
}

std::string references_script(const SlurmOptions& o) {
  return heading(o, "references", false, true) + "# Traces the references once, for all shards.\nset -euo pipefail\n" +
         names(o) + "\"$program\" sweep references \"$spec\" --references \"$references\" --quiet\n";
}

std::string shard_script(const SlurmOptions& o, bool timed) {
  const std::string job = timed ? "timing" : "quality";
  std::string text = heading(o, job, true, true);
  if (timed) text += "#SBATCH --exclusive\n";
  text += timed ? "# Measures one shard of the timed points, alone on its node.\n"
                : "# Measures one shard of the untimed points; its node may have other work.\n";
  text += "set -uo pipefail\n" + names(o);
  text += fmt::format("shard=$SLURM_ARRAY_TASK_ID/{}\nkept=$folder/shards/{}-$SLURM_ARRAY_TASK_ID.db\nkind={}\n",
                      o.shards, job, timed ? "timed" : "untimed");
  return text + R"sh(rm -f "${kept%.db}.done"  # says to the merge that nothing is left of this shard

# The store lies on the node's own disk while it grows, and is copied back whole.
disk=$(mktemp -d "${SLURM_TMPDIR:-${TMPDIR:-/tmp}}/pellucid-XXXXXX") || exit 1
store=$disk/sweep.db
if [ -s "$kept" ]; then cp "$kept" "$store" || exit 1; fi  # a requeued task goes on where it was

keep() {
  [ -s "$store" ] || return 0
  # Names of its own: when the sweep ends, the keeper below may be at it too.
  local copy=$disk/copy.$BASHPID.db part=$kept.$BASHPID.part
  rm -f "$copy"
  "$program" sweep merge "$copy" "$store" 2> "$disk/words" && cp "$copy" "$part" && mv "$part" "$kept"
}

warned=no
"$program" sweep run "$spec" --store "$store" --shard "$shard" --only "$kind" --references "$references" --quiet --json > "$disk/summary.json" &
sweep=$!
trap 'warned=yes; kill -USR1 "$sweep"' USR1  # the time is nearly up: end when the point in work is done
trap 'kill -TERM "$sweep"' TERM              # preempted: end at once
(while sleep "${PELLUCID_KEEP_S:-60}"; do keep; done) &
keeper=$!
wait "$sweep"
status=$?
while kill -0 "$sweep" 2>/dev/null; do  # a signal ends `wait` early
  wait "$sweep"
  status=$?
done
kill "$keeper" 2>/dev/null
wait "$keeper" 2>/dev/null
if keep; then
  if grep -q '"left": 0,' "$disk/summary.json"; then : > "${kept%.db}.done"; fi
  rm -rf -- "$disk"
else
  echo "$store cannot be copied to $kept, and stays where it is; $(tail -n 1 "$disk/words")" >&2
  status=1
fi
rm -f "$kept".*.part  # of a copy that was broken off
if [ "$warned" = yes ] && [ "$status" -ne 0 ]; then
  scontrol requeue "${SLURM_ARRAY_JOB_ID}_$SLURM_ARRAY_TASK_ID"
fi
exit "$status"
)sh";
}

/// The arrays that measure; a sweep may have points of one kind only.
std::vector<std::string> measuring(const SlurmOptions& o) {
  std::vector<std::string> arrays;
  if (o.untimed) arrays.emplace_back("quality");
  if (o.timed) arrays.emplace_back("timing");
  return arrays;
}

std::string merge_script(const SlurmOptions& o) {
  const std::vector<std::string> arrays = measuring(o);
  return heading(o, "merge", false, false) +
         "# Joins the shards, whatever became of single tasks, and tells which are not done.\nset -euo pipefail\n" +
         names(o) + fmt::format("arrays=\"{}\"\ntasks={}\n", fmt::join(arrays, " "), o.shards) + R"(
# A task that was requeued when it had ended runs again, though this job has waited for all.
cd "$folder"
numbers=()
for array in $arrays; do numbers+=($(awk -v array="$array" '$1 == array {print $2}' jobs)); done
at_work=$(IFS=,; squeue --noheader --array --format=%i --jobs="${numbers[*]}" 2>/dev/null | xargs) || true
if [ -n "$at_work" ]; then
  echo "these tasks are at work again: $at_work; the merge waits for them once more"
  again=$(IFS=:; sbatch --parsable --dependency="afterany:${numbers[*]}" merge.sbatch)
  sed -i "s/^merge .*/merge ${again%%;*}/" jobs
  exit 0
fi

missing=
for array in $arrays; do
  for ((task = 1; task <= tasks; ++task)); do
    [ -e "shards/$array-$task.done" ] || missing="$missing $array-$task"
  done
done
shopt -s nullglob
shards=("$folder"/shards/*.db)
if [ "${#shards[@]}" -eq 0 ]; then
  echo "no shard has left a store" >&2
  exit 1
fi
"$program" sweep merge "$folder/all.db" "${shards[@]}"
"$program" sweep status "$folder/all.db" | tee "$folder/status.txt"
"$program" results "$folder/all.db" > "$folder/results.csv"
if [ -n "$missing" ]; then
  echo "these tasks have not said that they are done, so that points may be missing:$missing" | tee -a "$folder/status.txt" >&2
  exit 1
fi
)";
}

std::string submit_script(const SlurmOptions& o) {
  std::string text = "#!/bin/sh\n# Submits the jobs, each after what it needs; `jobs` keeps their numbers.\nset -eu\n";
  text += fmt::format("cd {}\n", shell_word(o.folder.string()));
  text += "submit() { id=$(sbatch --parsable \"$@\"); echo \"${id%%;*}\"; }\n";
  std::string after;  // the shards go on without references if need be: they trace what is missing
  std::string shards;
  text += ": > jobs\nrm -f shards/*.done\n";
  const auto job = [&](const std::string& name, const std::string& dependency) {
    text += fmt::format("{0}=$(submit {1}{0}.sbatch)\necho \"{0} ${0}\" >> jobs\n", name, dependency);
  };
  if (o.metrics) {
    job("references", "");
    after = "--dependency=afterany:$references ";
  }
  for (const std::string& name : measuring(o)) {
    job(name, after);
    shards += fmt::format(":${}", name);
  }
  job("merge", fmt::format("--dependency=afterany{} ", shards));  // one lost task does not sink the rest
  return text + "cat jobs\n";
}

}  // namespace

std::map<std::string, std::string> slurm_scripts(const SlurmOptions& options) {
  SlurmOptions o = options;
  if (o.references.empty()) o.references = o.folder / "references";
  std::map<std::string, std::string> scripts;
  if (o.metrics) scripts["references.sbatch"] = references_script(o);
  if (o.untimed) scripts["quality.sbatch"] = shard_script(o, false);
  if (o.timed) scripts["timing.sbatch"] = shard_script(o, true);
  scripts["merge.sbatch"] = merge_script(o);
  scripts["submit.sh"] = submit_script(o);
  return scripts;
}

void write_slurm_scripts(const SlurmOptions& options) {
  std::error_code error;
  for (const char* folder : {"logs", "shards"}) {
    std::filesystem::create_directories(options.folder / folder, error);
    if (error) {
      throw RuntimeError(
          fmt::format("folder '{}' cannot be made: {}", (options.folder / folder).string(), error.message()));
    }
  }
  for (const auto& [name, text] : slurm_scripts(options))
    write_text_file(options.folder / name, text);
}

std::map<std::string, std::string> slurm_jobs(const std::filesystem::path& folder) {
  std::map<std::string, std::string> jobs;
  std::ifstream file(folder / "jobs");
  std::string name;
  std::string id;
  while (file >> name >> id)
    jobs[name] = id;
  return jobs;
}

std::map<std::string, std::size_t> slurm_states(const std::string& job) {
  const std::string command = shell_line({"squeue", "--noheader", "--array", "--format=%T", "--jobs=" + job});
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(::popen((command + " 2>&1").c_str(), "r"), &::pclose);
  if (!pipe) throw RuntimeError("squeue cannot be started");
  std::string text;
  std::array<char, 4096> chunk{};
  for (std::size_t n = 0; (n = std::fread(chunk.data(), 1, chunk.size(), pipe.get())) > 0;)
    text.append(chunk.data(), n);
  std::map<std::string, std::size_t> states;
  std::istringstream lines(text);
  for (std::string state; std::getline(lines, state);) {
    if (state.find("Invalid job id") != std::string::npos) return {};  // over, and forgotten
    if (state.find(' ') != std::string::npos) throw RuntimeError("squeue: " + state);
    ++states[state];
  }
  return states;
}

}  // namespace pellucid::sweeps
