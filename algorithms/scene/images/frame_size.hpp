#pragma once

#include <string>
#include <string_view>

namespace pellucid {

/// Width and height of a frame [pixels].
struct FrameSize {
  int width = 720;
  int height = 540;
};

/// "720x540". Throws InputError, which begins with `what`, for another form and for a size that no image may have
/// (check_image_size()).
FrameSize parse_frame_size(std::string_view text, const std::string& what);

}  // namespace pellucid
