#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <span>
#include <string_view>

namespace pellucid {

/// A file that appears whole or not at all: it is written beside its target under another name and renamed by commit().
/// A target that exists and is no regular file (a device, a pipe) is written in place. Every failure throws
/// RuntimeError "cannot write 'path': reason", and what was written is removed unless commit() has succeeded.
class AtomicFile {
 public:
  explicit AtomicFile(std::filesystem::path target);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  void write(std::span<const std::byte> bytes);
  void write(std::string_view text);
  std::uint64_t position();
  void seek(std::uint64_t position);
  /// Flushes, closes and renames.
  void commit();

 private:
  [[noreturn]] void fail(int error_number) const;
  std::filesystem::path target_;
  std::filesystem::path written_;  ///< the temporary name, or the target itself when it is a device
  std::FILE* file_ = nullptr;
};

/// Writes `text` as one atomic file.
void write_text_file(const std::filesystem::path&, std::string_view text);

}  // namespace pellucid
