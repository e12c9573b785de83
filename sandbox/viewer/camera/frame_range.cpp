#include "sandbox/viewer/camera/frame_range.hpp"

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <string_view>

#include <fmt/format.h>

#include "algorithms/scene/view_text.hpp"
#include "gl/error.hpp"
#include "sandbox/viewer/camera/path.hpp"

namespace pellucid::sandbox {
namespace {

constexpr int kMostFrames = 1'000'000;

bool read(std::string_view text, int& out) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), out);
  return error == std::errc{} && end == text.data() + text.size() && out >= 0 && out < kMostFrames;
}

}  // namespace

FrameRange parse_frames(const std::string& text) {
  const std::size_t colon = text.find(':');
  FrameRange range;
  const bool good = read(std::string_view(text).substr(0, colon), range.first) &&
                    read(std::string_view(text).substr(colon == std::string::npos ? 0 : colon + 1), range.last);
  if (!good || range.last < range.first)
    throw InputError(fmt::format("--frames {} is not FIRST:LAST, for example 0:120", text));
  return range;
}

std::filesystem::path numbered(const std::string& pattern, int frame) {
  const std::size_t percent = pattern.find('%');
  std::size_t end = percent == std::string::npos ? percent : percent + 1;
  int width = 0;
  bool zeros = false;
  if (percent != std::string::npos) {
    zeros = end < pattern.size() && pattern[end] == '0';
    while (end < pattern.size() && pattern[end] >= '0' && pattern[end] <= '9' && width < 100)
      width = width * 10 + (pattern[end++] - '0');
  }
  const bool good = percent != std::string::npos && end < pattern.size() && pattern[end] == 'd' && width <= 12 &&
                    pattern.find('%', percent + 1) == std::string::npos;
  if (!good)
    throw InputError(fmt::format("-o {}: with --frames the name has one %d, for example out.%04d.exr", pattern));
  const std::string number =
      zeros ? fmt::format("{:0{}}", frame, width) : fmt::format("{:{}}", frame, std::max(1, width));
  return pattern.substr(0, percent) + number + pattern.substr(end + 1);
}

View frame_view(const Scene& scene, const std::vector<std::string>& views, const FrameRange& range, int frame) {
  std::vector<View> stops;
  for (const std::string& view : views)
    stops.push_back(view_of(scene, view));
  if (stops.size() == 1) return stops.front();
  return view_along(stops, range.count() < 2 ? 0 : static_cast<double>(frame - range.first) / (range.count() - 1));
}

}  // namespace pellucid::sandbox
