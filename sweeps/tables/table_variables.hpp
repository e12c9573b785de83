#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "algorithms/parameters.hpp"

/// Texts of a table that name what differs from column to column and from group to group: "{hulls} × {samples}".
namespace pellucid::sweeps {

using Variables = std::map<std::string, Value, std::less<>>;

/// `later` wins.
Variables merged(Variables, const Variables& later);

/// Replaces every {name}, also in the texts that come in by it. Throws InputError with the nearest name for an unknown
/// one, and for a text that names itself.
std::string expand(std::string_view text, const Variables&);

/// A variable's own value when the text is nothing but "{name}", else the expanded text.
Value expand_value(std::string_view text, const Variables&);

}  // namespace pellucid::sweeps
