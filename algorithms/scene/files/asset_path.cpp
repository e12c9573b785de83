#include "algorithms/scene/files/asset_path.hpp"

#include <algorithm>
#include <cstdlib>
#include <string>

#include <fmt/format.h>

#include "gl/error.hpp"

namespace pellucid {

namespace fs = std::filesystem;

namespace {

/// Where assets lie without $PELLUCID_ASSETS: in the tree that the program is installed in (PREFIX/bin beside
/// PREFIX/share/pellucid), or in the source tree that it was built in (build/NAME/bin). No path is built in, so that
/// either tree may be moved.
fs::path own_assets() {
  std::error_code error;
  const fs::path folder = fs::read_symlink("/proc/self/exe", error).parent_path();
  const fs::path installed = folder.parent_path() / "share/pellucid/assets";
  if (fs::is_directory(installed, error)) return installed;
  const fs::path sources = folder.parent_path().parent_path().parent_path();
  return fs::exists(sources / "bootstrap", error) ? sources / "assets" : installed;
}

}  // namespace

fs::path resolve_asset(std::string_view reference, const fs::path& folder) {
  constexpr std::string_view kScheme = "asset:";
  std::error_code error;
  if (!reference.starts_with(kScheme)) {
    const fs::path path = folder / fs::path(reference);
    if (fs::is_regular_file(path, error)) return path;
    throw InputError(
        fmt::format("'{}' {}", path.string(), fs::exists(path, error) ? "is not a file" : "does not exist"));
  }
  const fs::path name(reference.substr(kScheme.size()));
  const bool inside = !name.empty() && name.is_relative() && std::find(name.begin(), name.end(), "..") == name.end();
  if (!inside) throw InputError(fmt::format("'{}' is not the name of an asset", reference));
  const char* chosen = std::getenv("PELLUCID_ASSETS");
  const fs::path root = chosen != nullptr && *chosen != '\0' ? fs::path(chosen) : own_assets();
  const fs::path path = root / name;
  if (fs::is_regular_file(path, error)) return path;
  throw InputError(fmt::format("asset '{}' is missing (looked for '{}'); get it with: ./bootstrap assets",
                               name.string(), path.string()));
}

}  // namespace pellucid
