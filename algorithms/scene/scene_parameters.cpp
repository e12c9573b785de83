// The part of a scene that knows the file it was read from, and so its parameters.
#include <cstdint>
#include <string>

#include "algorithms/scene/scene.hpp"
#include "algorithms/scene/toml/scene_source.hpp"

namespace pellucid {

Scene::Scene() = default;
Scene::~Scene() = default;
Scene::Scene(Scene&&) noexcept = default;
Scene& Scene::operator=(Scene&&) noexcept = default;

ParameterRef Scene::parameters() {
  static const ParameterTable none;
  return {source ? &source->table() : &none, this};
}

std::uint64_t Scene::revision() const {
  return source ? source->revision() : 0;
}

std::string Scene::content_hash() const {
  return source ? source->content_hash() : std::string();
}

}  // namespace pellucid
