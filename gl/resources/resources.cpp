#include "gl/resources/resources.hpp"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

#include <fmt/format.h>

#include "gl/error.hpp"
#include "gl/resources/embedded_resources.hpp"

namespace pellucid {

std::optional<std::string> find_resource(std::string_view name) {
  if (const char* root = std::getenv("PELLUCID_SHADER_PATH"); root != nullptr && name.ends_with(".glsl")) {
    const std::filesystem::path path = std::filesystem::path(root) / name;
    if (std::filesystem::exists(path)) {
      std::ifstream file(path, std::ios::binary);
      std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
      if (!file) throw RuntimeError(fmt::format("cannot read the shader '{}'", path.string()));
      return text;
    }
  }
  const embedded::Resource* end = embedded::kResources + embedded::kResourceCount;
  const auto* it = std::find_if(embedded::kResources, end, [&](const auto& r) { return r.name == name; });
  if (it == end) return std::nullopt;
  return std::string(it->text);
}

std::vector<std::string> list_resources(std::string_view prefix, std::string_view suffix) {
  std::vector<std::string> names;
  for (unsigned i = 0; i < embedded::kResourceCount; ++i) {
    const std::string_view name = embedded::kResources[i].name;
    if (name.starts_with(prefix) && name.ends_with(suffix)) names.emplace_back(name);
  }
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace pellucid
