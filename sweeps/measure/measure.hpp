#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "algorithms/render_session.hpp"
#include "sweeps/measure/quiet_lock.hpp"
#include "sweeps/measure/reference_cache.hpp"
#include "sweeps/spec/plan.hpp"

namespace pellucid::sweeps {

/// A worker's result for a point: the measured part of its row, and every frame time.
struct Measurement {
  nlohmann::json row = nlohmann::json::object();
  std::vector<double> frame_ms_samples;
};

/// Measures points one after another in one process with a current GL context, keeping what the next may share: the
/// session (scene and precomputation) and the references.
class Measurer {
 public:
  using Progress = std::function<void(const char* phase, double share)>;
  /// `quiet`: the file that several workers of a machine share (quiet_lock.hpp).
  explicit Measurer(Progress progress, const std::filesystem::path& quiet = {})
      : progress_(std::move(progress)), quiet_(quiet) {}

  /// Draws, times and compares. Throws InputError or RuntimeError with the reason when the point cannot be measured, a
  /// pixel that is not finite among them; the next point then starts from a fresh session.
  /// `picture`: where the frame goes, as Point::keep says; empty: nowhere.
  Measurement measure(const Point&, const std::filesystem::path& references, const std::filesystem::path& picture = {});
  /// The frame time alone.
  Measurement time(const Point&);
  /// The reference alone, into the folder.
  void trace(const Point&, const std::filesystem::path& references);

 private:
  void open_session(const Point&);
  void time_frames(const Point&, Measurement& result);
  void time_passes(Measurement& result);
  std::shared_ptr<const CachedReference> reference(const Point&, const std::filesystem::path& references);
  void compare(const Point&, const Image& color, const std::filesystem::path& references, Measurement& result);

  Progress progress_;
  QuietLock quiet_;
  std::string session_key_;
  std::optional<RenderSession> session_;
  std::map<std::string, Value> assigned_;
  double prepare_s_ = 0;  // of the precomputation that is in the session now
  std::unique_ptr<ReferenceCache> references_;
};

}  // namespace pellucid::sweeps
