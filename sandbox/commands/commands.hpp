#pragma once

#include <functional>
#include <vector>

#include <CLI/CLI.hpp>

namespace pellucid::sandbox {

/// Exit statuses of the program.
enum Status { kDone = 0, kFailed = 1, kBadInput = 2, kRegression = 3 };

/// A sub-command: declared on the root, run after parsing. Errors leave `run` as exceptions (gl/error.hpp); main prints
/// them. Data goes to standard output, everything else to standard error.
struct Command {
  CLI::App* app = nullptr;
  std::function<int()> run;
};

// Each adds its sub-commands (one or more) to `root`.
void add_list(CLI::App& root, std::vector<Command>&);              ///< list, describe, devices
void add_render(CLI::App& root, std::vector<Command>&);            ///< render
void add_reference(CLI::App& root, std::vector<Command>&);         ///< reference
void add_compare(CLI::App& root, std::vector<Command>&);           ///< compare
void add_sweep(CLI::App& root, std::vector<Command>&);             ///< sweep run, sweep status, the hidden worker, and
void add_sweep_merge(CLI::App& sweep, std::vector<Command>&);      ///< … sweep merge
void add_sweep_questions(CLI::App& sweep, std::vector<Command>&);  ///< … sweep compare, sweep tune
void add_sweep_slurm(CLI::App& sweep, std::vector<Command>&);      ///< … sweep slurm
void add_results(CLI::App& root, std::vector<Command>&);           ///< results, table
void add_bench(CLI::App& root, std::vector<Command>&);             ///< bench
void add_bundle(CLI::App& root, std::vector<Command>&);            ///< bundle
void add_plot(CLI::App& root, std::vector<Command>&);              ///< plot
void add_reproduce(CLI::App& root, std::vector<Command>&);         ///< reproduce

}  // namespace pellucid::sandbox
