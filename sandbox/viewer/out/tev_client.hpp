#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "algorithms/scene/images/image.hpp"

/// Pictures to a window of tev or HDRView, which listen on a TCP port (tev's default is 127.0.0.1:14158). A packet is a
/// uint32 with its length in bytes, itself included, a byte with its kind, and fields without padding, little-endian;
/// texts end with a zero byte. Kind 4 makes an image (focus, name, width, height, channels), kind 6 fills a rectangle
/// of it (focus, name, channels, x, y, width, height, offsets, strides, values).
namespace pellucid::sandbox {

std::vector<std::uint8_t> tev_create_packet(std::string_view name, const Image&);
std::vector<std::uint8_t> tev_update_packet(std::string_view name, const Image&);

class TevClient {
 public:
  /// "HOST:PORT"; throws InputError when it is not of that form, RuntimeError when nobody answers there.
  explicit TevClient(const std::string& address);
  ~TevClient();
  TevClient(const TevClient&) = delete;
  TevClient& operator=(const TevClient&) = delete;
  /// Shows `image` (scene-linear) under `name`: a new image there, or new values when the size is the same as last
  /// time. Throws RuntimeError when the other side is gone.
  void send(const std::string& name, const Image& image);

 private:
  void write(const std::vector<std::uint8_t>&);
  std::string address_, name_;
  int socket_ = -1, width_ = 0, height_ = 0;
};

}  // namespace pellucid::sandbox
