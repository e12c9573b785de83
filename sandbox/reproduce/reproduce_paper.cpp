#include "sandbox/reproduce/reproduce_paper.hpp"

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdio>
#include <exception>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "algorithms/scene/files/atomic_file.hpp"
#include "algorithms/scene/files/tell.hpp"
#include "gl/error.hpp"
#include "plots/charts/chart.hpp"
#include "plots/figures/figures.hpp"
#include "plots/pictures/picture_sets.hpp"
#include "sandbox/arguments.hpp"
#include "sandbox/reproduce/reproduce_report.hpp"
#include "sandbox/status.hpp"
#include "sweeps/spec/clock.hpp"
#include "sweeps/spec/plan.hpp"
#include "sweeps/spec/provenance.hpp"
#include "sweeps/store/rows.hpp"
#include "sweeps/store/store.hpp"
#include "sweeps/workers/progress.hpp"

namespace pellucid::sandbox {
namespace {

using nlohmann::json;
using nlohmann::ordered_json;

std::vector<sweeps::PaperPointer> wanted(const std::string& what) {
  if (what == "all") return sweeps::papers();
  return {sweeps::load_paper(what, {"all"})};
}

void make_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw RuntimeError(fmt::format("cannot make folder '{}': {}", folder.string(), error.message()));
}

/// Adds the time of a part to the outcome when it is over, and says so.
class Part {
 public:
  Part(PaperOutcome& outcome, std::string name) : outcome_(outcome), name_(std::move(name)) {}
  void done() {
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    outcome_.seconds.emplace_back(name_, seconds);
    tell("{}: {}: {:.1f} s", outcome_.paper->name, name_, seconds);
  }

 private:
  PaperOutcome& outcome_;
  std::string name_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

void run_sweeps(const PaperOptions& options, const std::filesystem::path& folder, PaperOutcome& outcome) {
  // All specs are read before the first is measured: a mistake in the last shows at once.
  std::vector<std::pair<sweeps::Spec, std::string>> specs;
  for (const sweeps::PaperSweep& sweep : outcome.paper->sweeps) {
    const auto extent = options.preview ? sweeps::Extent::preview : sweeps::Extent::full;
    specs.emplace_back(sweeps::load_spec(sweep.spec, sweeps::installed_names(), extent),
                       sweeps::shell_word(sweep.spec) + (options.preview ? " --preview" : ""));
  }
  for (const auto& [spec, words] : specs) {
    tell("{}: sweep {}", outcome.paper->name, spec.name);
    SweepOutcome sweep{.name = spec.name,
                       .title = spec.title,
                       .words = words,
                       .store = (folder / (spec.name + ".db")).string(),
                       .summary = {},
                       .rows = {},
                       .kept = {}};
    sweeps::RunOptions run;
    if (options.device) run.devices = {*options.device};
    run.references = folder / "references";  // one paper's sweeps look at the same scenes
    const sweeps::Plan plan = sweeps::make_plan(spec);
    sweep.summary = sweeps::run_sweep(spec, plan, sweep.store, run);
    if (sweep.summary.interrupted) throw RuntimeError("interrupted; the same command goes on where this one stopped");
    sweep.rows = sweeps::read_rows(sweep.store);
    sweep.kept = kept_pictures(plan, sweep.store, folder / "thumbnails" / spec.name);
    outcome.sweeps.push_back(std::move(sweep));
  }
}

// The device that the sweeps ran on; empty when no row tells.
std::string device_of(const PaperOutcome& outcome) {
  for (const SweepOutcome& sweep : outcome.sweeps) {
    for (const json& row : sweep.rows) {
      if (std::string device = sweeps::text(row, "device"); !device.empty()) return device;
    }
  }
  return "";
}

// Two sets at a time: much of a picture is work for one core alone, and none of it is timed.
void draw_all_pictures(const PaperOptions& options, const std::filesystem::path& folder, PaperOutcome& outcome) {
  const std::vector<plots::PictureSet> sets = plots::read_pictures(*outcome.paper);
  outcome.pictures.resize(sets.size());
  const auto draw = [&](std::size_t i) {
    const plots::PictureSet& set = sets[i];
    PictureOptions drawing{.folder = folder / "pictures" / set.name,
                           .device = options.device,
                           .preview = options.preview,
                           .made_on = device_of(outcome),
                           .say = {}};
    drawing.say = [&](const std::string& what) { tell("{}: {}: {}", outcome.paper->name, set.name, what); };
    PicturesOutcome& result = outcome.pictures[i];
    result.name = set.name;
    result.title = set.title;
    result.folder = fmt::format("{}/pictures/{}", outcome.folder, set.name);
    try {
      make_folder(drawing.folder);
      result.drawn = draw_pictures(set, drawing);
    } catch (const std::exception& e) {
      // The sweeps before it may have taken hours: the report shows them, and why this is missing.
      result.missing = e.what();
      tell("{}: {}: not drawn: {}", outcome.paper->name, set.name, e.what());
    }
  };
  std::atomic<std::size_t> next = 0;
  const auto draw_those_left = [&] {
    for (std::size_t i = next++; i < sets.size(); i = next++)
      draw(i);
  };
  std::thread other(draw_those_left);
  draw_those_left();
  other.join();
}

void write_tables(const std::filesystem::path& folder, PaperOutcome& outcome) {
  make_folder(folder / "tables");
  for (const std::string& name : sweeps::entry_names(*outcome.paper, "tables")) {
    const sweeps::PaperEntry entry{outcome.paper, name};
    const SweepOutcome* sweep = outcome.sweep_of(sweeps::find_table(entry).spec);
    const sweeps::Table table = sweeps::make_table(entry, sweep == nullptr ? std::vector<json>{} : sweep->rows);
    using enum sweeps::TableFormat;
    for (const auto& [format, extension] : {std::pair{markdown, ".md"}, std::pair{csv, ".csv"},
                                            std::pair{latex, ".tex"}, std::pair{sweeps::TableFormat::json, ".json"}})
      write_text_file(folder / "tables" / (name + extension), format_table(table, format));
    outcome.tables.push_back({.table = table, .path = outcome.folder + "/tables/" + name});
  }
}

void write_figures(const std::filesystem::path& folder, PaperOutcome& outcome) {
  make_folder(folder / "figures");
  for (const plots::Figure& drawn : plots::read_figures(outcome.paper)) {
    FigureOutcome figure{
        .name = drawn.full_name, .title = drawn.title, .doc = drawn.doc, .path = {}, .missing = {}, .repeat = {}};
    const bool worked_out = drawn.sweep.empty();
    const SweepOutcome* sweep = worked_out ? nullptr : outcome.sweep_of(drawn.sweep);
    if (sweep == nullptr && !worked_out) {
      figure.missing = fmt::format("the paper's sweeps have no {}", drawn.sweep);
    } else {
      const std::filesystem::path base = folder / "figures" / drawn.name;
      try {
        const plots::Drawn drawing =
            plots::draw_figure(drawn, worked_out ? std::vector<nlohmann::json>() : sweep->rows);
        for (const char* extension : {".svg", ".png", ".pdf"})
          plots::write_svg_as(drawing.svg, base.string() + extension);
        write_text_file(base.string() + ".csv", drawing.csv);
        figure.path = outcome.folder + "/figures/" + drawn.name;
      } catch (const InputError& e) {
        figure.missing = e.what();  // nothing left to draw when its points failed: the report says so
      }
      figure.repeat = fmt::format("pellucid plot {}{} -o {}", sweeps::shell_word(outcome.paper->address(drawn.name)),
                                  worked_out ? "" : " --store " + sweeps::shell_word(sweep->store),
                                  sweeps::shell_word(base.string() + ".svg"));
    }
    outcome.figures.push_back(std::move(figure));
  }
}

PaperOutcome reproduce(const sweeps::PaperPointer& paper, const PaperOptions& options) {
  PaperOutcome outcome;
  outcome.paper = paper;
  outcome.preview = options.preview;
  outcome.folder = paper->name;
  outcome.started_utc = sweeps::utc_text(sweeps::unix_now_s());
  std::vector<std::string> command = process_arguments();
  if (!command.empty()) command.front() = "pellucid";
  outcome.command = sweeps::shell_line(command);
  if (options.device) outcome.device_option = fmt::format(" --device {}", *options.device);
  const std::filesystem::path folder = options.folder / paper->name;
  make_folder(folder);
  Part sweeping(outcome, "sweeps");
  run_sweeps(options, folder, outcome);
  sweeping.done();
  Part drawing(outcome, "pictures");
  draw_all_pictures(options, folder, outcome);
  drawing.done();
  Part writing(outcome, "tables and figures");
  write_tables(folder, outcome);
  write_figures(folder, outcome);
  writing.done();
  return outcome;
}

ordered_json text_or_null(const std::string& text) {
  return text.empty() ? ordered_json(nullptr) : ordered_json(text);
}

ordered_json to_json(const PaperOutcome& outcome) {
  ordered_json out{{"paper", outcome.paper->name}, {"preview", outcome.preview}, {"failed", outcome.failed()}};
  for (const auto& [part, seconds] : outcome.seconds)
    out["seconds"][part] = seconds;
  out["sweeps"] = ordered_json::array();
  for (const SweepOutcome& sweep : outcome.sweeps) {
    const auto drift = sweep.summary.baseline_drift;
    out["sweeps"].push_back({{"sweep", sweep.name},
                             {"store", sweep.store},
                             {"planned", sweep.summary.planned},
                             {"reused", sweep.summary.reused},
                             {"measured", sweep.summary.measured},
                             {"failed", sweep.failed()},
                             {"unconverged", sweep.unconverged()},
                             {"baseline_drift_max", drift ? ordered_json(*drift) : ordered_json(nullptr)},
                             {"wall_s", sweep.summary.wall_s}});
  }
  out["tables"] = ordered_json::array();
  for (const TableOutcome& table : outcome.tables)
    out["tables"].push_back(table.path);
  out["figures"] = ordered_json::array();
  for (const FigureOutcome& figure : outcome.figures)
    out["figures"].push_back(
        {{"figure", figure.name}, {"path", text_or_null(figure.path)}, {"missing", text_or_null(figure.missing)}});
  out["pictures"] = ordered_json::array();
  for (const PicturesOutcome& set : outcome.pictures) {
    if (!set.missing.empty()) out["pictures"].push_back({{"set", set.name}, {"missing", set.missing}});
    for (const DrawnPicture& picture : set.drawn.pictures) {
      ordered_json entry{{"set", set.name},
                         {"picture", picture.name},
                         {"exr", set.folder + "/" + picture.exr},
                         {"kept", picture.kept}};
      for (const auto& [metric, value] : picture.metrics)
        entry[metric] = value;
      if (!picture.native_exr.empty()) {
        entry["map"] = set.folder + "/" + picture.native_exr;
        entry[set.drawn.native_name + "_mean"] = picture.native_mean;
      }
      out["pictures"].push_back(std::move(entry));
    }
  }
  return out;
}

}  // namespace

int reproduce_papers(const PaperOptions& options) {
  const std::vector<sweeps::PaperPointer> chosen = wanted(options.what);
  for (const sweeps::PaperPointer& paper : chosen) {
    // A mistake in what comes last shows before hours of measuring.
    for (const std::string& name : sweeps::entry_names(*paper, "tables"))
      sweeps::find_table({paper, name});
    plots::read_figures(paper);
    plots::read_pictures(*paper);
  }
  make_folder(options.folder);
  std::vector<PaperOutcome> outcomes;
  for (const sweeps::PaperPointer& paper : chosen)
    outcomes.push_back(reproduce(paper, options));
  const std::filesystem::path page = options.folder / "index.html";
  plots::write_report(make_report(outcomes), page);

  std::size_t failed = 0;
  for (const PaperOutcome& outcome : outcomes)
    failed += outcome.failed();
  if (options.json) {
    ordered_json out{{"page", page.string()}, {"failed", failed}, {"papers", ordered_json::array()}};
    for (const PaperOutcome& outcome : outcomes)
      out["papers"].push_back(to_json(outcome));
    fmt::print("{}\n", out.dump(2));
  } else {
    fmt::print("{}\n", page.string());
  }
  if (failed > 0) tell("{} points or sets of pictures failed; {} says which and why", failed, page.string());
  return failed > 0 ? kFailed : kDone;
}

}  // namespace pellucid::sandbox
