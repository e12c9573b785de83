#include "sweeps/spec/known_names.hpp"

#include <map>
#include <utility>

#include "algorithms/reference/reference.hpp"
#include "algorithms/scene/scene.hpp"
#include "algorithms/technique.hpp"
#include "algorithms/technique_code.hpp"

namespace pellucid::sweeps {
namespace {

class Installed final : public KnownNames {
 public:
  std::vector<std::string> techniques() const override {
    std::vector<std::string> names;
    for (const TechniqueInfo& info : pellucid::techniques())
      names.emplace_back(info.name);
    return names;
  }

  std::vector<ParameterInfo> technique_parameters(std::string_view technique) const override {
    const auto infos = find_technique(technique).table().infos();
    return {infos.begin(), infos.end()};
  }

  std::string code_hash(std::string_view technique) const override { return pellucid::code_hash(technique); }

  const SceneFacts& scene(const std::string& name) const override {
    const auto known = scenes_.find(name);
    if (known != scenes_.end()) return known->second;
    Scene scene = load_scene(name);
    SceneFacts facts;
    facts.content_hash = scene.content_hash();
    for (const View& view : scene.views)
      facts.views.push_back(view.name);
    facts.interfaces = has_interfaces(scene);
    facts.volume = scene.volume.has_value();
    const auto infos = scene.parameters().infos();
    facts.parameters.assign(infos.begin(), infos.end());
    return scenes_.emplace(name, std::move(facts)).first->second;
  }

 private:
  mutable std::map<std::string, SceneFacts> scenes_;
};

}  // namespace

const KnownNames& installed_names() {
  static const Installed known_names;
  return known_names;
}

}  // namespace pellucid::sweeps
