#pragma once

#include "plots/figures/figures.hpp"

namespace pellucid::plots {

/// Reads one [[figures]] (keys: sweeps/README.md). Throws InputError "file:line:column: …".
Figure read_figure(const sweeps::PaperEntry&);

}  // namespace pellucid::plots
