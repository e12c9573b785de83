#include "algorithms/scene/images/frame_size.hpp"

#include <charconv>
#include <cstddef>
#include <system_error>

#include <fmt/format.h>

#include "algorithms/scene/images/image.hpp"
#include "gl/error.hpp"

namespace pellucid {
namespace {

bool read_whole(std::string_view digits, long long& out) {
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), out);
  return error == std::errc{} && end == digits.data() + digits.size();
}

}  // namespace

FrameSize parse_frame_size(std::string_view text, const std::string& what) {
  const std::size_t x = text.find('x');
  long long width = 0, height = 0;
  if (x == std::string_view::npos || !read_whole(text.substr(0, x), width) || !read_whole(text.substr(x + 1), height))
    throw InputError(fmt::format("{} '{}' is not WIDTHxHEIGHT, for example 720x540", what, text));
  check_image_size(width, height, what);
  return {static_cast<int>(width), static_cast<int>(height)};
}

}  // namespace pellucid
