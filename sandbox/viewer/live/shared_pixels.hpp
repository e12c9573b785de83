#pragma once

#include <cstddef>
#include <span>
#include <string>

/// Memory that the window's process and its renderer share, for pictures. It has no name in any folder, so nothing of
/// it outlives the two.
namespace pellucid::sandbox {

class SharedPixels {
 public:
  SharedPixels();  ///< throws RuntimeError when the system refuses
  ~SharedPixels();
  SharedPixels(const SharedPixels&) = delete;
  SharedPixels& operator=(const SharedPixels&) = delete;

  /// The name by which the other process opens it, while this one lives.
  std::string path() const;
  /// Copies what the other process wrote. Throws RuntimeError when it wrote less.
  void copy_to(std::span<float> out) const;

 private:
  int file_ = -1;
};

/// The other process's side: writes `floats` one after another from the start, growing the memory to fit.
void write_shared_pixels(const std::string& path, std::span<const std::span<const float>> floats);

}  // namespace pellucid::sandbox
