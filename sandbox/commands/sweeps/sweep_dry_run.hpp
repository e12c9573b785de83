#pragma once

#include <map>
#include <string>
#include <vector>

#include "sweeps/spec/plan.hpp"
#include "sweeps/spec/spec.hpp"
#include "sweeps/store/store.hpp"

namespace pellucid::sandbox {

/// A store's holdings of its points; empty without a name, or when there is no store yet.
std::map<std::string, sweeps::StoredPoint> stored_points(const std::string& path);

std::vector<sweeps::BlockStatus> count_blocks(const sweeps::Spec&, const sweeps::Plan&,
                                              const std::map<std::string, sweeps::StoredPoint>& stored);

void print_blocks(const std::vector<sweeps::BlockStatus>&);

/// `sweep run --dry-run`: the points by block, what is left out and why, and how long it may take; with `list` every
/// point in the order of measuring. No GL.
void print_dry_run(const sweeps::Spec&, const sweeps::Plan&, const std::string& store, bool list);
/// The points as a JSON array.
void print_dry_run_json(const sweeps::Plan&, const std::string& store);

}  // namespace pellucid::sandbox
