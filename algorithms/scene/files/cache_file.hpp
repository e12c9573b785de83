#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "gl/error.hpp"

/// Results that are dear to compute are kept in files by the hash of what they were made from. A file that is
/// truncated, altered or of something else costs a warning and is made again, and a folder that cannot be written costs
/// a warning and nothing else.
namespace pellucid {

/// $PELLUCID_CACHE/NAME, or $XDG_CACHE_HOME/pellucid/NAME, or ~/.cache/pellucid/NAME; empty, which means no files,
/// where none of them is set or PELLUCID_CACHE is "off".
std::filesystem::path cache_folder(std::string_view name);

/// One such file: a line that says what it is, the key, the body's checksum, and the body.
struct CacheFile {
  std::filesystem::path path;
  std::string what;  ///< "geocube": named in warnings, and in the file's first line
  std::string key;   ///< SHA-256 (hex)

  /// Hands the body to `unpack` and returns true, or false when the file is missing, damaged or of another key, or
  /// `unpack` throws; all but the first with a warning.
  bool read(const std::function<void(std::span<const std::byte>)>& unpack) const;
  /// Throws RuntimeError when it cannot be written.
  void write(std::span<const std::byte> body) const;
  /// The same with a warning in place of the error.
  void keep(std::span<const std::byte> body) const;
};

/// Values one after the other, as they lie in memory.
class ByteWriter {
 public:
  template <class T>
  requires std::is_trivially_copyable_v<T>
  void add(const T& value) {
    const auto bytes = std::as_bytes(std::span(&value, 1));
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
  }
  template <class T>
  void add(const std::vector<T>& values) {
    add(static_cast<std::uint64_t>(values.size()));
    const auto bytes = std::as_bytes(std::span(values));
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
  }
  const std::vector<std::byte>& bytes() const { return bytes_; }

 private:
  std::vector<std::byte> bytes_;
};

/// Reads them back; InputError where they end early.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::byte> bytes) : rest_(bytes) {}
  template <class T>
  requires std::is_trivially_copyable_v<T>
  void take(T& value) { copy(&value, sizeof(T)); }
  template <class T>
  void take(std::vector<T>& values) {
    std::uint64_t count = 0;
    take(count);
    if (count > rest_.size() / sizeof(T)) throw InputError("a list is longer than the file");
    values.resize(count);
    copy(values.data(), count * sizeof(T));
  }
  bool done() const { return rest_.empty(); }

 private:
  void copy(void* to, std::size_t count) {
    if (count > rest_.size()) throw InputError("it ends early");
    if (count > 0) std::memcpy(to, rest_.data(), count);
    rest_ = rest_.subspan(count);
  }
  std::span<const std::byte> rest_;
};

}  // namespace pellucid
