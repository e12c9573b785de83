// pellucid results, table.
#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "algorithms/scene/files/atomic_file.hpp"
#include "algorithms/scene/files/tell.hpp"
#include "gl/error.hpp"
#include "sandbox/arguments.hpp"
#include "sandbox/commands/commands.hpp"
#include "sweeps/papers/paper.hpp"
#include "sweeps/store/select.hpp"
#include "sweeps/store/store.hpp"
#include "sweeps/tables/csv.hpp"
#include "sweeps/tables/tables.hpp"

namespace pellucid::sandbox {
namespace {

using namespace pellucid::sweeps;

struct ResultsOptions {
  std::string store, format = "csv";
  std::vector<std::string> where, columns;
  bool samples = false;
};

struct TableOptions {
  std::string name, store, format = "md", device;
  LatexOptions latex;
  std::filesystem::path output;
};

/// A full disk or a closed pipe is an error, not a short file.
void print_out(const std::string& text) {
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0)
    throw RuntimeError(fmt::format("cannot write to standard output: {}", std::strerror(errno)));
}

int results(const ResultsOptions& options) {
  std::vector<RowCondition> conditions;
  for (const std::string& text : options.where)
    conditions.push_back(parse_row_condition(text));
  const std::vector<nlohmann::json> rows = select_rows(read_rows(options.store, options.samples), conditions);
  const auto line = [](const auto& json, int indent) {
    return json.dump(indent, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
  };
  const auto print_json = [&](const auto& chosen) {
    if (options.format == "json") {
      print_out(line(typename std::decay_t<decltype(chosen)>::value_type(chosen), 2));
      return;
    }
    for (const auto& row : chosen)
      print_out(line(row, -1));
  };
  if (options.format == "csv") {
    if (!options.columns.empty()) select_fields(rows, options.columns);  // complains about unknown names
    print_out(options.columns.empty() ? rows_to_csv(rows) : rows_to_csv(rows, options.columns));
  } else if (options.columns.empty()) {
    print_json(rows);
  } else {
    print_json(select_fields(rows, options.columns));
  }
  return kDone;
}

int table(const TableOptions& options) {
  const TableFormat format = parse_table_format(options.format);
  const PaperEntry entry = find_entry(options.name, "tables", "table");
  if ((options.latex.siunitx || options.latex.bold_best) && format != TableFormat::latex)
    throw InputError("--siunitx and --bold-best are of --format latex");
  if (!options.device.empty() && options.store.empty()) {
    throw InputError("--device-name chooses among a store's devices; --store S.db is missing");
  }
  if (!options.output.empty()) {
    check_no_input(options.output, options.store, "-o");
    if (!entry.paper->built_in) check_no_input(options.output, entry.paper->file.shown, "-o");
  }
  const std::vector<nlohmann::json> rows =
      options.store.empty() ? std::vector<nlohmann::json>{} : read_rows(options.store);
  const Table filled = make_table(entry, rows, options.device);
  const std::string text = format_table(filled, format, options.latex);
  if (options.output.empty()) {
    print_out(text);
  } else {
    write_text_file(options.output, text);
  }
  if (filled.sweep.empty()) {
    tell("{}; to fill the table: pellucid sweep run {} --store {}",
         options.store.empty() ? "no store was named, so the numbers are the paper's alone"
                               : fmt::format("{} has no rows of {}", options.store, filled.info.spec),
         filled.info.spec_path, options.store.empty() ? "S.db" : options.store);
  } else if (format == TableFormat::csv || format == TableFormat::json) {
    for (const std::string& note : filled.notes)
      tell("note: {}", note);
  }
  return kDone;
}

void add_json_flag(cli::App& app, std::string& format) {
  app.add_flag_callback(
         "--json", [&format] { format = "json"; }, "the same as --format json")
      ->excludes("--format");
}

std::string table_footer() {
  const std::vector<TableInfo> all = tables();
  std::size_t width = 0;
  for (const TableInfo& info : all)
    width = std::max(width, info.name.size());
  std::string text = "Tables:\n";
  for (const TableInfo& info : all)
    text += fmt::format("  {:<{}}  {}\n", info.name, width, info.source);
  const TableInfo& first = all.front();
  return text + fmt::format(
                    "\nExamples:\n"
                    "  pellucid sweep run {0} --store S.db\n"
                    "  pellucid table {1} --store S.db\n"
                    "  pellucid table {1} --store S.db --format latex --bold-best -o table.tex\n"
                    "  pellucid table my.toml:hulls --store S.db",
                    first.spec_path, first.name);
}

}  // namespace

void add_results(cli::App& root, std::vector<Command>& commands) {
  auto rows = std::make_shared<ResultsOptions>();
  cli::App* results_app = root.add_subcommand("results", "Print every row of a store, failed ones included");
  results_app->add_option("store", rows->store, "the SQLite file of a sweep")->required();
  results_app->add_option("--where", rows->where,
                          "only rows that meet field=value, or with !=, <, <=, > or >=; repeatable, all must hold");
  results_app->add_option("--columns", rows->columns, "only these fields, as --columns hulls,samples,fps")
      ->delimiter(',');
  results_app->add_flag("--samples", rows->samples, "every frame time too, as frame_ms_samples");
  results_app->add_option("--format", rows->format, "csv, json (a list) or jsonl (an object a line)")
      ->check(cli::IsMember({"csv", "json", "jsonl"}))
      ->capture_default_str();
  add_json_flag(*results_app, rows->format);
  results_app->footer(
      "Examples:\n"
      "  pellucid results results/hulls.db > hulls.csv\n"
      "  pellucid results results/hulls.db --where 'hulls>=4' --columns hulls,samples,fps,rmse\n"
      "  pellucid results results/hulls.db --format json | jq '.[] | [.hulls, .samples, .fps]'");
  commands.push_back({results_app, [rows] { return results(*rows); }});

  auto options = std::make_shared<TableOptions>();
  cli::App* table_app =
      root.add_subcommand("table", "Print a table of a paper, or of your own file, the published numbers beside ours");
  table_app->add_option("name", options->name, "a table below, or FILE.toml:NAME of your own file (sweeps/README.md)")
      ->required();
  table_app->add_option("--store", options->store,
                        "where our numbers come from; without it only the paper's are shown");
  table_app->add_option("--format", options->format, "md, csv, latex (booktabs) or json")
      ->check(cli::IsMember({"md", "csv", "latex", "json"}))
      ->capture_default_str();
  add_json_flag(*table_app, options->format);
  table_app->add_flag("--siunitx", options->latex.siunitx, "LaTeX: columns of siunitx, aligned at the decimal point");
  table_app->add_flag("--bold-best", options->latex.bold_best,
                      "LaTeX: the best measured value of a row in bold, where its quantity says which way is better");
  table_app->add_option("--device-name", options->device,
                        "take the rows whose device and driver contain this, where a store holds several");
  table_app->add_option("-o,--output", options->output, "write to this file instead of standard output");
  table_app->footer(&table_footer);
  commands.push_back({table_app, [options] { return table(*options); }});
}

}  // namespace pellucid::sandbox
