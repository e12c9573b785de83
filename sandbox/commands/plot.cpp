// pellucid plot.
#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "algorithms/parameters.hpp"
#include "gl/error.hpp"
#include "plots/charts/chart.hpp"
#include "plots/figures/figures.hpp"
#include "plots/figures/row_chart.hpp"
#include "sandbox/arguments.hpp"
#include "sandbox/commands/commands.hpp"
#include "sweeps/store/store.hpp"

namespace pellucid::sandbox {
namespace {

struct PlotArguments {
  std::string what;  ///< a store or a figure's name
  std::string store;
  std::string output;
  std::vector<std::string> where;
  plots::RowChart chart;
  bool list = false, as_json = false;
};

int list_figures(bool as_json) {
  nlohmann::ordered_json out = nlohmann::ordered_json::array();
  for (const plots::FigureInfo& figure : plots::figures()) {
    if (as_json) {
      out.push_back({{"name", figure.name}, {"title", figure.title}, {"doc", figure.doc}, {"spec", figure.spec}});
    } else {
      fmt::print("{:<26} {} (spec {})\n", figure.name, figure.doc, figure.spec);
    }
  }
  if (as_json) fmt::print("{}\n", out.dump(2));
  return kDone;
}

std::vector<plots::Condition> conditions(const std::vector<std::string>& where) {
  std::vector<plots::Condition> result;
  for (const std::string& text : where) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0) {
      throw InputError(fmt::format("--where {} is not name=value, for example hulls=4", text));
    }
    result.push_back({text.substr(0, equals), text.substr(equals + 1)});
  }
  return result;
}

bool is_figure(const std::string& name) {
  const auto all = plots::figures();
  return std::any_of(all.begin(), all.end(), [&](const plots::FigureInfo& f) { return f.name == name; });
}

int plot(PlotArguments arguments) {
  if (arguments.list) return list_figures(arguments.as_json);
  if (arguments.as_json) throw InputError("--json goes with --list: a plot is a picture");
  if (arguments.what.empty()) throw InputError("name a store or a figure; pellucid plot --list shows the figures");
  if (arguments.output.empty()) throw InputError("-o FILE is missing: where the figure goes (.svg, .png or .pdf)");
  check_output(arguments.output, {".svg", ".png", ".pdf"});
  const auto where = conditions(arguments.where);
  std::error_code error;
  const bool named = is_figure(arguments.what);
  plots::RowChart& chart = arguments.chart;

  if (named || !arguments.store.empty()) {
    plots::find_figure(arguments.what);
    if (arguments.store.empty()) {
      throw InputError(fmt::format("figure '{}' needs --store S.db: where its rows are", arguments.what));
    }
    if (!chart.x.empty() || !chart.y.empty() || !chart.series.empty() || chart.log_x || chart.log_y ||
        !chart.title.empty()) {
      throw InputError("--x, --y, --series, --log-x, --log-y and --title go with a store, not with a named figure");
    }
    plots::write_figure(arguments.what, sweeps::read_rows(arguments.store), arguments.output, where);
    return kDone;
  }
  if (!std::filesystem::exists(arguments.what, error)) {
    std::vector<std::string> names;
    for (const plots::FigureInfo& figure : plots::figures())
      names.push_back(figure.name);
    const std::string near = nearest_name(arguments.what, names);
    throw InputError(
        fmt::format("'{}' is neither a store nor a figure; {}", arguments.what,
                    near.empty() ? "pellucid plot --list shows the figures" : fmt::format("did you mean '{}'?", near)));
  }
  chart.conditions = where;
  plots::write_chart(plots::chart_of_rows(sweeps::read_rows(arguments.what), chart), arguments.output);
  return kDone;
}

}  // namespace

void add_plot(cli::App& root, std::vector<Command>& commands) {
  auto arguments = std::make_shared<PlotArguments>();
  cli::App* app = root.add_subcommand("plot", "Draw a named figure, or any two fields of a store, as SVG, PNG or PDF");
  app->add_option("what", arguments->what, "a store S.db, or the name of a figure (see --list)");
  app->add_option("--store", arguments->store, "the store that a named figure is drawn from");
  app->add_option("-o,--output", arguments->output, "file to write: .svg, .png or .pdf");
  app->add_option("--where", arguments->where, "name=value: only rows with this value; may be repeated")
      ->take_all()
      ->allow_extra_args(false);
  app->add_option("--x", arguments->chart.x, "abscissa; default: the parameter that takes the most values");
  app->add_option("--y", arguments->chart.y, "ordinate; default: fps, flip_mean or rmse, the first there is");
  app->add_option("--series", arguments->chart.series,
                  "settings that divide the rows into lines; may be repeated; default: all that vary")
      ->take_all()
      ->allow_extra_args(false)
      ->delimiter(',');
  app->add_flag("--log-x", arguments->chart.log_x, "logarithmic abscissa (base 2 for powers of two)");
  app->add_flag("--log-y", arguments->chart.log_y, "logarithmic ordinate");
  app->add_option("--title", arguments->chart.title, "title of the chart");
  app->add_flag("--list", arguments->list, "list the named figures");
  app->add_flag("--json", arguments->as_json, "with --list: print JSON");
  app->footer(
      "Examples:\n"
      "  pellucid plot sampling_hulls.error --store results/hulls.db -o error.pdf\n"
      "  pellucid plot my.db --x slices --y flip_mean --where technique=volume_slices --log-y -o slices.svg\n"
      "Failed points are left out and counted below the chart; rows of different devices are never pooled.");
  commands.push_back({app, [arguments] { return plot(*arguments); }});
}

}  // namespace pellucid::sandbox
