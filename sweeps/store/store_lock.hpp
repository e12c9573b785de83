#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <string>

/// Who may write a store. For store.cpp alone.
namespace pellucid::sweeps {

/// Whether `path`, or the folder it will be made in, lies on a file system that several machines share (NFS, Lustre,
/// GPFS, SMB, Ceph, BeeGFS, sshfs, 9p …). SQLite's write-ahead log needs memory that all its users share, and locks may
/// be honoured within one machine only there. $PELLUCID_NETWORK_STORES = 1 or 0 answers for a file system that is not
/// recognised.
bool on_network_file_system(const std::filesystem::path& path);

/// One writer at a time: a file STORE-lock that can be made only once and names its owner. `flock` on it tells a living
/// owner from a dead one where it works; where it does not, the owner's process does. A lock that another machine holds
/// stays until that one or a person removes it, since nothing here can tell whether its owner lives.
class WriteLock {
 public:
  /// Throws RuntimeError when another process writes the store.
  explicit WriteLock(const std::filesystem::path& store);
  ~WriteLock();
  WriteLock(const WriteLock&) = delete;
  WriteLock& operator=(const WriteLock&) = delete;

  /// Throws RuntimeError when the lock has been taken away meanwhile: writing on would mix two writers.
  void check() const;

 private:
  bool acquire();
  bool take_over(int file);
  std::string store_, path_;
  int file_ = -1;
  std::uint64_t inode_ = 0, unsigned_inode_ = 0;
  std::chrono::steady_clock::time_point unsigned_since_;
};

}  // namespace pellucid::sweeps
