#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <list>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "algorithms/reference/reference.hpp"
#include "algorithms/render_session.hpp"
#include "sweeps/metrics/metrics.hpp"
#include "sweeps/spec/plan.hpp"

namespace pellucid::sweeps {

/// A reference made ready for comparing, with its own error.
struct CachedReference {
  Comparison comparison;      ///< with the regions "_mask" and, where asked for and not empty, "_shadow"
  double step_error_max = 0;  ///< of the exact one, as are the next two
  double step_error_mean = 0;
  double unconverged_share = 0;
  std::optional<SurfaceStatistics> traced{};  ///< of surfaces from rays
  std::optional<double> shadow_pixels_share;  ///< of the frame that "_shadow" covers; nothing when it was not asked for
  /// How far the method's picture lies from the exact reference: rmse and flip_mean; nothing for the exact one itself.
  std::optional<ComparisonResult> to_exact;
};

/// References by content, in memory (least recently used go first) and as EXR files in a folder. A file that is
/// truncated, altered or of other settings is traced again; a folder that cannot be written costs a warning and nothing
/// else.
class ReferenceCache {
 public:
  using Progress = std::function<void(double share)>;
  explicit ReferenceCache(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// For the session's scene, view, size and shadow maps at this moment, which are the point's. The part that is not
  /// traced but drawn (the method slices, the surfaces of the forward pass) is drawn anew in each process: it is of the
  /// device.
  std::shared_ptr<const CachedReference> get(RenderSession&, const Point&, const Progress&);

  const std::filesystem::path& folder() const { return folder_; }

 private:
  struct Entry {
    std::string key;
    std::size_t bytes;
    std::shared_ptr<const CachedReference> reference;
  };
  Reference traced(const std::string& key, const std::function<Reference()>& trace) const;

  std::filesystem::path folder_;
  std::list<Entry> entries_;  // most recently used first
};

/// The files of such a folder, without GL. `read` gives nothing when the file is missing, damaged or holds something
/// else.
class ReferenceFiles {
 public:
  explicit ReferenceFiles(std::filesystem::path folder) : folder_(std::move(folder)) {}
  std::unique_ptr<Reference> read(const std::string& key) const;
  /// Throws RuntimeError when it cannot be written.
  void write(const std::string& key, const Reference&) const;
  std::filesystem::path path(const std::string& key) const { return folder_ / (key + ".exr"); }

 private:
  std::filesystem::path folder_;
};

}  // namespace pellucid::sweeps
