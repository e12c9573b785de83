#include "algorithms/scene/files/tell.hpp"

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstdio>
#include <mutex>

namespace pellucid {

namespace {

std::mutex telling;
std::function<void(std::string_view)> tell_listener;

/// Bytes of the UTF-8 character that the text begins with (RFC 3629); 0 where it begins with none.
std::size_t character_length(std::string_view text) {
  const auto byte = [&](std::size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0U; };
  const unsigned first = byte(0), second = byte(1);
  if (first < 0x80) return 1;
  const std::size_t length = first < 0xC2 ? 0 : first < 0xE0 ? 2 : first < 0xF0 ? 3 : first < 0xF5 ? 4 : 0;
  for (std::size_t i = 1; i < length; ++i)
    if ((byte(i) & 0xC0U) != 0x80U) return 0;
  // Longer than need be, surrogates, and what lies beyond U+10FFFF.
  if ((first == 0xE0 && second < 0xA0) || (first == 0xED && second >= 0xA0) || (first == 0xF0 && second < 0x90) ||
      (first == 0xF4 && second >= 0x90))
    return 0;
  return length;
}

}  // namespace

std::string printable(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size();) {
    const std::string_view rest = text.substr(i);
    const std::size_t length = character_length(rest);
    const auto byte = static_cast<unsigned char>(rest[0]);
    // U+0080 to U+009F, too, are obeyed by some terminals.
    const bool controls =
        byte < 0x20 || byte == 0x7F || (length == 2 && byte == 0xC2 && static_cast<unsigned char>(rest[1]) < 0xA0);
    if (length > 0 && !controls) {
      out += rest.substr(0, length);
    } else if (byte == '\n') {
      out += "\\n";
    } else if (byte == '\t') {
      out += "\\t";
    } else {
      for (const char c : rest.substr(0, std::max<std::size_t>(length, 1)))
        out += fmt::format("\\x{:02x}", static_cast<unsigned char>(c));
    }
    i += std::max<std::size_t>(length, 1);
  }
  return out;
}

std::string counted(std::size_t n, std::string_view noun, std::string_view plural) {
  if (n == 1) return fmt::format("1 {}", noun);
  return plural.empty() ? fmt::format("{} {}s", n, noun) : fmt::format("{} {}", n, plural);
}

TellListener::TellListener(std::function<void(std::string_view)> hear) {
  const std::scoped_lock lock(telling);
  assert(hear && !tell_listener);
  tell_listener = std::move(hear);
}

TellListener::~TellListener() {
  const std::scoped_lock lock(telling);
  tell_listener = nullptr;
}

void tell_line(std::string_view line) {
  const std::string text = printable(line);
  const std::scoped_lock lock(telling);
  if (tell_listener) {
    tell_listener(text);
  } else {
    fmt::print(stderr, "{}\n", text);
  }
}

}  // namespace pellucid
