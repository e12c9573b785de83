#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <span>
#include <string_view>

namespace pellucid {

/// A file that appears whole or not at all: it is written without a name (or where the file system knows no such files
/// under another name beside its target) and takes its place in commit(). A file that is replaced keeps its mode. A
/// target that exists and is no regular file (a device, a pipe) is written in place. Every failure throws
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
  int open_unnamed_or_temporary();
  std::filesystem::path temporary_name() const;
  void remove_temporary();
  std::filesystem::path target_;
  std::filesystem::path temporary_;  ///< the name that it has before its own; empty while it has none
  bool in_place_ = false;
  std::FILE* file_ = nullptr;
};

/// Writes `text` as one atomic file.
void write_text_file(const std::filesystem::path&, std::string_view text);

}  // namespace pellucid
