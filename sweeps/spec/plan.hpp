#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "algorithms/scene/images/frame_size.hpp"
#include "sweeps/spec/point_parameters.hpp"
#include "sweeps/spec/spec.hpp"

namespace pellucid::sweeps {

/// One measurement: everything that determines its result.
struct Point {
  std::string id;  ///< 16 hex digits; the same for the same measurement in any block and any spec
  std::string technique, scene, view;
  FrameSize size;
  PointParameters parameters;         ///< the technique's, `scene.…`, `frame.…` and `shadow.…`, every one
  std::vector<std::string> assigned;  ///< those that the spec gives, in order: axes, then fixed
  std::vector<std::string> metrics;
  TimingLimits timing;
  ReferenceSettings reference;
  std::string scene_hash;  ///< of the scene at its defaults
  std::string code_hash;
  Keep keep = Keep::nothing;  ///< no part of the id
};

/// A point's place in a block, where it stands once. Two blocks may hold the same point; it is measured once.
struct Member {
  std::string block;
  std::size_t point = 0;  ///< index into Plan::points
};

/// A point that a block asks for and does not get.
struct Skipped {
  std::string block;
  std::string why;  ///< "the constraint 'hulls * samples <= 64'" or "the same point again"
  std::size_t points = 0;
};

struct Plan {
  std::vector<Point> points;       ///< in the order of the spec, each once
  std::vector<Member> members;     ///< in the order of the spec
  std::vector<std::size_t> order;  ///< in which points are measured
  std::vector<Skipped> skipped;
  std::map<std::string, ParameterInfo> parameters;  ///< of any of the points, by full name
  std::optional<std::size_t> baseline;              ///< the point that is measured again and again
};

/// No spec may ask for more points than this.
inline constexpr std::size_t kMaxPoints = 100'000;

/// Expands a spec. Throws InputError "source:line:column: …" when a constraint is wrong or leaves a block empty. The
/// order is a seeded shuffle: points that share scene, size and precomputation run in chunks, chunks of different
/// techniques interleave, and points within a chunk that share a program are neighbours.
Plan make_plan(const Spec&, const KnownNames& = installed_names());

/// Where the picture of a point that keeps one lies: STORE.pictures/ID.png or .exr.
std::filesystem::path picture_path(const std::filesystem::path& store, const Point&);

/// One line that renders the point by hand: `pellucid render SCENE -t … -s …`.
std::string repeat_command(const Point&);

}  // namespace pellucid::sweeps
