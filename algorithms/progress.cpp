#include "algorithms/progress.hpp"

#include <atomic>
#include <cassert>
#include <mutex>
#include <utility>

namespace pellucid {
namespace {

std::mutex hearing;
std::atomic<bool> listened{false};
std::function<void(std::string_view, double)> listener;

}  // namespace

ProgressListener::ProgressListener(std::function<void(std::string_view, double)> hear) {
  assert(hear && !listened);
  const std::scoped_lock lock(hearing);
  listener = std::move(hear);
  listened = true;
}

ProgressListener::~ProgressListener() {
  const std::scoped_lock lock(hearing);
  listened = false;
  listener = nullptr;
}

void tell_progress(std::string_view work, double share) {
  if (!listened.load(std::memory_order_relaxed)) return;
  const std::scoped_lock lock(hearing);
  if (listener) listener(work, share);
}

}  // namespace pellucid
