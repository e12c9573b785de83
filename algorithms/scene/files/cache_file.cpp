#include "algorithms/scene/files/cache_file.hpp"

#include <algorithm>
#include <cstdlib>
#include <exception>
#include <fstream>

#include <fmt/format.h>

#include "algorithms/scene/files/atomic_file.hpp"
#include "algorithms/scene/files/hash.hpp"
#include "algorithms/scene/files/tell.hpp"

namespace pellucid {

namespace fs = std::filesystem;

namespace {

std::string head_of(const CacheFile& file) {
  return "pellucid " + file.what + "\n" + file.key;
}

std::vector<char> all_of(const fs::path& path) {
  std::ifstream in(path, std::ios::binary | std::ios::ate);
  const std::streamoff size = in ? static_cast<std::streamoff>(in.tellg()) : 0;
  std::vector<char> text(static_cast<std::size_t>(std::max<std::streamoff>(size, 0)));
  in.seekg(0);
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (!in) throw InputError("it cannot be read");
  return text;
}

}  // namespace

fs::path cache_folder(std::string_view name) {
  const auto set = [](const char* variable) -> std::string {
    const char* value = std::getenv(variable);
    return value != nullptr ? value : "";
  };
  if (const std::string own = set("PELLUCID_CACHE"); !own.empty())
    return own == "off" ? fs::path() : fs::path(own) / name;
  if (const std::string xdg = set("XDG_CACHE_HOME"); !xdg.empty()) return fs::path(xdg) / "pellucid" / name;
  if (const std::string home = set("HOME"); !home.empty()) return fs::path(home) / ".cache" / "pellucid" / name;
  return {};
}

bool CacheFile::read(const std::function<void(std::span<const std::byte>)>& unpack) const {
  std::error_code error;
  if (!fs::exists(path, error)) return false;
  try {
    const std::vector<char> text = all_of(path);
    const std::string head = head_of(*this);
    constexpr std::size_t kDigits = 64;
    if (text.size() < head.size() + kDigits || std::string_view(text.data(), head.size()) != head)
      throw InputError("it holds something else");
    const auto body = std::as_bytes(std::span(text)).subspan(head.size() + kDigits);
    if (std::string_view(text.data() + head.size(), kDigits) != sha256_hex(body))
      throw InputError("its checksum is wrong");
    unpack(body);
    return true;
  } catch (const std::exception& e) {
    tell("warning: cached {} '{}' cannot be used ({}); making it again", what, path.string(), e.what());
    return false;
  }
}

void CacheFile::write(std::span<const std::byte> body) const {
  std::error_code error;
  fs::create_directories(path.parent_path(), error);
  if (error)
    throw RuntimeError(fmt::format("folder '{}' cannot be made: {}", path.parent_path().string(), error.message()));
  AtomicFile out(path);
  out.write(head_of(*this));
  out.write(sha256_hex(body));
  out.write(body);
  out.commit();
}

void CacheFile::keep(std::span<const std::byte> body) const {
  try {
    write(body);
  } catch (const RuntimeError& e) {
    tell("warning: the {} is not cached: {}", what, e.what());
  }
}

}  // namespace pellucid
