#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace pellucid::sweeps {

/// Which of two rows stays that were measured separately for the same point, device and driver, and differ in what they
/// should not: in quality.
enum class Prefer { neither, oldest, newest };

struct MergeSummary {
  std::size_t stores = 0, rows = 0;    ///< rows: in the result
  std::size_t added = 0;               ///< rows that the result did not have
  std::size_t duplicates = 0;          ///< the same row again
  std::size_t repeats = 0;             ///< measured twice with equal quality values: the earlier one stays
  std::vector<std::string> conflicts;  ///< measured twice with different quality values, a line each; settled by Prefer
};

/// Adds everything in `inputs` to the store `output`, which is made when missing: plans, rows, baselines and runs. The
/// result does not depend on the order of the inputs, nor on how often one is given. A row that is `ok` beats a failed
/// one; else the one measured first stays. All or nothing: throws InputError, and leaves `output` as it was, when rows
/// conflict and `prefer` does not settle it, or when stores hold different plans under one name.
MergeSummary merge_stores(const std::filesystem::path& output, const std::vector<std::filesystem::path>& inputs,
                          Prefer prefer = Prefer::neither);

/// Whether a row's field depends on when and where it was measured rather than on what: times, memory, provenance.
bool is_circumstance(const std::string& field);

}  // namespace pellucid::sweeps
