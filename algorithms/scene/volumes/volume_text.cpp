#include <charconv>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <system_error>

#include <fmt/format.h>

#include "algorithms/scene/volumes/volume_formats.hpp"

/// Voxels that are written as text: numbers between blanks (NRRD's encoding "ascii", MetaImage's BinaryData = False),
/// or the digits of their bytes (NRRD's "hex").
namespace pellucid {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view kBlanks = " \t\r\n\v\f";

}  // namespace

std::string voxels_of_numbers(const fs::path& path, std::string_view text, std::size_t count, const VoxelType& type) {
  if (count > (text.size() + 1) / 2)  // a digit and a blank each
    fail_volume(path, fmt::format("{} bytes of text hold no {} voxels", text.size(), count));
  std::string out(count * type.bytes, '\0');
  std::size_t found = 0;
  for (std::size_t at = 0; (at = text.find_first_not_of(kBlanks, at)) != std::string_view::npos; ++found) {
    std::string_view word = text.substr(at, text.find_first_of(kBlanks, at) - at);
    at += word.size();
    if (word.size() > 1 && word.ends_with(',')) word.remove_suffix(1);
    if (found == count) fail_volume(path, fmt::format("more than the {} voxels that its header promises", count));
    const std::string_view digits = word.substr(word.starts_with('+') && !word.starts_with("+-") ? 1 : 0);
    double value = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error != std::errc() || end != digits.data() + digits.size() ||
        !type.store(value, out.data() + found * type.bytes))
      fail_volume(path, fmt::format("voxel {} is '{}', no number of its type", found, word.substr(0, 40)));
  }
  if (found < count) fail_volume(path, fmt::format("{} voxels where its header promises {}", found, count));
  return out;
}

std::string bytes_of_digits(const fs::path& path, std::string_view text, std::size_t promised) {
  if (promised > text.size() / 2) fail_volume(path, fmt::format("{} digits hold no {} bytes", text.size(), promised));
  std::string out;
  out.reserve(promised);
  int high = -1;  // the first digit of a byte
  for (const char c : text) {
    if (kBlanks.find(c) != std::string_view::npos) continue;
    constexpr std::string_view kDigits = "0123456789abcdefABCDEF";
    const std::size_t place = kDigits.find(c);
    if (place == std::string_view::npos)
      fail_volume(path, fmt::format("byte 0x{:02x} among its voxels is no hexadecimal digit", std::uint8_t(c)));
    const int digit = static_cast<int>(place < 16 ? place : place - 6);
    if (high < 0) {
      high = digit;
      continue;
    }
    if (out.size() == promised)
      fail_volume(path, fmt::format("more than the {} bytes that its header promises", promised));
    out += static_cast<char>(16 * high + digit);
    high = -1;
  }
  if (out.size() < promised || high >= 0)
    fail_volume(path, fmt::format("{} bytes of voxels where its header promises {}", out.size(), promised));
  return out;
}

}  // namespace pellucid
