#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "plots/report/report.hpp"
#include "sandbox/reproduce/kept_pictures.hpp"
#include "sandbox/reproduce/reproduce_pictures.hpp"
#include "sweeps/papers/paper.hpp"
#include "sweeps/tables/tables.hpp"
#include "sweeps/workers/run.hpp"

namespace pellucid::sandbox {

struct SweepOutcome {
  std::string name, title;
  std::string words;  ///< what `pellucid sweep run` takes to measure it
  std::string store;  ///< path as a user would type it
  sweeps::SweepSummary summary;
  std::vector<nlohmann::json> rows;
  std::vector<KeptPicture> kept;
  /// Points with `status` failed, and with `timing` unconverged, whoever measured them.
  std::size_t failed() const;
  std::size_t unconverged() const;
};

struct TableOutcome {
  sweeps::Table table;
  std::string path;  ///< relative to the page, without extension: md, csv, tex and json stand there
};

struct FigureOutcome {
  std::string name, title, doc;
  std::string path;  ///< relative to the page, without extension: svg, png, pdf and csv stand there; empty without data
  std::string missing;  ///< why there is none
  std::string repeat;   ///< a command line that draws it alone
};

struct PicturesOutcome {
  std::string name, title;  ///< of PictureSet
  DrawnPictures drawn;
  std::string folder;   ///< relative to the page
  std::string missing;  ///< why there are none; empty when they are drawn
};

/// The outcome of one paper.
struct PaperOutcome {
  sweeps::PaperPointer paper;
  bool preview = false;
  std::string folder;   ///< of its results, relative to the page
  std::string command;  ///< that made all of it
  std::string started_utc;
  std::vector<SweepOutcome> sweeps;
  std::vector<TableOutcome> tables;
  std::vector<FigureOutcome> figures;
  std::vector<PicturesOutcome> pictures;
  std::vector<std::pair<std::string, double>> seconds;  ///< of each part of the work, in order
  std::string device_option;                            ///< " --device N", or empty
  std::size_t failed() const;                           ///< points, and sets of pictures
  /// The sweep that measures `spec`'s rows, in full or as a preview; null when the paper has none.
  const SweepOutcome* sweep_of(const std::string& spec) const;
};

/// The page that shows them all.
plots::Report make_report(const std::vector<PaperOutcome>&);

}  // namespace pellucid::sandbox
