#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "plots/charts/chart.hpp"
#include "plots/figures/rows.hpp"

namespace pellucid::plots {

enum class ScaleWish {
  linear,
  automatic,  ///< an abscissa whose values are all powers of two: base 2; an ordinate over more than a decade: base 10
  log,        ///< base 2 for powers of two, else base 10
  log2,
  log10
};

/// Base 10 when positive values span more than a factor of ten.
Scale scale_for(double least, double greatest);

/// The quantity that an axis shows, and how.
struct AxisWish {
  std::string field{};          ///< of the rows, or a quantity that is worked out from them
  std::string label{}, unit{};  ///< empty: those of the quantity, else the field's name
  ScaleWish scale = ScaleWish::linear;
};
/// The axis of this field; its scale is left linear.
Axis axis_of(const AxisWish&, const Fields&);

/// Which points of a line are joined; the others are faint markers.
enum class Join {
  all,
  best,  ///< of the points at one abscissa the best
  front  ///< those that no other of the line beats in both; all where none shares `order_by` with another
};

/// A chart of any two fields of a store's rows.
struct RowChart {
  AxisWish x{.scale = ScaleWish::automatic};  ///< no field: the parameter that takes the most values
  AxisWish y{};                               ///< no field: fps where there is one, else flip_mean, else rmse
  std::vector<std::string> series{};          ///< settings that divide the rows into lines; empty: all that vary
  std::string lines{};                        ///< a quantity each of whose values is a line
  Labels labels = Labels::all;
  Join join = Join::all;
  std::string order_by{};             ///< of Join::front
  std::string join_note{};            ///< what the small print says when points are left out of a line
  std::string bar_low{}, bar_high{};  ///< instead of the quantity's own interval
  std::string bars_note{};
  std::vector<std::string> needs{};  ///< what a row must have besides
  bool reference_error = false;      ///< the small print says how exact the reference is
  std::vector<Where> where{};
  std::string title{};                 ///< empty: "y over x"
  std::vector<std::string> colours{};  ///< techniques in the order of the palette; the others follow
};

/// Throws InputError for unknown fields (nearest name), rows of several devices, too many lines, and for several rows
/// at one x of one line unless `join` chooses among them: they are never averaged, and the message says in which
/// settings they differ.
Chart chart_of_rows(const std::vector<nlohmann::json>& rows, const RowChart&, const Fields& = Fields());

}  // namespace pellucid::plots
