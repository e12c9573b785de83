#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "algorithms/parameters.hpp"
#include "algorithms/scene/images/frame_size.hpp"
#include "algorithms/scene/toml/toml_reader.hpp"
#include "sweeps/spec/known_names.hpp"
#include "sweeps/spec/reference_settings.hpp"

/// A sweep's specification: a TOML file (format: sweeps/README.md), read and checked in full against the names that
/// there are.
namespace pellucid::sweeps {

/// One swept parameter: a technique's, `scene.…`, `frame.…` or `shadow.…`, with values of the parameter's own type.
struct Axis {
  std::string name;
  std::vector<Value> values;
  FilePosition at;
};

struct FixedValue {
  std::string name;
  Value value;
};

struct Constraint {
  std::string text;
  FilePosition at;
};

/// Which picture of each point stays beside the store.
enum class Keep { nothing, png, exr };

/// Axes that are walked together, as indices into RunBlock::axes. A block is the grid over its walks: a grid has a walk
/// for each axis, a zip has one of all axes.
using Walk = std::vector<std::size_t>;

/// When a point's timing ends.
struct TimingLimits {
  bool enabled = true;
  int min_samples = 30;
  int max_samples = 2000;
  double max_seconds = 30;     ///< of sampling, warm-up apart
  double relative_ci = 0.005;  ///< half-width of the 95 % interval of the median over the median
};

/// One `[[run]]`.
struct RunBlock {
  std::string name;
  std::vector<std::string> techniques;
  std::vector<std::string> scenes;
  std::vector<std::string> views;  ///< empty: each scene's first
  std::vector<FrameSize> sizes;
  std::vector<Axis> axes;
  std::vector<Walk> walks;  ///< every axis once; the axes of a walk have equally many values
  std::vector<FixedValue> fixed;
  std::vector<Constraint> constraints;
  std::vector<std::string> metrics;  ///< of metric_names() (metrics/metrics.hpp), in that order
  Keep keep = Keep::nothing;
  bool baseline = false;  ///< its first point is re-measured during the sweep
  TimingLimits timing;
  ReferenceSettings reference;
  FilePosition at;
};

struct Spec {
  std::string name;  ///< [a-z0-9_]+
  std::string title;
  std::string description;
  std::string source;      ///< file name that errors start with
  std::string text;        ///< as read
  double timeout_s = 600;  ///< a point that takes longer is recorded as failed
  std::vector<RunBlock> blocks;
};

/// How much of a spec is wanted: all of it, or what its [preview] leaves of it, whose name is NAME_preview.
enum class Extent { full, preview };

/// Reads both the spec and its preview, and returns the one that is wanted. Throws InputError "source:line:column: …"
/// for the first thing wrong, and for a preview of a spec that has none.
Spec parse_spec(std::string_view text, const std::string& source, const KnownNames& = installed_names(),
                Extent = Extent::full);

/// A path ending in .toml, or the name of an embedded spec (algorithms/TECHNIQUE/sweeps/NAME.toml); NAME_preview is its
/// preview.
Spec load_spec(const std::string& path_or_name, const KnownNames& = installed_names(), Extent = Extent::full);

/// Names of the embedded specs, sorted, each followed by that of its preview.
std::vector<std::string> list_specs();

}  // namespace pellucid::sweeps
