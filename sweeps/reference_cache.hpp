#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <list>
#include <memory>
#include <string>

#include "algorithms/reference/reference.hpp"
#include "algorithms/render_session.hpp"
#include "sweeps/metrics/metrics.hpp"
#include "sweeps/plan.hpp"

namespace pellucid::sweeps {

/// A reference made ready for comparing, with its own error.
struct CachedReference {
  Comparison comparison;
  double step_error_max = 0;
  double step_error_mean = 0;
  double unconverged_share = 0;
};

/// References by content, in memory (least recently used go first) and as EXR files in a folder. A file that is
/// truncated, altered or of other settings is traced again; a folder that cannot be written costs a warning and nothing
/// else.
class ReferenceCache {
 public:
  using Progress = std::function<void(double share)>;
  explicit ReferenceCache(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// For the session's scene, view and size at this moment.
  std::shared_ptr<const CachedReference> get(RenderSession&, const Point&, const Progress&);

  const std::filesystem::path& folder() const { return folder_; }

 private:
  struct Entry {
    std::string key;
    std::size_t bytes;
    std::shared_ptr<const CachedReference> reference;
  };
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
