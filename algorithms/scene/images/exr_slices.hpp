#pragma once

#include <cstddef>
#include <string>
#include <type_traits>
#include <vector>

#include <ImathBox.h>
#include <ImfFrameBuffer.h>
#include <half.h>

/// For the EXR reader and writer.
namespace pellucid {

using Group = std::vector<std::string>;  ///< full channel names, in the order of the image's channels

/// Interleaved slices over `pixels`, whose first one lies at the data window's corner.
template <class Pixel>
void add_slices(Imf::FrameBuffer& frame, const Imath::Box2i& window, const Pixel* pixels, const Group& group) {
  constexpr Imf::PixelType kType = std::is_same_v<Pixel, Imath::half> ? Imf::HALF : Imf::FLOAT;
  const std::size_t x_stride = sizeof(Pixel) * group.size();
  const std::size_t y_stride = x_stride * static_cast<std::size_t>(window.max.x - window.min.x + 1);
  for (std::size_t c = 0; c < group.size(); ++c) {
    frame.insert(group[c], Imf::Slice::Make(kType, pixels + c, window, x_stride, y_stride));
  }
}

}  // namespace pellucid
