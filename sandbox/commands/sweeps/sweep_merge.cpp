// pellucid sweep merge.
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "algorithms/scene/files/tell.hpp"
#include "sandbox/commands/commands.hpp"
#include "sweeps/store/merge.hpp"

namespace pellucid::sandbox {
namespace {

using namespace pellucid::sweeps;

struct MergeArguments {
  std::string output, prefer;
  std::vector<std::string> inputs;
  bool as_json = false;
};

int merge(const MergeArguments& arguments) {
  const Prefer prefer = arguments.prefer == "oldest"   ? Prefer::oldest
                        : arguments.prefer == "newest" ? Prefer::newest
                                                       : Prefer::neither;
  const MergeSummary summary =
      merge_stores(arguments.output, {arguments.inputs.begin(), arguments.inputs.end()}, prefer);
  for (const std::string& conflict : summary.conflicts)
    tell("settled: {}", conflict);
  if (arguments.as_json) {
    fmt::print("{}\n", nlohmann::json{{"store", arguments.output},
                                      {"stores", summary.stores},
                                      {"rows", summary.rows},
                                      {"added", summary.added},
                                      {"duplicates", summary.duplicates},
                                      {"repeats", summary.repeats},
                                      {"conflicts", summary.conflicts}}
                           .dump(2));
  }
  tell("{}: {} rows; of {} stores {} rows added, {} there already, {} measured twice, {} conflicts", arguments.output,
       summary.rows, summary.stores, summary.added, summary.duplicates, summary.repeats, summary.conflicts.size());
  return kDone;
}

}  // namespace

void add_sweep_merge(cli::App& sweep, std::vector<Command>& commands) {
  auto arguments = std::make_shared<MergeArguments>();
  cli::App* app = sweep.add_subcommand("merge", "Join the stores of a sweep's shards, or of several devices, into one");
  app->add_option("output", arguments->output, "the store to add to; made when missing")->required();
  app->add_option("inputs", arguments->inputs, "stores, in any order")->required();
  app->add_option("--prefer", arguments->prefer,
                  "which row stays where a point was measured twice with different results: oldest or newest "
                  "(default: neither, which is an error)")
      ->check(cli::IsMember({"oldest", "newest"}));
  app->add_flag("--json", arguments->as_json, "print the counts as JSON");
  app->footer(
      "Example: pellucid sweep merge all.db part1.db part2.db part3.db\n"
      "Rows of different devices stay apart. All or nothing: when stores disagree, the output stays as it was.");
  commands.push_back({app, [arguments] { return merge(*arguments); }});
}

}  // namespace pellucid::sandbox
