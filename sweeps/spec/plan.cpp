#include "sweeps/spec/plan.hpp"

#include <algorithm>
#include <random>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <variant>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "algorithms/parameter_names.hpp"
#include "algorithms/render_session.hpp"
#include "algorithms/scene/files/hash.hpp"
#include "sweeps/spec/constraint.hpp"
#include "sweeps/spec/point_json.hpp"
#include "sweeps/spec/provenance.hpp"
#include "sweeps/spec/spec_reader.hpp"

namespace pellucid::sweeps {
namespace {

/// Raise it when the meaning of a point's settings changes, so that old rows are not taken for new ones.
constexpr int kPointVersion = 1;
/// Points of one chunk; a chunk shares its precomputation.
constexpr std::size_t kChunk = 4;

[[noreturn]] void fail(const Spec& spec, Position at, std::string_view message) {
  throw InputError(fmt::format("{}:{}:{}: {}", spec.source, at.line, at.column, message));
}

std::string hash_of(const Point& point) {
  nlohmann::json parameters = nlohmann::json::object();
  for (const auto& [name, value] : point.parameters)
    parameters[name] = value_to_json(value);
  nlohmann::json all = {{"version", kPointVersion},
                        {"technique", point.technique},
                        {"parameters", parameters},
                        {"scene", point.scene},
                        {"scene_hash", point.scene_hash},
                        {"code_hash", point.code_hash},
                        {"view", point.view},
                        {"size", {point.size.width, point.size.height}},
                        {"metrics", point.metrics}};
  const TimingLimits& t = point.timing;
  all["timing"] =
      t.enabled ? nlohmann::json{t.min_samples, t.max_samples, t.max_seconds, t.relative_ci} : nlohmann::json();
  if (!point.metrics.empty()) all["reference"] = to_json(point.reference);
  return sha256_hex(all.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace)).substr(0, 16);
}

/// The parameters of a technique in a scene under their full names.
std::vector<ParameterInfo> full_table(const Catalogue& catalogue, const std::string& technique,
                                      const std::string& scene) {
  std::vector<ParameterInfo> infos = catalogue.technique_parameters(technique);
  const auto add = [&](std::vector<ParameterInfo> more, const std::string& prefix) {
    for (ParameterInfo& info : more) {
      info.name = prefix + info.name;
      infos.push_back(std::move(info));
    }
  };
  add(catalogue.scene(scene).parameters, "scene.");
  for (const CommonSettings& group : common_settings()) {
    add({group.table->infos().begin(), group.table->infos().end()}, std::string(group.prefix) + ".");
  }
  return infos;
}

/// What the keys of a point say of the work it can share with others.
struct Sharing {
  std::string scene;       ///< the loaded scene
  std::string precompute;  ///< … and what prepare() made
  std::string program;     ///< … and the programs
};

/// Expands the blocks of one spec into a plan.
class Expander {
 public:
  Expander(const Spec& spec, const Catalogue& catalogue) : spec_(spec), catalogue_(catalogue) {}

  Plan expand() {
    for (const RunBlock& block : spec_.blocks)
      expand_block(block);
    order();
    return std::move(plan_);
  }

 private:
  /// Each combination of axis values as indices into the axes.
  std::size_t combinations(const RunBlock& block) const {
    if (block.axes.empty()) return 1;
    if (block.combine == Combine::zip) return block.axes.front().values.size();
    std::size_t n = 1;
    for (const Axis& axis : block.axes) {
      if (axis.values.size() > kMaxPoints / n) too_many(block);
      n *= axis.values.size();
    }
    return n;
  }

  [[noreturn]] void too_many(const RunBlock& block) const {
    fail(spec_, block.at, fmt::format("block '{}' asks for more than {} points", block.name, kMaxPoints));
  }

  void expand_block(const RunBlock& block) {
    const std::size_t each = combinations(block);
    std::size_t places = block.techniques.size() * block.sizes.size();
    std::size_t views = 0;
    for (std::size_t i = 0; i < block.scenes.size(); ++i)
      views += std::max<std::size_t>(1, block.views.size());
    places *= views;
    if (places > kMaxPoints || each > kMaxPoints / places || plan_.members.size() + each * places > 2 * kMaxPoints) {
      too_many(block);
    }
    const std::size_t before = plan_.members.size();
    for (const std::string& technique : block.techniques) {
      for (const std::string& scene : block.scenes) {
        table_ = full_table(catalogue_, technique, scene);
        make_constraints(block);
        const SceneFacts& facts = catalogue_.scene(scene);
        const std::vector<std::string> chosen = block.views.empty() ? std::vector{facts.views.front()} : block.views;
        for (const std::string& view : chosen) {
          for (const Size& size : block.sizes) {
            for (std::size_t i = 0; i < each; ++i)
              add_point(block, technique, scene, view, size, i);
          }
        }
      }
    }
    if (plan_.members.size() == before) {
      fail(spec_, block.constraints.empty() ? block.at : block.constraints.front().at,
           fmt::format("the constraints leave no point in block '{}'", block.name));
    }
    if (block.baseline) plan_.baseline = plan_.members[before].point;
  }

  const ParameterInfo& info(const std::string& name) const {
    const auto found = std::find_if(table_.begin(), table_.end(), [&](const auto& i) { return i.name == name; });
    return *found;  // spec.cpp has checked that it is there
  }

  void make_constraints(const RunBlock& block) {
    std::vector<std::string> names{"width", "height"};
    for (const ParameterInfo& i : table_) {
      if (i.type != ValueType::choice) names.push_back(i.name);
    }
    constraints_.clear();
    for (const Constraint& constraint : block.constraints) {
      try {
        constraints_.emplace_back(constraint.text, names);
      } catch (const InputError& e) {
        fail(spec_, constraint.at, e.what());
      }
    }
  }

  bool allowed(const RunBlock& block, const Point& point) {
    if (constraints_.empty()) return true;
    std::map<std::string, double> numbers{{"width", point.size.width}, {"height", point.size.height}};
    for (const auto& [name, value] : point.parameters) {
      if (const auto* b = std::get_if<bool>(&value)) numbers[name] = *b ? 1 : 0;
      if (const auto* i = std::get_if<std::int64_t>(&value)) numbers[name] = static_cast<double>(*i);
      if (const auto* d = std::get_if<double>(&value)) numbers[name] = *d;
    }
    for (std::size_t i = 0; i < constraints_.size(); ++i) {
      try {
        if (!constraints_[i].holds(numbers)) return false;
      } catch (const InputError& e) {
        fail(spec_, block.constraints[i].at, e.what());
      }
    }
    return true;
  }

  void add_point(const RunBlock& block, const std::string& technique, const std::string& scene, const std::string& view,
                 const Size& size, std::size_t combination) {
    Point point;
    point.technique = technique;
    point.scene = scene;
    point.view = view;
    point.size = size;
    point.metrics = block.metrics;
    point.timing = block.timing;
    const SceneFacts& facts = catalogue_.scene(scene);
    point.reference = block.reference;
    if (!block.metrics.empty()) {
      try {
        point.reference = settled(block.reference, scene, facts.interfaces, facts.volume);
      } catch (const InputError& e) {
        fail(spec_, block.at, e.what());
      }
    }
    point.scene_hash = facts.content_hash;
    point.code_hash = code_hash(technique);
    for (const ParameterInfo& i : table_)
      point.parameters[i.name] = i.default_value;

    // The last axis runs fastest, as a reader of nested loops expects.
    std::size_t rest = combination;
    for (std::size_t a = block.axes.size(); a-- > 0;) {
      const Axis& axis = block.axes[a];
      std::size_t index = combination;
      if (block.combine == Combine::grid) {
        index = rest % axis.values.size();
        rest /= axis.values.size();
      }
      point.parameters[axis.name] = checked(info(axis.name), axis.values[index], technique);
    }
    for (const Axis& axis : block.axes)
      point.assigned.push_back(axis.name);
    for (const FixedValue& fixed : block.fixed) {
      point.parameters[fixed.name] = checked(info(fixed.name), fixed.value, technique);
      point.assigned.push_back(fixed.name);
    }
    if (!allowed(block, point)) return;

    point.id = hash_of(point);
    const auto [at, is_new] = index_.try_emplace(point.id, plan_.points.size());
    plan_.members.push_back({block.name, at->second});
    if (!is_new) return;
    if (plan_.points.size() == kMaxPoints) too_many(block);
    sharing_.push_back(sharing(point));
    plan_.points.push_back(std::move(point));
  }

  const std::string& code_hash(const std::string& technique) {
    const auto [at, is_new] = code_hashes_.try_emplace(technique);
    if (is_new) at->second = catalogue_.code_hash(technique);
    return at->second;
  }

  Sharing sharing(const Point& point) const {
    Sharing s;
    s.scene = point.scene;
    s.precompute = fmt::format("{} {} {}x{}", point.technique, point.view, point.size.width, point.size.height);
    for (const ParameterInfo& i : table_) {
      const std::string text = fmt::format(" {}={}", i.name, to_text(point.parameters.at(i.name)));
      if (i.when == Change::precompute || route(i.name).owner == ParameterOwner::scene) s.precompute += text;
      if (i.when == Change::program) s.program += text;
    }
    return s;
  }

  /// Fisher-Yates by hand: std::shuffle may differ between libraries, and the order is part of what a seed promises.
  template <class T>
  void shuffle(std::vector<T>& items) {
    for (std::size_t i = items.size(); i > 1; --i)
      std::swap(items[i - 1], items[random_() % i]);
  }

  void order() {
    std::map<std::string, std::map<std::string, std::vector<std::size_t>>> scenes;
    for (std::size_t i = 0; i < plan_.points.size(); ++i)
      scenes[sharing_[i].scene][sharing_[i].precompute].push_back(i);
    for (auto& [scene, cells] : scenes) {
      std::vector<std::vector<std::size_t>> chunks;
      for (auto& [cell, points] : cells) {
        shuffle(points);
        for (std::size_t i = 0; i < points.size(); i += kChunk) {
          const auto begin = points.begin() + static_cast<std::ptrdiff_t>(i);
          const auto end = points.begin() + static_cast<std::ptrdiff_t>(std::min(points.size(), i + kChunk));
          chunks.emplace_back(begin, end);
          std::stable_sort(chunks.back().begin(), chunks.back().end(),
                           [&](std::size_t a, std::size_t b) { return sharing_[a].program < sharing_[b].program; });
        }
      }
      shuffle(chunks);
      for (const auto& chunk : chunks)
        plan_.order.insert(plan_.order.end(), chunk.begin(), chunk.end());
    }
  }

  const Spec& spec_;
  const Catalogue& catalogue_;
  Plan plan_;
  std::vector<ParameterInfo> table_;
  std::vector<Expression> constraints_;
  std::vector<Sharing> sharing_;
  std::unordered_map<std::string, std::size_t> index_;
  std::map<std::string, std::string> code_hashes_;
  std::mt19937_64 random_{0x70656c6c75636964};  // "pellucid"
};

}  // namespace

Plan make_plan(const Spec& spec, const Catalogue& catalogue) {
  return Expander(spec, catalogue).expand();
}

std::string repeat_command(const Point& point) {
  std::string command = fmt::format("pellucid render {} -t {}", shell_word(point.scene), point.technique);
  for (const std::string& name : point.assigned) {
    command += fmt::format(" -s {}", shell_word(fmt::format("{}={}", name, to_text(point.parameters.at(name)))));
  }
  return command + fmt::format(" --view {} --size {}x{} -o {}.exr", shell_word(point.view), point.size.width,
                               point.size.height, point.id);
}

}  // namespace pellucid::sweeps
