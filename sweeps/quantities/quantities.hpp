#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "algorithms/scene/toml/toml_reader.hpp"

/// Everything that a row of a store holds besides parameters: times, metrics, the techniques' native errors, where a
/// row comes from. Each is declared once, in a file `quantities.toml` of this room or of a technique's folder, and
/// tables, charts, reports, the window and `pellucid describe` read the declaration. The keys are explained in
/// README.md.
namespace pellucid::sweeps {

class Expression;

enum class Better { neither, less, more };
const char* name(Better);

struct Quantity {
  std::string name;     ///< the row's field, with its unit where it has one: "frame_ms_median"
  std::string label;    ///< of an axis, without unit: "frame time"
  std::string heading;  ///< of a table's row, unit included: "precomputation [s]"
  std::string unit;
  std::string doc;  ///< one line, no full stop
  int digits = 3;   ///< significant ones, for people
  Better better = Better::neither;
  bool text = false;      ///< words, not a number
  bool time = false;      ///< measured by timing frames: it may be unconverged, and an untimed row lacks it
  bool from_zero = true;  ///< an axis starts at 0
  bool identity = false;  ///< it tells which point a row is of: every CSV file has it, before the parameters
  std::string low, high;  ///< the quantities that bound it; empty without an interval
  std::string interval;   ///< what they are: "95 % interval of the median"
  std::string module;     ///< folder of the technique that declares it; empty for what all rows may have
  /// Worked out from the row's other fields: for every technique under "", else under each technique's name.
  std::map<std::string, std::shared_ptr<Expression>> expressions{};
};

/// "frame time [ms]"
std::string label_with_unit(const Quantity&);

/// The declared ones: this room's, then those of each technique's folder, in the order of the files.
const std::vector<Quantity>& quantities();
/// Null for a name that nobody declares.
const Quantity* find_quantity(std::string_view name);

/// The tables [quantities.NAME] of a file. `own`: of a paper or a user, so that each must be worked out by an
/// expression.
std::vector<Quantity> read_quantities(TableReader& root, bool own);

/// The row's value: its field, or what the quantity's expression gives. Nothing when it or a field of the expression is
/// absent, not a number or not finite.
std::optional<double> value_of(const Quantity&, const nlohmann::json& row);

}  // namespace pellucid::sweeps
