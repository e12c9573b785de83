#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>

#include <nlohmann/json.hpp>

#include "gl/live_objects.hpp"
#include "sandbox/viewer/state/random_tweaks.hpp"

namespace pellucid::sandbox {

/// An endurance run (`--random-tweaks`): turns every knob at random, and looks for pictures of another state than the
/// panel's, for failures of renderers, and for what is left behind. At its end the last state is drawn once more by a
/// renderer that has just started: the picture must be the same bit for bit, from as many GL objects and open files.
class Tweaking {
 public:
  Tweaking(std::uint64_t seed, double seconds);
  /// Compares with a technique, or with nothing (empty).
  std::function<void(const std::string&)> compare;
  /// One turn of the window's loop; false when the run is over.
  bool turn(Workspace&);
  /// The figures of the run; `faults` is an empty list when all is well.
  nlohmann::json report(const Workspace&) const;
  bool faultless() const { return faults_.empty(); }

 private:
  enum class Phase { opening, running, settling, renewed, over };
  struct Counts {
    gl::LiveObjects objects;  ///< of the window's own context
    std::size_t files = 0, renderer_files = 0, children = 0;
  };
  static Counts counts(const Workspace&);
  void check(const Workspace&);
  void look_back(const Workspace&);
  void fault(const std::string&);
  RandomTweaks tweaks_;
  double seconds_ = 0, began_s_ = 0, asked_s_ = 0;
  Phase phase_ = Phase::opening;
  int opened_ = 0;
  Counts first_, last_;
  std::shared_ptr<const Picture> old_;  ///< the last one of the run
  std::map<std::string, std::size_t> faults_;
  std::size_t failures_ = 0, cancelled_ = 0;
  int in_a_row_ = 0;  ///< cancelled without a picture between
};

}  // namespace pellucid::sandbox
