#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "sweeps/papers/paper.hpp"
#include "sweeps/store/rows.hpp"

/// From the rows of a store to what a figure draws: chosen, checked, grouped.
namespace pellucid::plots {

using sweeps::field_text;
using sweeps::number;
using sweeps::Quantity;
using sweeps::settings;
using sweeps::value_text;

/// The values that a chart can draw of a row: its fields, and the quantities that are worked out from them.
class Fields {
 public:
  /// With the quantities of this paper besides those of all; it must outlive this.
  explicit Fields(const sweeps::Paper* paper = nullptr) : paper_(paper) {}
  /// Null for a parameter.
  const Quantity* find(std::string_view field) const;
  std::optional<double> value(const nlohmann::json& row, const std::string& field) const;
  /// The fields that a row must hold for `field`: itself, or all that its expressions use. Empty for no field.
  std::vector<std::string> sources_of(const std::string& field) const;
  /// Whether it is measured by timing frames.
  bool is_time(const std::string& field) const;

 private:
  const sweeps::Paper* paper_;
};

/// Rows that can be drawn, and how many could not.
struct Rows {
  std::vector<const nlohmann::json*> kept;  ///< each measurement once; points into what they were chosen from
  std::size_t failed = 0;                   ///< left out: the point failed
  std::size_t incomplete = 0;               ///< left out: a value was not measured (no such metric)
  std::size_t untimed = 0;                  ///< left out: measured without timing
  std::size_t unconverged = 0;              ///< kept, but the frame time's interval is wider than asked for
};

/// A field and the values that it may have, compared as text, numbers by value.
struct Where {
  std::string field;
  std::vector<std::string> values;
};

/// The rows that meet every condition and have a number in each of `needed`. A point that stands in several blocks or
/// specs counts once; one that lacks a parameter among `needed` is of another technique and is not counted. Throws
/// InputError for a field that no row has (nearest name), for a condition that no row meets (with the values there
/// are), and for rows of more than one device or driver.
Rows choose_rows(const std::vector<nlohmann::json>& rows, std::span<const Where> where,
                 std::span<const std::string> needed, const Fields& = Fields());

/// Rows that differ in nothing but the settings that a chart shows otherwise.
struct Group {
  std::string label;  ///< "sampling hulls, scene.density = 0.5"; the technique alone when nothing else differs
  std::string technique;
  std::size_t variant = 0;  ///< counts the groups of one technique
  std::vector<const nlohmann::json*> rows;
};

enum class Labels {
  all,      ///< every setting that divides
  unusual,  ///< only those in words that differ from what most rows have; usual_note() says what that is
};

/// Groups in the order in which they first appear. `own` names the settings that do not divide.
std::vector<Group> group_rows(const Rows&, std::span<const std::string> own, Labels = Labels::all);
/// "Unless named: coordinates automatic." for Labels::unusual; empty when nothing was left unsaid.
std::string usual_note(const Rows&, std::span<const std::string> own);
/// Throws InputError when two rows of one group agree in all of `own` too: measurements are never pooled.
void check_distinct(const std::vector<Group>&, std::span<const std::string> own);

/// A chart's note says where its rows come from: scene, size, device, clock if `timed`, and how many rows were
/// left out.
std::string provenance_note(const Rows&, bool timed);

}  // namespace pellucid::plots
