#pragma once

#include <functional>
#include <vector>

#include "sandbox/commands/command_line.hpp"
#include "sandbox/status.hpp"

namespace pellucid::sandbox {

/// A sub-command: declared on the root, run after parsing. Errors leave `run` as exceptions (gl/error.hpp); main prints
/// them. Data goes to standard output, everything else to standard error.
struct Command {
  cli::App* app = nullptr;
  std::function<int()> run;
};

// Each adds its sub-commands (one or more) to `root`.
void add_list(cli::App& root, std::vector<Command>&);       ///< list, describe, devices
void add_render(cli::App& root, std::vector<Command>&);     ///< render
void add_reference(cli::App& root, std::vector<Command>&);  ///< reference
void add_compare(cli::App& root, std::vector<Command>&);    ///< compare
void add_sweep(cli::App& root, std::vector<Command>&);      ///< sweep run, references, status, the hidden worker
void add_results(cli::App& root, std::vector<Command>&);    ///< results, table
void add_bench(cli::App& root, std::vector<Command>&);      ///< bench
void add_slab(cli::App& root, std::vector<Command>&);       ///< slab
void add_plot(cli::App& root, std::vector<Command>&);       ///< plot
void add_reproduce(cli::App& root, std::vector<Command>&);  ///< reproduce
void add_view(cli::App& root, std::vector<Command>&);       ///< view, and its hidden renderer
void add_bundle(cli::App& root, std::vector<Command>&);     ///< bundle

// The commands below `sweep`, called by add_sweep.
void add_sweep_merge(cli::App& sweep, std::vector<Command>&);      ///< merge
void add_sweep_questions(cli::App& sweep, std::vector<Command>&);  ///< compare, tune
void add_sweep_slurm(cli::App& sweep, std::vector<Command>&);      ///< slurm

}  // namespace pellucid::sandbox
