#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace pellucid {

/// SHA-256 as 64 hexadecimal digits.
std::string sha256_hex(std::span<const std::byte>);
std::string sha256_hex(std::string_view text);
/// The hash of a file's content. Throws InputError when it cannot be read.
std::string sha256_file(const std::filesystem::path&);

/// SHA-256 of several pieces. add() puts each piece's length before it, so that ("ab", "c") and ("a", "bc") differ.
class Sha256 {
 public:
  Sha256();
  ~Sha256();
  Sha256(Sha256&&) noexcept;
  Sha256& operator=(Sha256&&) noexcept;

  void add(std::span<const std::byte>);
  void add(std::string_view text);
  /// The digest of everything added so far; starts anew.
  std::string hex();

 private:
  friend std::string sha256_hex(std::span<const std::byte>);
  friend std::string sha256_file(const std::filesystem::path&);
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace pellucid
