#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

/// Sweeps on a cluster: Slurm runs them, this writes what it is to run.
namespace pellucid::sweeps {

struct SlurmOptions {
  std::filesystem::path folder;      ///< for scripts, logs, shards and results; on a file system that all nodes see
  std::filesystem::path references;  ///< the same; empty: FOLDER/references
  std::string program;               ///< path of pellucid on the nodes
  std::string spec;                  ///< absolute path, or the name of a built-in spec
  std::string name;                  ///< of the sweep
  std::string partition, gpus_per_task, constraint, time, account;  ///< as sbatch takes them; empty: not given
  int cpus_per_task = 0;                                            ///< 0: not given
  std::size_t shards = 1, at_once = 0;                              ///< at_once 0: all
  bool timed = false, untimed = false;                              ///< which kinds of points there are
  bool metrics = false;                                             ///< any point has a reference
  std::vector<std::string> sbatch;                                  ///< more options, a line each
};

/// The scripts by name: references.sbatch, quality.sbatch (untimed points; they may share nodes), timing.sbatch (timed
/// points, each on a node of its own), merge.sbatch and submit.sh, which submits them with their dependencies. Whatever
/// is not needed is not there.
std::map<std::string, std::string> slurm_scripts(const SlurmOptions&);

/// Writes them, and the folders that they need. Throws RuntimeError.
void write_slurm_scripts(const SlurmOptions&);

/// Jobs that submit.sh has noted in a folder, "timing" → "1234"; empty when nothing was submitted.
std::map<std::string, std::string> slurm_jobs(const std::filesystem::path& folder);

/// How many tasks of a job are in which state ("PENDING", "RUNNING", …), as squeue tells; those that are over are not
/// listed. Throws RuntimeError when squeue cannot be asked.
std::map<std::string, std::size_t> slurm_states(const std::string& job);

}  // namespace pellucid::sweeps
