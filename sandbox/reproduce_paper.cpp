#include "sandbox/reproduce_paper.hpp"

#include <vector>

#include <fmt/format.h>

#include "gl/error.hpp"
#include "sandbox/commands/commands.hpp"
#include "sandbox/papers.hpp"
#include "sweeps/run.hpp"

namespace pellucid::sandbox {
namespace {

std::vector<const Paper*> wanted(std::string_view what) {
  std::vector<const Paper*> out;
  if (what != "all") return {&find_paper(what, std::vector<std::string_view>{"all"})};
  for (const Paper& paper : papers())
    out.push_back(&paper);
  return out;
}

}  // namespace

int reproduce_papers(const PaperOptions& options) {
  for (const Paper* paper : wanted(options.what)) {
    const std::filesystem::path folder = options.folder / paper->name;
    std::filesystem::create_directories(folder);
    for (const std::string_view name : options.preview ? paper->preview_specs : paper->specs) {
      const sweeps::Spec spec = sweeps::load_spec(std::string(name));
      sweeps::RunOptions run;
      run.device = options.device;
      const sweeps::SweepSummary summary = sweeps::run_sweep(spec, folder / fmt::format("{}.db", name), run);
      if (summary.interrupted) throw RuntimeError("interrupted; the same command goes on");
    }
  }
  return kDone;
}

}  // namespace pellucid::sandbox
