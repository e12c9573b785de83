// pellucid plot.
#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "algorithms/scene/files/atomic_file.hpp"
#include "gl/error.hpp"
#include "plots/charts/chart.hpp"
#include "plots/figures/figures.hpp"
#include "sandbox/arguments.hpp"
#include "sandbox/commands/commands.hpp"
#include "sweeps/store/store.hpp"

namespace pellucid::sandbox {
namespace {

struct PlotArguments {
  std::string what;  ///< a store, a figure's name or FILE.toml:NAME
  std::string store;
  std::string output, data;
  std::vector<std::string> where;
  plots::RowChart chart;
  bool log_x = false, log_y = false, list = false, as_json = false;
};

int list_figures(bool as_json) {
  nlohmann::ordered_json out = nlohmann::ordered_json::array();
  for (const plots::Figure& figure : plots::built_in_figures()) {
    if (as_json) {
      out.push_back({{"name", figure.full_name}, {"title", figure.title}, {"doc", figure.doc}, {"spec", figure.sweep}});
    } else {
      const std::string rows = figure.sweep.empty() ? "worked out, without a store" : "sweep " + figure.sweep;
      fmt::print("{:<33} {} ({})\n", figure.full_name, figure.doc, rows);
    }
  }
  if (as_json) fmt::print("{}\n", out.dump(2));
  return kDone;
}

std::vector<plots::Where> conditions(const std::vector<std::string>& where) {
  std::vector<plots::Where> result;
  for (const std::string& text : where) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0) {
      throw InputError(fmt::format("--where {} is not name=value, for example hulls=4", text));
    }
    result.push_back({text.substr(0, equals), {text.substr(equals + 1)}});
  }
  return result;
}

void write(const plots::Drawn& drawn, const PlotArguments& arguments) {
  plots::write_svg_as(drawn.svg, arguments.output);
  if (!arguments.data.empty()) write_text_file(arguments.data, drawn.csv);
}

bool is_store(const std::string& what) {
  std::error_code error;
  return !what.ends_with(".toml") && std::filesystem::exists(what, error);
}

int plot(PlotArguments arguments) {
  if (arguments.list) return list_figures(arguments.as_json);
  if (arguments.as_json) throw InputError("--json goes with --list: a plot is a picture");
  if (arguments.what.empty()) throw InputError("name a store or a figure; pellucid plot --list shows the figures");
  if (arguments.output.empty()) throw InputError("-o FILE is missing: where the figure goes (.svg, .png or .pdf)");
  check_output(arguments.output, {".svg", ".png", ".pdf"});
  if (!arguments.data.empty()) check_output(arguments.data, {".csv"});
  const auto where = conditions(arguments.where);
  plots::RowChart& chart = arguments.chart;
  if (arguments.store.empty() && is_store(arguments.what)) {
    if (arguments.log_x) chart.x.scale = plots::ScaleWish::log;
    if (arguments.log_y) chart.y.scale = plots::ScaleWish::log;
    chart.where = where;
    write(plots::draw_chart(chart, sweeps::read_rows(arguments.what)), arguments);
    return kDone;
  }
  if (arguments.store.empty() && arguments.what.ends_with(".db"))
    throw InputError(fmt::format("{}: there is no such store", arguments.what));
  const plots::Figure figure = plots::find_figure(arguments.what);
  const bool worked_out = figure.sweep.empty();
  if (arguments.store.empty() && !worked_out)
    throw InputError(fmt::format("figure '{}' needs --store S.db: where its rows are", arguments.what));
  if (!chart.x.field.empty() || !chart.y.field.empty() || !chart.series.empty() || arguments.log_x || arguments.log_y ||
      !chart.title.empty()) {
    throw InputError("--x, --y, --series, --log-x, --log-y and --title go with a store, not with a named figure");
  }
  const auto rows = worked_out ? std::vector<nlohmann::json>() : sweeps::read_rows(arguments.store);
  write(plots::draw_figure(figure, rows, where), arguments);
  return kDone;
}

}  // namespace

void add_plot(cli::App& root, std::vector<Command>& commands) {
  auto arguments = std::make_shared<PlotArguments>();
  cli::App* app = root.add_subcommand("plot", "Draw a named figure, or any two fields of a store, as SVG, PNG or PDF");
  app->add_option("what", arguments->what, "a store S.db, the name of a figure (see --list), or FILE.toml:NAME");
  app->add_option("--store", arguments->store, "the store that a named figure is drawn from");
  app->add_option("-o,--output", arguments->output, "file to write: .svg, .png or .pdf");
  app->add_option("--data", arguments->data, "write the numbers behind the chart, too: .csv");
  app->add_option("--where", arguments->where, "name=value: only rows with this value; may be repeated")
      ->take_all()
      ->allow_extra_args(false);
  app->add_option("--x", arguments->chart.x.field, "abscissa; default: the parameter that takes the most values");
  app->add_option("--y", arguments->chart.y.field, "ordinate; default: fps, flip_mean or rmse, the first there is");
  app->add_option("--series", arguments->chart.series,
                  "settings that divide the rows into lines; may be repeated; default: all that vary")
      ->take_all()
      ->allow_extra_args(false)
      ->delimiter(',');
  app->add_flag("--log-x", arguments->log_x, "logarithmic abscissa (base 2 for powers of two)");
  app->add_flag("--log-y", arguments->log_y, "logarithmic ordinate");
  app->add_option("--title", arguments->chart.title, "title of the chart");
  app->add_flag("--list", arguments->list, "list the named figures");
  app->add_flag("--json", arguments->as_json, "with --list: print JSON");
  app->footer(
      "Examples:\n"
      "  pellucid plot error_time --store results/hulls.db -o error.pdf\n"
      "  pellucid plot my.toml:error --store my.db -o error.svg --data error.csv\n"
      "  pellucid plot my.db --x slices --y flip_mean --where technique=volume_slices --log-y -o slices.svg\n"
      "Failed points are left out and counted below the chart; rows of different devices are never pooled.");
  commands.push_back({app, [arguments] { return plot(*arguments); }});
}

}  // namespace pellucid::sandbox
