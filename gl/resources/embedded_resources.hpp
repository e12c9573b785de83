#pragma once

#include <string_view>

/// The table that gl/resources/embed_resources.cmake generates; read it through gl/resources/resources.hpp.
namespace pellucid::embedded {

struct Resource {
  std::string_view name;
  std::string_view text;
};
extern const Resource kResources[];  // sorted by name
extern const unsigned kResourceCount;

}  // namespace pellucid::embedded
