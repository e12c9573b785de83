#pragma once

#include <functional>
#include <string_view>

namespace pellucid {

/// Hears how far long work inside prepare() has come, while it lives; one at a time in a process.
class ProgressListener {
 public:
  /// `hear` is called from any thread, by one at a time: the work's name ("cones of cube 1 of 2") and the share of it
  /// that is done, 0 to 1.
  explicit ProgressListener(std::function<void(std::string_view work, double share)> hear);
  ~ProgressListener();
  ProgressListener(const ProgressListener&) = delete;
  ProgressListener& operator=(const ProgressListener&) = delete;
};

/// To be called now and then by the work, from any thread. It costs an atomic load while nobody listens.
void tell_progress(std::string_view work, double share);

}  // namespace pellucid
