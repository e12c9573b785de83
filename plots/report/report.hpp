#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

/// A report: one HTML page with the files that it shows beside it. It needs no network and no script, and follows the
/// reader's light or dark setting.
namespace pellucid::plots {

/// A file beside the page, by its path relative to the page's folder.
struct FileLink {
  std::string label;
  std::string path;
};

struct Paragraph {
  std::string text;
  bool warning = false;  ///< set off, for what the reader must not miss
};

/// Names and values, one pair a line.
struct Facts {
  std::vector<std::pair<std::string, std::string>> pairs;
};

/// A command to be copied.
struct CommandLine {
  std::string what;  ///< what it does: "Measure again"
  std::string line;
};

struct ReportTable {
  std::string caption;
  std::vector<std::vector<std::string>> rows;  ///< the first is the heading; the first column labels the rows
  std::vector<std::string> notes{};
  std::vector<FileLink> files{};
  std::vector<CommandLine> commands{};
  bool numbers = true;  ///< cells line up on the right, else as text
};

/// An image with all that must stand with it.
struct ReportImage {
  std::string path;     ///< PNG or SVG
  std::string alt;      ///< for those who cannot see it
  std::string title{};  ///< "(a)"
  std::string caption{};
  std::vector<FileLink> files{};
  std::vector<CommandLine> commands{};
  bool pixels = false;      ///< enlarged pixels stay sharp
  std::string thumbnail{};  ///< a small file that is shown in its place, and leads to it; empty: itself
};

/// Images side by side, as many in a row as fit.
struct Gallery {
  std::vector<ReportImage> images;
  int least_width_px = 320;
};

struct Heading {
  std::string text;
};

using ReportBlock = std::variant<Heading, Paragraph, Facts, CommandLine, ReportTable, Gallery>;

struct ReportSection {
  std::string id;  ///< of the anchor: [a-z0-9_-]+, each once
  std::string title;
  std::vector<ReportBlock> blocks;
};

struct Report {
  std::string title;
  std::string lead;  ///< a sentence under the title
  std::vector<ReportSection> sections;
};

/// The page. All text is escaped; paths become relative links.
std::string to_html(const Report&);

/// Every file that the page shows or links to, each once, in order.
std::vector<std::string> linked_files(const Report&);

/// Writes the page (whole or not at all). Throws RuntimeError when a file that it links to is not in the page's folder,
/// or the page cannot be written.
void write_report(const Report&, const std::filesystem::path& page);

}  // namespace pellucid::plots
