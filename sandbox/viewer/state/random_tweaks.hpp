#pragma once

#include <cstddef>
#include <cstdint>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "sandbox/viewer/state/workspace.hpp"

namespace pellucid::sandbox {

/// Turns every knob at random, the same way for the same seed: the endurance test of the window (`--random-tweaks`).
class RandomTweaks {
 public:
  explicit RandomTweaks(std::uint64_t seed) : random_(seed) {}
  /// One change of a parameter, technique, view, camera, size or scene; does nothing while the last is being drawn.
  void step(Workspace&);
  /// Now and then a technique to compare with, or kNothing; else empty.
  std::string comparison();
  static constexpr const char* kNothing = "(nothing)";
  /// For a picture that claims to be of the panel's state: the first parameter in which it is not; empty when all
  /// agree.
  static std::string disagreement(const Workspace&);
  std::size_t steps() const { return steps_; }
  /// The numbers of different ones that have been turned.
  std::size_t parameters_seen() const { return parameters_.size(); }
  std::size_t techniques_seen() const { return techniques_.size(); }
  std::size_t scenes_seen() const { return scenes_.size(); }

 private:
  static std::string disagreement(const Workspace&, Side);
  template <class T>
  const T& one_of(const std::vector<T>&);
  double share() { return std::uniform_real_distribution<double>(0, 1)(random_); }
  void parameter(Workspace&, Side);
  std::mt19937_64 random_;
  std::size_t steps_ = 0;
  std::set<std::string> parameters_, techniques_, scenes_;
};

}  // namespace pellucid::sandbox
