#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "algorithms/parameters.hpp"
#include "algorithms/scene/images/frame_size.hpp"
#include "algorithms/scene/toml/toml_reader.hpp"
#include "sweeps/spec/axis.hpp"
#include "sweeps/spec/spec.hpp"

/// The kinds of values that specs have beside those of every TOML file. Every error is an InputError with the place.
namespace pellucid::sweeps {

struct PlacedText {
  std::string text;
  FilePosition at;
};
/// A list of distinct strings; empty when the key is absent and optional.
std::vector<PlacedText> distinct_texts(TableReader&, std::string_view key, Need = Need::optional,
                                       bool may_be_empty = false);

/// A required name of [a-z0-9_]+, at most 100 characters.
std::string identifier(TableReader&, std::string_view key);

/// A named value of [run.axes] or [run.fixed]; `scene.x = …` and `"scene.x" = …` are the same.
struct NamedValue {
  std::string name;
  FilePosition at;  ///< of its key
  const toml::node* node;
  std::optional<TableReader> table;  ///< when the value is one, as a range is
};
/// All values of the table, in the order of the file.
std::vector<NamedValue> named_values(TableReader&);

/// A boolean, a number or a string.
Value value_of(const TableReader&, const toml::node&, std::string_view name);
/// `{ from, to, steps | log2 }`
AxisRange read_range(TableReader&);
/// WIDTHxHEIGHT
FrameSize read_size(const TableReader&, const PlacedText&);

}  // namespace pellucid::sweeps
