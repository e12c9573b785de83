#include "plots/report/report.hpp"

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <set>
#include <string_view>

#include <fmt/format.h>

#include "algorithms/scene/files/atomic_file.hpp"
#include "gl/error.hpp"

namespace pellucid::plots {
namespace {

// System colours follow the reader's light or dark setting; charts are drawn for white paper and keep it.
constexpr const char* kStyle = R"(
:root { color-scheme: light dark; --rule: color-mix(in srgb, CanvasText 22%, Canvas);
  --faint: color-mix(in srgb, CanvasText 68%, Canvas); --shade: color-mix(in srgb, CanvasText 6%, Canvas); }
body { font: 16px/1.5 system-ui, sans-serif; color: CanvasText; background: Canvas; max-width: 76rem; margin: 2rem auto;
  padding: 0 1rem; }
h1 { font-size: 1.7rem; line-height: 1.2; margin-bottom: .3rem; }
h2 { font-size: 1.3rem; margin-top: 2.5rem; border-bottom: 1px solid var(--rule); padding-bottom: .2rem; }
h3 { font-size: 1.05rem; margin: 1.6rem 0 .5rem; }
p { max-width: 48rem; }
.lead, .note, figcaption small { color: var(--faint); }
.warning { border-left: 4px solid #d55e00; padding: .4rem .8rem; background: var(--shade); }
nav ul { padding: 0; list-style: none; display: flex; flex-wrap: wrap; gap: .2rem 1.2rem; }
dl { display: grid; grid-template-columns: max-content 1fr; gap: .15rem 1.2rem; }
dt { color: var(--faint); }
dd { margin: 0; overflow-wrap: anywhere; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; margin: .5rem 0; font-variant-numeric: tabular-nums; }
caption { text-align: left; padding-bottom: .4rem; font-weight: 600; }
th, td { padding: .25rem .8rem; text-align: left; vertical-align: top; }
table.numbers td, table.numbers thead th:not(:first-child) { text-align: right; }
thead th { border-top: 2px solid; border-bottom: 1px solid; }
tbody th { font-weight: normal; }
tbody tr:last-child > * { border-bottom: 2px solid; }
.gallery { display: grid; gap: 1.5rem 1.2rem; margin: 1rem 0; }
figure { margin: 0; }
figure img { width: 100%; height: auto; display: block; background: #fff; }
figure img.pixels { image-rendering: pixelated; }
figcaption { margin-top: .4rem; }
.note, .files { font-size: .9rem; margin: .2rem 0; }
.files a { margin-right: .8rem; }
details { font-size: .9rem; margin: .2rem 0; }
summary { color: var(--faint); cursor: pointer; }
pre { background: var(--shade); padding: .5rem .7rem; margin: .3rem 0; white-space: pre-wrap; overflow-wrap: anywhere;
  user-select: all; }
@media print { details > pre { display: block; } body { max-width: none; } }
)";

std::string escape(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

// A relative path as a URL: all but the unreserved characters (RFC 3986) in percent notation.
std::string url(std::string_view path) {
  std::string out;
  for (const char c : path) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
                       c == '.' || c == '_' || c == '~' || c == '/';
    if (plain) {
      out += c;
    } else {
      out += fmt::format("%{:02X}", static_cast<unsigned char>(c));
    }
  }
  return out;
}

void put(std::string& out, const Heading& heading) {
  out += fmt::format("<h3>{}</h3>\n", escape(heading.text));
}

void put(std::string& out, const Paragraph& paragraph) {
  out += fmt::format("<p{}>{}</p>\n", paragraph.warning ? " class=\"warning\"" : "", escape(paragraph.text));
}

void put(std::string& out, const Facts& facts) {
  if (facts.pairs.empty()) return;
  out += "<dl>\n";
  for (const auto& [name, value] : facts.pairs)
    out += fmt::format("<dt>{}</dt><dd>{}</dd>\n", escape(name), escape(value));
  out += "</dl>\n";
}

void put(std::string& out, const CommandLine& command) {
  out += fmt::format("<p class=\"note\">{}</p>\n<pre>{}</pre>\n", escape(command.what), escape(command.line));
}

void put_files(std::string& out, const std::vector<FileLink>& files) {
  if (files.empty()) return;
  out += "<p class=\"files\">";
  for (const FileLink& file : files)
    out += fmt::format("<a href=\"{}\">{}</a> ", url(file.path), escape(file.label));
  out += "</p>\n";
}

// Folded away: a page full of commands would hide what it is about.
void put_commands(std::string& out, const std::vector<CommandLine>& commands) {
  for (const CommandLine& command : commands) {
    out += fmt::format("<details><summary>{}</summary><pre>{}</pre></details>\n", escape(command.what),
                       escape(command.line));
  }
}

void put_row(std::string& out, const std::vector<std::string>& row, bool heading) {
  out += "<tr>";
  for (std::size_t i = 0; i < row.size(); ++i) {
    const char* scope = heading ? "col" : "row";
    out += heading || i == 0 ? fmt::format("<th scope=\"{}\">{}</th>", scope, escape(row[i]))
                             : fmt::format("<td>{}</td>", escape(row[i]));
  }
  out += "</tr>\n";
}

void put(std::string& out, const ReportTable& table) {
  out += fmt::format("<div class=\"scroll\">\n<table{}>\n", table.numbers ? " class=\"numbers\"" : "");
  if (!table.caption.empty()) out += fmt::format("<caption>{}</caption>\n", escape(table.caption));
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    if (i < 2) out += i == 0 ? "<thead>\n" : "<tbody>\n";
    put_row(out, table.rows[i], i == 0);
    if (i == 0) out += "</thead>\n";
  }
  if (table.rows.size() > 1) out += "</tbody>\n";
  out += "</table>\n</div>\n";
  for (const std::string& note : table.notes)
    out += fmt::format("<p class=\"note\">{}</p>\n", escape(note));
  put_files(out, table.files);
  put_commands(out, table.commands);
}

void put(std::string& out, const Gallery& gallery) {
  out += fmt::format(
      "<div class=\"gallery\" style=\"grid-template-columns: repeat(auto-fill, minmax(min(100%, {}px), 1fr))\">\n",
      gallery.least_width_px);
  for (const ReportImage& image : gallery.images) {
    const bool small = !image.thumbnail.empty();
    out += fmt::format("<figure>\n<a href=\"{}\"><img src=\"{}\" alt=\"{}\"{}{}></a>\n<figcaption>", url(image.path),
                       url(small ? image.thumbnail : image.path), escape(image.alt),
                       image.pixels ? " class=\"pixels\"" : "", small ? " loading=\"lazy\"" : "");
    if (!image.title.empty()) out += fmt::format("<strong>{}</strong> ", escape(image.title));
    out += escape(image.caption) + "\n";
    out += "</figcaption>\n";
    put_files(out, image.files);
    put_commands(out, image.commands);
    out += "</figure>\n";
  }
  out += "</div>\n";
}

}  // namespace

std::string to_html(const Report& report) {
  std::string out = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{0}</title>\n"
      "<style>{1}</style>\n</head>\n<body>\n<h1>{0}</h1>\n",
      escape(report.title), kStyle);
  if (!report.lead.empty()) out += fmt::format("<p class=\"lead\">{}</p>\n", escape(report.lead));
  if (report.sections.size() > 1) {
    out += "<nav><ul>\n";
    for (const ReportSection& section : report.sections)
      out += fmt::format("<li><a href=\"#{}\">{}</a></li>\n", section.id, escape(section.title));
    out += "</ul></nav>\n";
  }
  std::set<std::string> ids;
  for (const ReportSection& section : report.sections) {
    assert(!section.id.empty() &&
           section.id.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_-") == std::string::npos);
    [[maybe_unused]] const bool once = ids.insert(section.id).second;
    assert(once);
    out += fmt::format("<section id=\"{}\">\n<h2>{}</h2>\n", section.id, escape(section.title));
    for (const ReportBlock& block : section.blocks)
      std::visit([&](const auto& b) { put(out, b); }, block);
    out += "</section>\n";
  }
  return out + "</body>\n</html>\n";
}

std::vector<std::string> linked_files(const Report& report) {
  std::vector<std::string> out;
  auto add = [&](const std::string& path) {
    if (std::find(out.begin(), out.end(), path) == out.end()) out.push_back(path);
  };
  for (const ReportSection& section : report.sections) {
    for (const ReportBlock& block : section.blocks) {
      if (const auto* table = std::get_if<ReportTable>(&block)) {
        for (const FileLink& file : table->files)
          add(file.path);
      } else if (const auto* gallery = std::get_if<Gallery>(&block)) {
        for (const ReportImage& image : gallery->images) {
          add(image.path);
          if (!image.thumbnail.empty()) add(image.thumbnail);
          for (const FileLink& file : image.files)
            add(file.path);
        }
      }
    }
  }
  return out;
}

void write_report(const Report& report, const std::filesystem::path& page) {
  for (const std::string& file : linked_files(report)) {
    std::error_code error;
    if (std::filesystem::path(file).is_absolute() ||
        !std::filesystem::is_regular_file(page.parent_path() / file, error)) {
      throw RuntimeError(fmt::format("report '{}' would link to '{}', which is not there", page.string(), file));
    }
  }
  write_text_file(page, to_html(report));
}

}  // namespace pellucid::plots
