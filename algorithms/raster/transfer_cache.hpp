#pragma once

#include <filesystem>

#include "algorithms/scattering/transfer_table.hpp"

namespace pellucid {

/// The transfer functions of a medium, read from `folder` where they were made before, which takes tens of
/// milliseconds; an empty path keeps no files. Throws InputError for a medium out of range.
scattering::TransferTable transfer_table(const scattering::SlabMedium&, scattering::TransferModel,
                                         const std::filesystem::path& folder);

}  // namespace pellucid
