#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace pellucid::gl {

/// An EGL device, or the surfaceless platform, that gives an OpenGL 4.5 core context.
struct Device {
  int index = -1;        ///< what `--device N` takes; -1 is surfaceless
  std::string platform;  ///< "device" or "surfaceless"
  std::string vendor, renderer, version;
};

/// The current context's limits; sizes in texels or bytes.
struct Limits {
  int max_texture_size = 0;
  int max_3d_texture_size = 0;
  int max_cube_size = 0;
  int max_array_layers = 0;
  std::size_t max_ssbo_bytes = 0;
  std::size_t max_ubo_bytes = 0;
};

/// Devices that really give a context, in EGL's order, then the surfaceless platform if it works.
std::vector<Device> list_devices();

struct ContextOptions {
  std::optional<int> device;  ///< EGL device; without it the first device that works, else surfaceless
  bool debug = true;          ///< KHR_debug: errors become exceptions that carry the object's label
};

/// A headless OpenGL 4.5 core context. Move-only; made current on construction. Throws RuntimeError with the reason,
/// and InputError for a device that does not exist (naming those that do).
class Context {
 public:
  explicit Context(const ContextOptions& options = {});
  ~Context();
  Context(Context&&) noexcept;
  Context& operator=(Context&&) noexcept;

  void make_current();
  const Device& device() const { return device_; }
  const Limits& limits() const { return limits_; }
  /// llvmpipe and other CPU rasterisers: timer queries lie there (see timer.hpp).
  bool software() const;

 private:
  void release() noexcept;
  void* display_ = nullptr;
  void* context_ = nullptr;
  bool debug_ = false;
  Device device_;
  Limits limits_;
};

/// Installs KHR_debug on whatever context is current (the viewer's window too) and reads its limits.
Limits adopt_current_context(bool debug = true);

/// Limits of the context that is current. Asserts that there is one.
const Limits& limits();

/// True if the current context rasterises on the CPU.
bool software_renderer();

/// Throws RuntimeError("operation on 'label': message") if the debug callback has seen an error since the last call.
/// Every wrapper below calls it after the GL calls it makes; cheap when there was none.
void check(std::string_view operation, std::string_view label);

/// Bytes of all live textures and buffers made through the wrappers.
std::size_t allocated_bytes();

/// Called by the wrappers on creation and destruction.
void account_bytes(std::ptrdiff_t delta);

}  // namespace pellucid::gl
