#include "plots/figures/row_chart.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <map>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "algorithms/scene/files/tell.hpp"
#include "gl/error.hpp"
#include "plots/charts/style.hpp"

namespace pellucid::plots {
namespace {

using nlohmann::json;

constexpr std::size_t kMostLines = 12;

/// The numeric parameter that takes the most values.
std::string widest_parameter(const std::vector<json>& rows, const RowChart& wanted, const Fields& fields) {
  std::map<std::string, std::set<double>> values;
  for (const json* row : choose_rows(rows, wanted.where, {}, fields).kept) {
    for (const auto& [name, text] : settings(*row)) {
      if (const auto value = number(*row, name)) values[name].insert(*value);
    }
  }
  std::string best;
  for (const auto& [name, distinct] : values) {
    if (distinct.size() > (best.empty() ? 1 : values[best].size())) best = name;
  }
  if (best.empty())
    throw InputError("no parameter takes more than one value in these rows; name the abscissa with --x");
  return best;
}

std::string measured_field(const std::vector<json>& rows) {
  for (const char* field : {"fps", "flip_mean", "rmse"}) {
    if (std::any_of(rows.begin(), rows.end(), [&](const json& row) { return number(row, field).has_value(); })) {
      return field;
    }
  }
  throw InputError("the rows have neither fps nor flip_mean nor rmse; name what to draw with --y");
}

bool powers_of_two(const std::set<double>& values) {
  return values.size() > 1 && std::all_of(values.begin(), values.end(), [](double v) {
           int exponent = 0;
           return v > 0 && std::frexp(v, &exponent) == 0.5;
         });
}

Scale scale_of_x(ScaleWish wish, const std::set<double>& values) {
  if (wish == ScaleWish::linear) return Scale::linear;
  if (wish == ScaleWish::log10) return Scale::log10;
  if (wish == ScaleWish::log2) return Scale::log2;
  if (wish == ScaleWish::automatic && values.size() <= 2) return Scale::linear;
  if (powers_of_two(values)) return Scale::log2;
  return wish == ScaleWish::log ? Scale::log10 : Scale::linear;
}

Scale scale_of_y(ScaleWish wish, const std::set<double>& values) {
  if (wish == ScaleWish::linear) return Scale::linear;
  if (wish == ScaleWish::log2) return Scale::log2;
  if (wish == ScaleWish::automatic) return scale_for(*values.begin(), *values.rbegin());
  return Scale::log10;
}

bool is_logarithmic(ScaleWish wish) {
  return wish == ScaleWish::log || wish == ScaleWish::log2 || wish == ScaleWish::log10;
}

/// The difference between two rows, for the message that refuses to pool them.
std::string difference(const json& a, const json& b) {
  const auto of_a = settings(a);
  std::vector<std::string> names;
  for (const auto& [name, value] : settings(b)) {
    const bool same = std::find(of_a.begin(), of_a.end(), std::pair(name, value)) != of_a.end();
    if (!same) names.push_back(fmt::format("{} = {}", name, value));
  }
  return names.empty() ? sweeps::difference(a, b) : fmt::format("they differ in {}", fmt::join(names, ", "));
}

Color faint(const Color& color) {
  const auto mix = [](std::uint8_t v) { return static_cast<std::uint8_t>((v + 3 * 255) / 4); };
  return {mix(color.r), mix(color.g), mix(color.b)};
}

/// The chart in the making.
class RowsChart {
 public:
  RowsChart(const std::vector<json>& rows, const RowChart& wanted, const Fields& fields)
      : wanted_(wanted), fields_(fields) {
    if (wanted_.x.field.empty()) wanted_.x.field = widest_parameter(rows, wanted, fields);
    if (wanted_.y.field.empty()) wanted_.y.field = measured_field(rows);
    std::vector<std::string> needed{x(), y()};
    for (const std::string& field : {wanted_.lines, wanted_.order_by}) {
      if (!field.empty()) needed.push_back(field);
    }
    needed.insert(needed.end(), wanted_.needs.begin(), wanted_.needs.end());
    rows_ = choose_rows(rows, wanted_.where, needed, fields);
    for (const AxisWish& axis : {wanted_.x, wanted_.y}) {
      if (is_logarithmic(axis.scale)) leave_out_zeros(axis.field);
    }
  }

  Chart draw() {
    const std::vector<std::string> own = own_settings();
    const std::vector<Group> groups = group_rows(rows_, own, wanted_.labels);
    if (wanted_.join != Join::all) check_distinct(groups, own);
    set_axes();
    const std::vector<Curve> lines = curves_of(groups);
    std::vector<std::string> techniques = wanted_.colours;
    std::set<std::string> drawn;
    for (const Curve& line : lines) {
      drawn.insert(line.technique);
      if (std::find(techniques.begin(), techniques.end(), line.technique) == techniques.end())
        techniques.push_back(line.technique);
    }
    for (std::size_t i = 0; i < lines.size(); ++i) {
      const Curve& line = lines[i];
      Style look = style(i);
      // The colours of techniques tell them apart; where one technique makes every line, each line has its own.
      if (drawn.size() > 1 && wanted_.lines.empty()) {
        const auto place = std::find(techniques.begin(), techniques.end(), line.technique) - techniques.begin();
        look = style(static_cast<std::size_t>(place));
        if (line.variant > 0) look = variant(look, line.variant);
      }
      // Bars at one abscissa would hide each other.
      const double shift =
          wanted_.bar_low.empty() ? 0 : 6 * (static_cast<double>(i) - (static_cast<double>(lines.size()) - 1) / 2);
      add(line, look, shift, in_legend(groups));
    }
    set_note(groups, own);
    return std::move(chart_);
  }

 private:
  /// Rows that are drawn as one series.
  struct Curve {
    std::string label, technique;
    std::size_t variant = 0;
    std::vector<const json*> rows;
  };

  const std::string& x() const { return wanted_.x.field; }
  const std::string& y() const { return wanted_.y.field; }
  double value(const json& row, const std::string& field) const { return *fields_.value(row, field); }

  void leave_out_zeros(const std::string& field) {
    zeros_ += std::erase_if(rows_.kept, [&](const json* row) { return value(*row, field) <= 0; });
    if (rows_.kept.empty())
      throw InputError(fmt::format("nothing to draw: every row has {} = 0, which a logarithmic axis lacks", field));
  }

  /// Everything that varies but is not asked for as a series must not divide the rows.
  std::vector<std::string> own_settings() const {
    std::vector<std::string> own;
    for (const std::string& field : {x(), wanted_.lines, wanted_.order_by}) {
      for (const std::string& setting : fields_.sources_of(field))
        own.push_back(setting);
    }
    if (x() == "width" || x() == "height") own.emplace_back("size");
    if (wanted_.series.empty()) return own;
    std::set<std::string> names;
    for (const json* row : rows_.kept) {
      for (const auto& [name, text] : settings(*row))
        names.insert(name);
    }
    for (const std::string& wish : wanted_.series) {
      if (names.contains(wish)) continue;
      throw InputError(
          fmt::format("--series {} is no setting of these rows; there are {}", wish, fmt::join(names, ", ")));
    }
    for (const std::string& name : names) {
      if (std::find(wanted_.series.begin(), wanted_.series.end(), name) == wanted_.series.end()) own.push_back(name);
    }
    return own;
  }

  void set_axes() {
    chart_.x = axis_of(wanted_.x, fields_);
    chart_.y = axis_of(wanted_.y, fields_);
    chart_.x.from_zero = false;
    chart_.title = wanted_.title.empty() ? fmt::format("{} over {}", chart_.y.label, chart_.x.label) : wanted_.title;
    std::set<double> abscissae, ordinates;
    for (const json* row : rows_.kept) {
      abscissae.insert(value(*row, x()));
      ordinates.insert(value(*row, y()));
    }
    chart_.x.scale = scale_of_x(wanted_.x.scale, abscissae);
    chart_.y.scale = scale_of_y(wanted_.y.scale, ordinates);
  }

  std::vector<Curve> curves_of(const std::vector<Group>& groups) const {
    std::vector<Curve> lines;
    if (wanted_.lines.empty()) {
      for (const Group& group : groups)
        lines.push_back({group.label, group.technique, group.variant, group.rows});
    } else {
      const std::string name = axis_of({.field = wanted_.lines}, fields_).label;
      std::map<double, std::vector<Curve>> by_value;
      for (const Group& group : groups) {
        std::map<double, Curve> parts;
        for (const json* row : group.rows) {
          const double at = value(*row, wanted_.lines);
          Curve& part = parts[at];
          part.label = fmt::format("{} = {:g}{}", name, at, groups.size() > 1 ? ", " + group.label : std::string());
          part.technique = group.technique;
          part.rows.push_back(row);
        }
        for (auto& [at, part] : parts)
          by_value[at].push_back(std::move(part));
      }
      for (auto& [at, parts] : by_value)
        lines.insert(lines.end(), parts.begin(), parts.end());
    }
    if (lines.size() > kMostLines) {
      throw InputError(fmt::format("the chart would have {} lines ('{}', '{}', …), more than {}; choose with --where",
                                   lines.size(), lines[0].label, lines[1].label, kMostLines));
    }
    return lines;
  }

  /// A single line needs no legend: the small print names it.
  bool in_legend(const std::vector<Group>& groups) const {
    return groups.size() > 1 || !wanted_.lines.empty() || wanted_.labels == Labels::unusual;
  }

  Point point_of(const json& row) const {
    Point point{value(row, x()), value(row, y()), {}, {}};
    const Quantity* quantity = fields_.find(y());
    const std::string& low = wanted_.bar_low.empty() && quantity != nullptr ? quantity->low : wanted_.bar_low;
    const std::string& high = wanted_.bar_low.empty() && quantity != nullptr ? quantity->high : wanted_.bar_high;
    if (!low.empty()) point.low = fields_.value(row, low);
    if (!high.empty()) point.high = fields_.value(row, high);
    return point;
  }

  void add(const Curve& line, const Style& look, double shift_px, bool in_legend) {
    std::vector<const json*> joined, others;
    divide(line, joined, others);
    Series shown{in_legend ? line.label : std::string(), {}, look, shift_px, line.label};
    for (const json* row : joined)
      shown.points.push_back(point_of(*row));
    if (!others.empty()) {
      Series rest{"", {}, {faint(look.color), look.marker, Line::none}, shift_px, line.label};
      for (const json* row : others)
        rest.points.push_back({value(*row, x()), value(*row, y()), {}, {}});
      chart_.series.push_back(std::move(rest));
      chosen_ = true;
    }
    chart_.series.push_back(std::move(shown));
  }

  void divide(const Curve& line, std::vector<const json*>& joined, std::vector<const json*>& others) const {
    if (wanted_.join == Join::front) {
      divide_by_front(line, joined, others);
      return;
    }
    const Quantity* quantity = fields_.find(y());
    const bool more = quantity != nullptr && quantity->better == sweeps::Better::more;
    std::map<double, const json*> best;
    for (const json* row : line.rows) {
      const auto [place, fresh] = best.try_emplace(value(*row, x()), row);
      if (fresh) continue;
      if (wanted_.join == Join::all) refuse_pooling(line, place->first, *place->second, *row);
      const double kept = value(*place->second, y()), here = value(*row, y());
      if (more ? here > kept : here < kept) place->second = row;
    }
    for (const auto& [at, row] : best)
      joined.push_back(row);
    std::copy_if(line.rows.begin(), line.rows.end(), std::back_inserter(others),
                 [&](const json* row) { return best.at(value(*row, x())) != row; });
  }

  void divide_by_front(const Curve& line, std::vector<const json*>& joined, std::vector<const json*>& others) const {
    std::vector<const json*> sorted = line.rows;
    std::set<double> orders;
    for (const json* row : sorted)
      orders.insert(value(*row, wanted_.order_by));
    if (orders.size() == sorted.size()) {
      std::sort(sorted.begin(), sorted.end(), [&](const json* a, const json* b) {
        return value(*a, wanted_.order_by) < value(*b, wanted_.order_by);
      });
      joined = std::move(sorted);
      return;
    }
    const Quantity* quantity = fields_.find(y());
    const double sign = quantity != nullptr && quantity->better == sweeps::Better::more ? -1 : 1;
    std::sort(sorted.begin(), sorted.end(), [&](const json* a, const json* b) {
      return std::pair(value(*a, x()), sign * value(*a, y())) < std::pair(value(*b, x()), sign * value(*b, y()));
    });
    for (const json* row : sorted) {
      const bool better = joined.empty() || sign * value(*row, y()) < sign * value(*joined.back(), y());
      (better ? joined : others).push_back(row);
    }
  }

  [[noreturn]] void refuse_pooling(const Curve& line, double at, const json& first, const json& second) const {
    throw InputError(
        fmt::format("several rows of '{}' stand at {} = {:g}: {}; divide with --series or choose with --where",
                    line.label, x(), at, difference(first, second)));
  }

  void set_note(const std::vector<Group>& groups, const std::vector<std::string>& own) {
    std::string& note = chart_.note;
    const auto add = [&](const std::string& sentence) {
      if (!sentence.empty()) note += (note.empty() ? "" : " ") + sentence;
    };
    const auto timed = [&](const std::string& field) { return fields_.is_time(field); };
    note = provenance_note(rows_,
                           timed(x()) || timed(y()) || std::any_of(wanted_.needs.begin(), wanted_.needs.end(), timed));
    if (!in_legend(groups) && !groups[0].label.empty()) note = fmt::format("{}; {}", groups[0].label, note);
    const Quantity* quantity = fields_.find(y());
    if (!wanted_.bar_low.empty()) {
      add(wanted_.bars_note);
    } else if (quantity != nullptr && !quantity->interval.empty()) {
      add(fmt::format("Bars: {}.", quantity->interval));
    }
    if (chosen_) add(wanted_.join_note);
    if (wanted_.labels == Labels::unusual) add(usual_note(rows_, own));
    if (zeros_ > 0) add(fmt::format("{} at 0 left out.", counted(zeros_, "point")));
    if (wanted_.reference_error) add(reference_note());
  }

  /// Errors below those of the reference mean nothing.
  std::string reference_note() const {
    const std::string exactness = sweeps::reference_exactness(rows_.kept);
    return exactness.empty() ? "" : fmt::format("The reference's own {}.", exactness);
  }

  RowChart wanted_;
  const Fields& fields_;
  Rows rows_;
  std::size_t zeros_ = 0;  ///< points that a logarithmic axis cannot show
  bool chosen_ = false;    ///< some points are not joined
  Chart chart_;
};

}  // namespace

Scale scale_for(double least, double greatest) {
  return least > 0 && greatest > 10 * least ? Scale::log10 : Scale::linear;
}

Axis axis_of(const AxisWish& wish, const Fields& fields) {
  Axis axis{wish.field, "", Scale::linear, false};
  if (const Quantity* quantity = fields.find(wish.field))
    axis = {quantity->label, quantity->unit, Scale::linear, quantity->from_zero};
  if (!wish.label.empty()) axis.label = wish.label;
  if (!wish.unit.empty()) axis.unit = wish.unit;
  axis.field = wish.field;
  return axis;
}

Chart chart_of_rows(const std::vector<json>& rows, const RowChart& wanted, const Fields& fields) {
  return RowsChart(rows, wanted, fields).draw();
}

}  // namespace pellucid::plots
