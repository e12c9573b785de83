#include "sweeps/spec/shard.hpp"

#include <charconv>
#include <string>

#include <fmt/format.h>

#include "gl/error.hpp"

namespace pellucid::sweeps {

bool Shard::holds(const Point& point) const {
  return std::stoull(point.id, nullptr, 16) % count == index - 1;
}

Shard parse_shard(const std::string& text) {
  Shard shard;
  const char* end = text.data() + text.size();
  const auto [slash, first] = std::from_chars(text.data(), end, shard.index);
  bool good = first == std::errc{} && slash != end && *slash == '/';
  if (good) {
    const auto [rest, second] = std::from_chars(slash + 1, end, shard.count);
    good = second == std::errc{} && rest == end;
  }
  if (!good || shard.count < 1 || shard.count > kMaxPoints || shard.index < 1 || shard.index > shard.count) {
    throw InputError(fmt::format("shard '{}' is not i/N with i from 1 to N, for example 2/16", text));
  }
  return shard;
}

}  // namespace pellucid::sweeps
