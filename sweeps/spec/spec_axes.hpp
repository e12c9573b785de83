#pragma once

#include "algorithms/scene/toml/toml_reader.hpp"
#include "sweeps/spec/known_names.hpp"
#include "sweeps/spec/spec.hpp"

namespace pellucid::sweeps {

/// Reads what a `[[run]]` says of parameters ([run.axes], [run.fixed], `combine`, `zip`, `design`) into a block whose
/// techniques and scenes are known. Throws InputError with the place.
void read_axes(TableReader& run, const KnownNames&, RunBlock&);

}  // namespace pellucid::sweeps
