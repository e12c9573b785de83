#include "algorithms/technique_code.hpp"

#include <cassert>
#include <set>
#include <sstream>

#include "algorithms/scene/files/hash.hpp"
#include "gl/program.hpp"
#include "gl/resources/resources.hpp"

namespace pellucid {

std::string code_hash(std::string_view technique) {
  const TechniqueCode* code = kTechniqueCode;
  while (code->technique != nullptr && code->technique != technique)
    ++code;
  assert(code->technique != nullptr);
  std::set<std::string> shaders;
  std::istringstream names(code->shaders);
  for (std::string name; names >> name;)
    for (const std::string& file : gl::expand_includes(name, {}).files)
      shaders.insert(file);
  Sha256 hash;
  hash.add(std::string_view(code->sources_sha256));
  for (const std::string& name : shaders) {
    hash.add(name);
    hash.add(find_resource(name).value_or(std::string{}));
  }
  return hash.hex();
}

}  // namespace pellucid
