#include "algorithms/scene/toml/scene_source.hpp"

#include <algorithm>
#include <cassert>
#include <set>
#include <string_view>
#include <variant>

#include <fmt/format.h>

#include "algorithms/scene/files/hash.hpp"

namespace pellucid {

SceneSource::SceneSource(std::unique_ptr<SceneDescription> description, std::string text)
    : description_(std::move(description)), text_(std::move(text)) {
  std::vector<ParameterInfo> infos;
  for (const ParameterDescription& parameter : description_->parameters) {
    if (parameter.info.name == "time_s") time_index_ = infos.size();
    infos.push_back(parameter.info);
    values_.push_back(parameter.info.default_value);
  }
  connect();
  for (const Driven& driven : driven_)
    write(driven);
  table_ = ParameterTable(
      std::move(infos),
      [](const void* scene, std::size_t i) { return static_cast<const Scene*>(scene)->source->values_[i]; },
      [](void* scene, std::size_t i, const Value& value) {
        Scene& target = *static_cast<Scene*>(scene);
        target.source->assign(target, i, value);
      });
}

// ---- what drives what ----

void SceneSource::connect() {
  for (std::size_t p = 0; p < description_->parameters.size(); ++p) {
    for (const auto& drive : description_->parameters[p].drives) {
      const auto target = std::find_if(description_->targets.begin(), description_->targets.end(),
                                       [&](const DriveTarget& t) { return t.path == drive.first; });
      assert(target != description_->targets.end());
      connect(p, *target, drive);
    }
  }
}

void SceneSource::connect(std::size_t index, const DriveTarget& target,
                          const std::pair<std::string, FilePosition>& drive) {
  const ParameterDescription& parameter = description_->parameters[index];
  const TomlFile& file = description_->file;
  const auto refuse = [&](std::string_view message) {
    throw file.error(drive.second, fmt::format("parameters.{}.drives: {}", parameter.info.name, message));
  };
  for (double* number : target.numbers) {
    auto driven = std::find_if(driven_.begin(), driven_.end(), [&](const Driven& d) { return d.number == number; });
    if (driven == driven_.end()) {
      driven_.push_back({number, *number, &target, {}, {}, {}});
      driven = driven_.end() - 1;
    }
    switch (parameter.mode) {
      case DriveMode::set:
        if (!driven->set.empty()) {
          refuse(fmt::format("{} is already set by '{}'", target.path,
                             description_->parameters[driven->set.front()].info.name));
        }
        driven->set.push_back(index);
        if (target.given && driven->base != this->number(index)) {
          throw file.error(target.place,
                           fmt::format("{} = {}, but parameter '{}' sets it and has the default {}; make them equal",
                                       target.path, driven->base, parameter.info.name, this->number(index)));
        }
        break;
      case DriveMode::scale:
        driven->scale.push_back(index);
        break;
      case DriveMode::add:
        driven->add.push_back(index);
        break;
    }
    const Range reached = bounds(*driven);
    for (const double end : {reached.min, reached.max}) {
      if (!target.range.contains(end)) {
        refuse(fmt::format("within its range it makes {} = {}, which is out of {}", target.path, end,
                           target.range.text()));
      }
    }
  }
}

double SceneSource::number(std::size_t parameter) const {
  const Value& value = values_[parameter];
  if (const auto* integer = std::get_if<std::int64_t>(&value)) return static_cast<double>(*integer);
  return std::get<double>(value);
}

Range SceneSource::bounds(const Driven& driven) const {
  const auto info = [&](std::size_t p) -> const ParameterInfo& { return description_->parameters[p].info; };
  Range range{driven.base, driven.base};
  for (const std::size_t p : driven.set)
    range = {info(p).min, info(p).max};
  for (const std::size_t p : driven.scale) {
    const auto [low, high] = std::minmax(
        {range.min * info(p).min, range.min * info(p).max, range.max * info(p).min, range.max * info(p).max});
    range = {low, high};
  }
  for (const std::size_t p : driven.add)
    range = {range.min + info(p).min, range.max + info(p).max};
  return range;
}

void SceneSource::write(const Driven& driven) const {
  double value = driven.set.empty() ? driven.base : number(driven.set.front());
  for (const std::size_t p : driven.scale)
    value *= number(p);
  for (const std::size_t p : driven.add)
    value += number(p);
  *driven.number = value;
}

// ---- values ----

double SceneSource::time_s() const {
  return number(time_index_);
}

std::vector<Affected> SceneSource::affected_by(std::size_t parameter) const {
  std::set<Affected> parts;
  if (parameter == time_index_) parts.insert(description_->animated.begin(), description_->animated.end());
  for (const Driven& driven : driven_) {
    for (const auto* drives : {&driven.set, &driven.scale, &driven.add}) {
      if (std::find(drives->begin(), drives->end(), parameter) == drives->end()) continue;
      parts.insert(driven.target->affected);
      parts.insert(driven.target->also.begin(), driven.target->also.end());
    }
  }
  return {parts.begin(), parts.end()};
}

void SceneSource::apply(Scene& scene, std::size_t parameter) {
  for (const Driven& driven : driven_)
    write(driven);
  for (const Affected& part : affected_by(parameter))
    evaluate(*description_, part, time_s(), scene);
}

void SceneSource::assign(Scene& scene, std::size_t parameter, const Value& value) {
  if (values_[parameter] == value) return;
  const Value before = std::exchange(values_[parameter], value);
  try {
    apply(scene, parameter);
  } catch (...) {
    // Two numbers contradict each other at this value: the scene stays as it was.
    values_[parameter] = before;
    apply(scene, parameter);
    throw;
  }
  ++revision_;
}

void SceneSource::evaluate_all(Scene& scene) {
  scene.title = description_->title;
  scene.description = description_->description;
  scene.stand_in = description_->stand_in;
  scene.meshes.resize(description_->meshes.size());
  scene.materials.resize(description_->materials.size());
  scene.reliefs.resize(description_->reliefs.size());
  scene.instances.resize(description_->instances.size());
  scene.lights.resize(description_->lights.size());
  scene.views.resize(description_->views.size());
  if (description_->volume) scene.volume.emplace();
  for (const Affected& part : all_parts(*description_))
    evaluate(*description_, part, time_s(), scene);
}

std::string SceneSource::content_hash() const {
  Sha256 hash;
  hash.add(text_);
  for (const auto& [file, content] : description_->files_read) {
    hash.add(file);
    hash.add(content);
  }
  for (std::size_t i = 0; i < values_.size(); ++i) {
    hash.add(description_->parameters[i].info.name);
    hash.add(to_text(values_[i]));
  }
  return hash.hex();
}

}  // namespace pellucid
