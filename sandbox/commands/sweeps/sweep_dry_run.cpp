#include "sandbox/commands/sweeps/sweep_dry_run.hpp"

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "algorithms/scene/files/tell.hpp"
#include "sweeps/spec/point_json.hpp"
#include "sweeps/workers/progress.hpp"

namespace pellucid::sandbox {

using nlohmann::json;
using namespace pellucid::sweeps;

namespace {

/// A guess from the points that a store holds: a point takes as long as those of its technique did, or else as all did.
class Pace {
 public:
  Pace(const Plan& plan, const std::map<std::string, StoredPoint>& stored) {
    for (const Point& point : plan.points) {
      const auto found = stored.find(point.id);
      if (found == stored.end() || found->second.failed) continue;
      for (Mean* mean : {&all_, &by_technique_[point.technique]}) {
        mean->total_s += found->second.wall_s;
        ++mean->points;
      }
    }
  }
  bool known() const { return all_.points > 0; }
  double seconds(const Point& point) const {
    const auto found = by_technique_.find(point.technique);
    const Mean& mean = found != by_technique_.end() ? found->second : all_;
    return mean.total_s / static_cast<double>(mean.points);
  }

 private:
  struct Mean {
    double total_s = 0;
    std::size_t points = 0;
  };
  Mean all_;
  std::map<std::string, Mean> by_technique_;
};

}  // namespace

std::map<std::string, StoredPoint> stored_points(const std::string& path) {
  std::map<std::string, StoredPoint> result;
  std::error_code error;
  if (path.empty() || !std::filesystem::exists(path, error)) return result;
  for (StoredPoint& point : Store(path, Access::read).points())
    result.emplace(point.id, std::move(point));
  return result;
}

std::vector<BlockStatus> count_blocks(const Spec& spec, const Plan& plan,
                                      const std::map<std::string, StoredPoint>& stored) {
  std::vector<BlockStatus> blocks;
  for (const Member& member : plan.members) {
    if (blocks.empty() || blocks.back().block != member.block) blocks.push_back({spec.name, member.block, 0, 0, 0});
    BlockStatus& status = blocks.back();
    ++status.planned;
    const auto found = stored.find(plan.points[member.point].id);
    if (found != stored.end()) ++(found->second.failed ? status.failed : status.done);
  }
  return blocks;
}

void print_blocks(const std::vector<BlockStatus>& blocks) {
  std::size_t width = 5;
  for (const BlockStatus& b : blocks)
    width = std::max({width, b.block.size(), b.sweep.size()});
  const auto line = [&](const std::string& sweep, const std::string& block, const BlockStatus& b) {
    fmt::print("{:{}}  {:{}}  {:>7}  {:>7}  {:>7}  {:>7}\n", sweep, width, block, width, b.planned, b.done, b.failed,
               b.left());
  };
  fmt::print("{:{}}  {:{}}  {:>7}  {:>7}  {:>7}  {:>7}\n", "sweep", width, "block", width, "planned", "done", "failed",
             "left");
  // Each device of a store has a total of its own: what one has measured another has not.
  for (std::size_t i = 0; i < blocks.size();) {
    const std::string& device = blocks[i].device;
    if (!device.empty() && blocks.back().device != blocks.front().device) fmt::print("on {}:\n", device);
    BlockStatus total;
    const std::size_t first = i;
    for (; i < blocks.size() && blocks[i].device == device; ++i) {
      line(blocks[i].sweep, blocks[i].block, blocks[i]);
      total.planned += blocks[i].planned;
      total.done += blocks[i].done;
      total.failed += blocks[i].failed;
    }
    if (i - first > 1) line("", "total", total);
  }
}

void print_dry_run(const Spec& spec, const Plan& plan, const std::string& store, bool list) {
  const auto stored = stored_points(store);
  const Pace pace(plan, stored);
  std::size_t left = 0;
  double limit_s = 0;
  double expected_s = 0;
  for (const Point& point : plan.points) {
    if (stored.contains(point.id)) continue;
    ++left;
    if (point.timing.enabled) limit_s += point.timing.max_seconds;
    if (pace.known()) expected_s += pace.seconds(point);
  }
  if (list) {
    for (const std::size_t index : plan.order) {
      const Point& point = plan.points[index];
      fmt::print("{} {}{}\n", point.id, repeat_command(point), stored.contains(point.id) ? "  # stored" : "");
    }
    fmt::print("\n");
  }
  print_blocks(count_blocks(spec, plan, stored));
  fmt::print("\n");
  for (const Skipped& skipped : plan.skipped) {
    fmt::print("left out of block {}: {}, by {}\n", skipped.block, counted(skipped.points, "point"), skipped.why);
  }
  fmt::print("{} distinct points, {} to measure", plan.points.size(), left);
  if (pace.known() && left > 0) fmt::print("; about {} at the stored points' pace", duration_text(expected_s));
  if (limit_s > 0) fmt::print("; at most {} of timing", duration_text(limit_s));
  fmt::print("\n");
}

void print_dry_run_json(const Plan& plan, const std::string& store) {
  const auto stored = stored_points(store);
  json points = json::array();
  for (const std::size_t index : plan.order) {
    json point = point_to_json(plan.points[index]);
    point["repeat"] = repeat_command(plan.points[index]);
    point["stored"] = stored.contains(plan.points[index].id);
    points.push_back(std::move(point));
  }
  fmt::print("{}\n", points.dump(2));
}

}  // namespace pellucid::sandbox
