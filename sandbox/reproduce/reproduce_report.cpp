#include "sandbox/reproduce/reproduce_report.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <set>

#include <fmt/format.h>

#include "sweeps/spec/provenance.hpp"
#include "sweeps/store/rows.hpp"
#include "sweeps/workers/progress.hpp"

namespace pellucid::sandbox {
namespace {

using nlohmann::json;
using namespace plots;

constexpr double kSteadyDrift = 0.1;  // relative; beyond it times hardly compare

// The distinct values of a text field over all rows, in order of appearance: "a, b".
std::string distinct(const PaperOutcome& outcome, const char* field) {
  std::vector<std::string> found;
  for (const SweepOutcome& sweep : outcome.sweeps) {
    for (const json& row : sweep.rows) {
      const std::string value = sweeps::text(row, field);
      if (!value.empty() && std::find(found.begin(), found.end(), value) == found.end()) found.push_back(value);
    }
  }
  return fmt::format("{}", fmt::join(found, ", "));
}

// A point that stands in two blocks has two rows.
std::size_t count_points(const SweepOutcome& sweep, const char* field, const char* value) {
  std::set<std::string> points;
  for (const json& row : sweep.rows) {
    if (sweeps::text(row, field) == value) points.insert(sweeps::text(row, "point"));
  }
  return points.size();
}

std::string distinct_sizes(const SweepOutcome& sweep) {
  std::set<std::pair<int, int>> sizes;
  for (const json& row : sweep.rows)
    sizes.emplace(static_cast<int>(sweeps::number(row, "width").value_or(0)),
                  static_cast<int>(sweeps::number(row, "height").value_or(0)));
  std::string out;
  for (const auto& [width, height] : sizes)
    out += fmt::format("{}{}×{}", out.empty() ? "" : ", ", width, height);
  return out;
}

std::string clock_text(const std::string& clock) {
  if (clock == "finish") return "finish: the host waits for each frame, since the device's own clock cannot be trusted";
  if (clock == "gpu_query") return "gpu_query: timestamps of the GPU";
  return clock;
}

Facts run_facts(const PaperOutcome& outcome) {
  Facts facts;
  const auto add = [&](const char* name, const std::string& value) {
    if (!value.empty()) facts.pairs.emplace_back(name, value);
  };
  add("Program", fmt::format("Pellucid {}", PELLUCID_VERSION));
  std::vector<std::string> commits;
  for (const SweepOutcome& sweep : outcome.sweeps) {
    for (const json& row : sweep.rows) {
      const std::string commit = sweeps::text(row, "commit") +
                                 (sweeps::number_or_flag(row, "dirty") == 1.0 ? " with uncommitted changes" : "");
      if (std::find(commits.begin(), commits.end(), commit) == commits.end()) commits.push_back(commit);
    }
  }
  add("Commit", fmt::format("{}", fmt::join(commits, ", ")));
  add("Device", distinct(outcome, "device"));
  add("Driver", distinct(outcome, "driver"));
  add("Clock", clock_text(distinct(outcome, "clock")));
  add("This run", fmt::format("started {}", outcome.started_utc));
  for (const auto& [part, seconds] : outcome.seconds)
    facts.pairs.back().second +=
        fmt::format("; {} {}", part, seconds < 1 ? "in less than a second" : "in " + sweeps::duration_text(seconds));
  sweeps::RowPointers rows;
  for (const SweepOutcome& sweep : outcome.sweeps) {
    for (const json& row : sweep.rows)
      rows.push_back(&row);
  }
  if (const std::string exactness = sweeps::reference_exactness(rows); !exactness.empty())
    add("Reference", fmt::format("traced on the CPU; its {}, of the worst frame", exactness));
  return facts;
}

ReportTable sweep_table(const PaperOutcome& outcome) {
  ReportTable table{.caption = "Sweeps",
                    .rows = {{"", "points", "pixels", "measured in", "failed", "unconverged", "baseline drift"}}};
  for (const SweepOutcome& sweep : outcome.sweeps) {
    double wall_s = 0;
    std::set<std::string> points;
    for (const json& row : sweep.rows) {
      if (points.insert(sweeps::text(row, "point")).second) wall_s += sweeps::number(row, "wall_s").value_or(0);
    }
    const auto drift = sweep.summary.baseline_drift;
    table.rows.push_back({sweep.name, fmt::format("{}", points.size()), distinct_sizes(sweep),
                          sweeps::duration_text(wall_s), fmt::format("{}", sweep.failed()),
                          fmt::format("{}", sweep.unconverged()),
                          drift ? fmt::format("{:.1f} %", 100 * *drift) : "not measured"});
    const std::string file = outcome.folder + "/" + std::filesystem::path(sweep.store).filename().string();
    table.files.push_back({sweep.name + ".db", file});
    table.commands.push_back(
        {fmt::format("Measure {} again, into a store of its own", sweep.name),
         fmt::format("pellucid sweep run {} --store {}.db{}", sweep.words, sweep.name, outcome.device_option)});
    table.commands.push_back({fmt::format("Print the rows of {}", sweep.name),
                              fmt::format("pellucid results {} --format csv", sweeps::shell_word(sweep.store))});
  }
  table.notes.emplace_back(
      "Baseline drift: how far the time of one point, measured again and again during a sweep, strayed from its "
      "first.");
  return table;
}

std::string store_option(const PaperOutcome& outcome, const std::string& spec) {
  const SweepOutcome* sweep = outcome.sweep_of(spec);
  return sweep == nullptr ? "" : " --store " + sweeps::shell_word(sweep->store);
}

ReportTable table_block(const PaperOutcome& outcome, const TableOutcome& made) {
  ReportTable out{.caption = made.table.info.title, .rows = {}};
  for (const sweeps::TableRow& row : made.table.rows) {
    if ((row.in & sweeps::TableRow::markdown) == 0) continue;
    std::vector<std::string> cells{row.label};
    for (const sweeps::TableCell& cell : row.cells)
      cells.push_back(cell.text);
    out.rows.push_back(std::move(cells));
  }
  out.notes = made.table.notes;
  out.files = {{"Markdown", made.path + ".md"},
               {"CSV", made.path + ".csv"},
               {"LaTeX", made.path + ".tex"},
               {"JSON", made.path + ".json"}};
  out.commands = {{"Print this table", fmt::format("pellucid table {}{}", sweeps::shell_word(made.table.info.address),
                                                   store_option(outcome, made.table.info.spec))}};
  return out;
}

std::string caption(const DrawnPictures& set, const DrawnPicture& picture) {
  if (picture.technique.empty()) {
    return fmt::format("traced on the CPU; its {}{}", set.exactness,
                       set.unconverged_share > 0
                           ? fmt::format("; {:.2g} % of the pixels above the tolerance", 100 * set.unconverged_share)
                           : "");
  }
  return fmt::format("{}. FLIP {:.4f} in the mean, {:.3f} at most; RMSE {:.4f}.", picture.settings_text,
                     picture.metrics.at("flip_mean"), picture.metrics.at("flip_max"), picture.metrics.at("rmse"));
}

ReportImage image(const std::string& folder, const DrawnPicture& picture, const std::string& path,
                  const std::string& text) {
  const std::string title = picture.label.empty() ? (picture.technique.empty() ? "Reference" : "") : picture.label;
  return {.path = folder + "/" + path,
          .alt = title + (title.empty() || text.empty() ? "" : " ") + text,
          .title = title,
          .caption = text};
}

// The techniques' own errors by pixel, where the paper's figure asks for them.
void add_native_maps(const PicturesOutcome& outcome, ReportSection& section) {
  const DrawnPictures& set = outcome.drawn;
  if (set.native_scale == 0) return;
  Gallery maps;
  for (const DrawnPicture& picture : set.pictures) {
    if (picture.native_exr.empty()) continue;
    ReportImage map = image(outcome.folder, picture, picture.native_png,
                            fmt::format("{}: {:.3g} in the mean, {:.3g} at most", picture.settings_text,
                                        picture.native_mean, picture.native_max));
    map.files = {{"PNG", outcome.folder + "/" + picture.native_png},
                 {"EXR", outcome.folder + "/" + picture.native_exr}};
    map.commands = {{"Draw it again", picture.repeat}};
    maps.images.push_back(std::move(map));
  }
  section.blocks.emplace_back(Heading{"The technique's own findings beside the truth"});
  section.blocks.emplace_back(Paragraph{
      fmt::format("{}: {}{}. Black is 0, pale yellow is {:.6g} and more, grey has no value.", set.native_name,
                  set.native_doc, set.native_unit.empty() ? "" : ", in " + set.native_unit, set.native_scale)});
  section.blocks.emplace_back(std::move(maps));
}

// Which of the differences from the reference the metrics see.
std::string what_differs(const DrawnPictures& set) {
  if (set.surfaces == "forward") {
    return "Reference and pictures take the opaque surfaces from the same forward pass, shadow maps included, so that "
           "the "
           "metrics see the medium alone.";
  }
  if (set.surfaces == "raster") {
    return "Reference and pictures take the opaque surfaces from the same forward pass, but the reference's shadows "
           "are "
           "exact, so that the metrics see the medium and the shadow maps.";
  }
  return "The reference is traced, its surfaces and shadows too, so that the metrics see everything in which a picture "
         "differs from ray tracing.";
}

void add_close_ups(const DrawnPictures& set, Gallery close, Gallery stretched, ReportSection& section) {
  section.blocks.emplace_back(Heading{fmt::format("Close-up, ×{}", set.enlarged)});
  const std::string why =
      set.close_up_of.empty()
          ? set.close_up_why
          : fmt::format("the window in which the error of {} is largest on average", set.close_up_of);
  section.blocks.emplace_back(Paragraph{fmt::format("{}×{} pixels from ({}, {}): {}.", set.close_up.width,
                                                    set.close_up.height, set.close_up.x, set.close_up.y, why)});
  section.blocks.emplace_back(std::move(close));
  section.blocks.emplace_back(Paragraph{
      "The same with more contrast: one straight line through the displayed values of all, by the reference's "
      "own range."});
  section.blocks.emplace_back(std::move(stretched));
}

void add_pictures(const PicturesOutcome& outcome, ReportSection& section) {
  const DrawnPictures& set = outcome.drawn;
  const std::string& folder = outcome.folder;
  section.blocks.emplace_back(Paragraph{fmt::format(
      "Scene {}, view {}{}, {}×{} pixels. {}. The metrics compare scene-linear radiance with the reference over the "
      "whole frame; FLIP is HDR-FLIP at 67 pixels per degree. {}",
      set.scene, set.view, set.settings_text.empty() ? "" : ", " + set.settings_text, set.width, set.height,
      set.stand_in.empty() ? set.scene_title : fmt::format("{}: {}", set.scene_title, set.stand_in),
      what_differs(set))});
  std::vector<const DrawnPicture*> all;
  for (const DrawnPicture& picture : set.pictures)
    all.push_back(&picture);
  all.push_back(&set.reference);

  Gallery pictures, maps, close, stretched;
  close.least_width_px = stretched.least_width_px = 300;
  for (const DrawnPicture* picture : all) {
    ReportImage shown = image(folder, *picture, picture->png, caption(set, *picture));
    if (!picture->role.empty()) shown.caption += " " + picture->role;
    shown.files = {{"PNG", folder + "/" + picture->png}, {"EXR", folder + "/" + picture->exr}};
    shown.commands = {{"Draw it again", picture->repeat}};
    pictures.images.push_back(std::move(shown));
    for (const auto& [gallery, path] :
         {std::pair{&close, picture->close_png}, std::pair{&stretched, picture->stretched_png}}) {
      ReportImage detail = image(folder, *picture, path, picture->settings_text);
      detail.pixels = true;
      gallery->images.push_back(std::move(detail));
    }
    if (picture->technique.empty()) continue;
    ReportImage map =
        image(folder, *picture, picture->map_png,
              fmt::format("{}: FLIP {:.4f} in the mean", picture->settings_text, picture->metrics.at("flip_mean")));
    map.files = {{"PNG", folder + "/" + picture->map_png}, {"EXR", folder + "/" + picture->map_exr}};
    map.commands = {{"Compare again", picture->repeat_map}};
    maps.images.push_back(std::move(map));
  }
  section.blocks.emplace_back(std::move(pictures));
  section.blocks.emplace_back(Heading{"Where they differ from the reference"});
  section.blocks.emplace_back(Paragraph{
      fmt::format("FLIP's error maps on one scale: black is 0, pale yellow is {:.2f}. The EXR files hold the values.",
                  set.map_scale)});
  section.blocks.emplace_back(std::move(maps));
  add_native_maps(outcome, section);
  if (set.close_up.width > 0) add_close_ups(set, std::move(close), std::move(stretched), section);
}

// The points that need a look: failed ones and those whose time did not settle.
ReportTable trouble_table(const PaperOutcome& outcome) {
  ReportTable table{.caption = "", .rows = {{"sweep", "block", "what", "why", "repeat"}}, .numbers = false};
  std::set<std::string> seen;
  for (const SweepOutcome& sweep : outcome.sweeps) {
    for (const json& row : sweep.rows) {
      const bool failed = sweeps::text(row, "status") == "failed";
      const bool unconverged = sweeps::text(row, "timing") == "unconverged";
      if ((!failed && !unconverged) || !seen.insert(sweep.name + sweeps::text(row, "point")).second) continue;
      std::string why = sweeps::text(row, "failure");
      if (!failed) {
        const double median = sweeps::number(row, "frame_ms_median").value_or(0);
        const double half = 0.5 * (sweeps::number(row, "frame_ms_ci95_high").value_or(median) -
                                   sweeps::number(row, "frame_ms_ci95_low").value_or(median));
        why = fmt::format("not converged: {:.4g} ms ± {:.1f} % after {} frames", median,
                          median > 0 ? 100 * half / median : 0.0,
                          static_cast<int>(sweeps::number(row, "frames").value_or(0)));
      }
      table.rows.push_back(
          {sweep.name, sweeps::text(row, "block"), sweeps::text(row, "technique"), why, sweeps::text(row, "repeat")});
    }
  }
  return table;
}

void add_paper(const PaperOutcome& outcome, bool alone, Report& report) {
  const std::string& id = outcome.paper->name;
  const std::string prefix = alone ? "" : id + ": ";
  ReportSection run{id, alone ? "The run" : outcome.paper->title, {}};
  if (outcome.preview) {
    run.blocks.emplace_back(Paragraph{
        "A preview: fewer points, fewer timed frames and in places smaller pictures than the full run, which is the "
        "same command without --preview. Its numbers show that all works, and roughly where they lie.",
        true});
  }
  if (outcome.failed() > 0) {
    run.blocks.emplace_back(Paragraph{
        fmt::format("{} points or sets of pictures failed; the page says which and why.", outcome.failed()), true});
  }
  for (const SweepOutcome& sweep : outcome.sweeps) {
    const double drift = sweep.summary.baseline_drift.value_or(0);
    if (drift <= kSteadyDrift) continue;
    run.blocks.emplace_back(Paragraph{
        fmt::format(
            "Times of {} are unsteady: the same point took up to {:.0f} % more or less in the course of it. Other "
            "work on the machine does that; measure again when it is idle.",
            sweep.name, 100 * drift),
        true});
  }
  run.blocks.emplace_back(CommandLine{"All of this was made by", outcome.command});
  run.blocks.emplace_back(run_facts(outcome));
  run.blocks.emplace_back(sweep_table(outcome));
  report.sections.push_back(std::move(run));

  ReportSection tables{id + "-tables", prefix + "Tables: ours beside the paper's", {}};
  for (const TableOutcome& table : outcome.tables)
    tables.blocks.emplace_back(table_block(outcome, table));
  if (!tables.blocks.empty()) report.sections.push_back(std::move(tables));

  ReportSection figures{id + "-figures", prefix + "Figures", {}};
  Gallery gallery{.images = {}, .least_width_px = 420};
  for (const FigureOutcome& figure : outcome.figures) {
    if (figure.path.empty()) {
      figures.blocks.emplace_back(Paragraph{fmt::format("{}: not drawn: {}", figure.title, figure.missing), true});
      continue;
    }
    gallery.images.push_back({.path = figure.path + ".svg",
                              .alt = fmt::format("{}: {}", figure.title, figure.doc),
                              .title = figure.title + ":",
                              .caption = figure.doc,
                              .files = {{"SVG", figure.path + ".svg"},
                                        {"PNG", figure.path + ".png"},
                                        {"PDF", figure.path + ".pdf"},
                                        {"data", figure.path + ".csv"}},
                              .commands = {{"Draw it again", figure.repeat}}});
  }
  if (!gallery.images.empty()) figures.blocks.emplace_back(std::move(gallery));
  if (!figures.blocks.empty()) report.sections.push_back(std::move(figures));

  for (const PicturesOutcome& pictures : outcome.pictures) {
    ReportSection section{id + "-" + pictures.name, prefix + pictures.title, {}};
    if (pictures.missing.empty()) {
      add_pictures(pictures, section);
    } else {
      section.blocks.emplace_back(Paragraph{"Not drawn: " + pictures.missing, true});
    }
    report.sections.push_back(std::move(section));
  }

  ReportSection kept{id + "-kept", prefix + "Pictures that the sweeps kept", {}};
  for (const SweepOutcome& sweep : outcome.sweeps) {
    Gallery small{.images = {}, .least_width_px = 160};
    const std::string beside = outcome.folder + "/" + sweep.name;
    for (const KeptPicture& picture : sweep.kept) {
      small.images.push_back({.path = fmt::format("{}.db.pictures/{}", beside, picture.picture.filename().string()),
                              .alt = picture.text,
                              .caption = picture.text,
                              .commands = {{"Draw it again", picture.repeat}},
                              .thumbnail = fmt::format("{}/thumbnails/{}/{}", outcome.folder, sweep.name,
                                                       picture.thumbnail.filename().string())});
    }
    if (small.images.empty()) continue;
    kept.blocks.emplace_back(Heading{sweep.title});
    kept.blocks.emplace_back(std::move(small));
  }
  if (!kept.blocks.empty()) report.sections.push_back(std::move(kept));

  ReportSection trouble{id + "-points", prefix + "Failed and unconverged points", {}};
  ReportTable table = trouble_table(outcome);
  if (table.rows.size() > 1) {
    trouble.blocks.emplace_back(std::move(table));
  } else {
    trouble.blocks.emplace_back(Paragraph{"None: every point was measured, and every time settled."});
  }
  report.sections.push_back(std::move(trouble));
}

}  // namespace

std::size_t SweepOutcome::failed() const {
  return count_points(*this, "status", "failed");
}

std::size_t SweepOutcome::unconverged() const {
  return count_points(*this, "timing", "unconverged");
}

const SweepOutcome* PaperOutcome::sweep_of(const std::string& spec) const {
  for (const SweepOutcome& sweep : sweeps) {
    if (sweep.name == spec || sweep.name == spec + "_preview") return &sweep;
  }
  return nullptr;
}

std::size_t PaperOutcome::failed() const {
  std::size_t count = 0;
  for (const SweepOutcome& sweep : sweeps)
    count += sweep.failed();
  for (const PicturesOutcome& set : pictures)
    count += set.missing.empty() ? 0 : 1;
  return count;
}

Report make_report(const std::vector<PaperOutcome>& papers) {
  Report report;
  report.title = papers.size() == 1 ? papers.front().paper->title : "Papers, reproduced";
  report.lead =
      "Reproduced by Pellucid: tables, figures and pictures, measured and drawn anew, each with the command that makes "
      "it "
      "alone. Commands are given as from the folder where the run was started.";
  for (const PaperOutcome& paper : papers)
    add_paper(paper, papers.size() == 1, report);
  return report;
}

}  // namespace pellucid::sandbox
