#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "algorithms/scene/scene.hpp"

/// `render --frames 0:120 --fps 30 -o out.%04d.exr`: a range of times, and a way of the camera through views.
namespace pellucid::sandbox {

struct FrameRange {
  int first = 0, last = 0;  ///< both are drawn
  int count() const { return last - first + 1; }
};
/// "0:120" or "7". Throws InputError.
FrameRange parse_frames(const std::string& text);

/// `pattern` with its one %d or %04d filled in. Throws InputError when it has none, or anything else that printf knows.
std::filesystem::path numbered(const std::string& pattern, int frame);

/// The camera of `frame`: on the way from the first of `views` (names or texts) at the first frame to the last of them
/// at the last.
View frame_view(const Scene&, const std::vector<std::string>& views, const FrameRange&, int frame);

}  // namespace pellucid::sandbox
