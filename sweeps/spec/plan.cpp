#include "sweeps/spec/plan.hpp"

#include <algorithm>
#include <cassert>
#include <random>
#include <string_view>
#include <tuple>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <variant>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "algorithms/parameter_names.hpp"
#include "algorithms/render_session.hpp"
#include "algorithms/scene/files/hash.hpp"
#include "algorithms/scene/images/frame_size.hpp"
#include "sweeps/spec/constraint.hpp"
#include "sweeps/spec/point_json.hpp"
#include "sweeps/spec/provenance.hpp"

namespace pellucid::sweeps {
namespace {

/// Raise it when the meaning of a point's settings changes, so that old rows are not taken for new ones.
constexpr int kPointVersion = 1;
/// Points of one chunk; a chunk shares its precomputation.
constexpr std::size_t kChunk = 4;

[[noreturn]] void fail(const Spec& spec, FilePosition at, std::string_view message) {
  throw InputError(fmt::format("{}:{}:{}: {}", spec.source, at.line, at.column, message));
}

/// A point's id is the hash of this, but for its parameters, which stand between the two parts.
std::pair<std::string, std::string> identity(const Point& point) {
  nlohmann::json all = {{"version", kPointVersion},
                        {"technique", point.technique},
                        {"parameters", nlohmann::json::object()},
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
  const std::string text = all.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  constexpr std::string_view kParameters = "\"parameters\":{";
  const std::size_t at = text.find(kParameters) + kParameters.size();
  return {text.substr(0, at), text.substr(at)};
}

std::string identity_text(const std::string& name, const Value& value) {
  return nlohmann::json(name).dump() + ":" +
         value_to_json(value).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

/// The number that a constraint computes with; nothing for a choice, which it cannot name.
std::optional<double> number_of(const Value& value) {
  if (const auto* b = std::get_if<bool>(&value)) return *b ? 1 : 0;
  if (const auto* i = std::get_if<std::int64_t>(&value)) return static_cast<double>(*i);
  if (const auto* d = std::get_if<double>(&value)) return *d;
  return std::nullopt;
}

/// The parameters of a technique in a scene under their full names.
std::vector<ParameterInfo> full_table(const KnownNames& known_names, const std::string& technique,
                                      const std::string& scene) {
  std::vector<ParameterInfo> infos = known_names.technique_parameters(technique);
  const auto add = [&](std::vector<ParameterInfo> more, const std::string& prefix) {
    for (ParameterInfo& info : more) {
      info.name = prefix + info.name;
      infos.push_back(std::move(info));
    }
  };
  add(known_names.scene(scene).parameters, "scene.");
  for (const CommonSettings& group : common_settings()) {
    add({group.table->infos().begin(), group.table->infos().end()}, std::string(group.prefix) + ".");
  }
  return infos;
}

/// The keys of a point tell which work it can share with others.
struct Sharing {
  std::string precompute;  ///< what prepare() makes
  std::string program;     ///< … and the programs
};

/// One value of an axis, in every form that expanding needs.
struct AxisValue {
  Value value;
  std::string identity;
  std::optional<double> number;
  std::string sharing;
};

/// An axis in one place of a block (technique, scene, view and size).
struct PlacedAxis {
  std::size_t parameter = 0;  ///< in order of names
  Change when = Change::uniform;
  std::vector<AxisValue> values;
};

/// Expands the blocks of one spec into a plan.
class Expander {
 public:
  Expander(const Spec& spec, const KnownNames& known_names) : spec_(spec), known_names_(known_names) {}

  Plan expand() {
    for (const RunBlock& block : spec_.blocks)
      expand_block(block);
    order();
    return std::move(plan_);
  }

 private:
  /// How many combinations of axis values there are.
  std::size_t combinations(const RunBlock& block) const {
    std::size_t n = 1;
    for (const Walk& walk : block.walks) {
      const std::size_t length = block.axes[walk.front()].values.size();
      if (length > kMaxPoints / n) too_many(block);
      n *= length;
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
    plan_.points.reserve(std::min(kMaxPoints, plan_.points.size() + each * places));
    skipped_.assign(block.constraints.size() + 1, 0);
    in_block_.clear();
    for (const std::string& technique : block.techniques) {
      for (const std::string& scene : block.scenes) {
        table_ = full_table(known_names_, technique, scene);
        make_constraints(block);
        const SceneFacts& facts = known_names_.scene(scene);
        const std::vector<std::string> chosen = block.views.empty() ? std::vector{facts.views.front()} : block.views;
        for (const std::string& view : chosen) {
          for (const FrameSize& size : block.sizes) {
            place(block, technique, scene, view, size);
            for (std::size_t i = 0; i < each; ++i)
              add_point(block, i);
          }
        }
      }
    }
    for (std::size_t i = 0; i < skipped_.size(); ++i) {
      if (skipped_[i] == 0) continue;
      plan_.skipped.push_back({block.name,
                               i < block.constraints.size()
                                   ? fmt::format("the constraint '{}'", block.constraints[i].text)
                                   : "the same point again",
                               skipped_[i]});
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

  /// Works out what all points of one place share, so that a point costs little more than its hash.
  void place(const RunBlock& block, const std::string& technique, const std::string& scene, const std::string& view,
             const FrameSize& size) {
    shared_ = Point{};
    shared_.technique = technique;
    shared_.scene = scene;
    shared_.view = view;
    shared_.size = size;
    shared_.metrics = block.metrics;
    shared_.timing = block.timing;
    shared_.keep = block.keep;
    const SceneFacts& facts = known_names_.scene(scene);
    shared_.reference = block.reference;
    if (!block.metrics.empty()) {
      try {
        shared_.reference = settled(block.reference, scene, facts.interfaces, facts.volume);
      } catch (const InputError& e) {
        fail(spec_, block.at, e.what());
      }
    }
    shared_.scene_hash = facts.content_hash;
    shared_.code_hash = code_hash(technique);
    PointParameters::Table parameters;
    for (const ParameterInfo& i : table_) {
      parameters[i.name] = i.default_value;
      plan_.parameters.try_emplace(i.name, i);
    }
    for (const Axis& axis : block.axes)
      shared_.assigned.push_back(axis.name);
    for (const FixedValue& fixed : block.fixed) {
      parameters[fixed.name] = checked(info(fixed.name), fixed.value, technique);
      shared_.assigned.push_back(fixed.name);
    }
    shared_.parameters = PointParameters(parameters);

    std::tie(identity_before_, identity_after_) = identity(shared_);
    identity_.clear();
    numbers_ = {{"width", size.width}, {"height", size.height}};
    sharing_shared_ = {fmt::format("{} {} {}x{}", technique, view, size.width, size.height), {}};
    std::vector<std::string> names;
    for (const auto& [name, value] : shared_.parameters) {
      names.push_back(name);
      identity_.push_back(identity_text(name, value));
      if (const auto number = number_of(value)) numbers_[name] = *number;
      const bool varies = std::any_of(block.axes.begin(), block.axes.end(),
                                      [&, &n = name](const Axis& axis) { return axis.name == n; });
      if (!varies) share(sharing_shared_, cost(info(name)), sharing_text(name, value));
    }
    axes_.clear();
    for (const Axis& axis : block.axes) {
      const ParameterInfo& about = info(axis.name);
      PlacedAxis placed;
      placed.parameter =
          static_cast<std::size_t>(std::lower_bound(names.begin(), names.end(), axis.name) - names.begin());
      placed.when = cost(about);
      for (const Value& given : axis.values) {
        Value value = checked(about, given, technique);
        placed.values.push_back(
            {value, identity_text(axis.name, value), number_of(value), sharing_text(axis.name, value)});
      }
      axes_.push_back(std::move(placed));
    }
    chosen_.assign(block.axes.size(), 0);
  }

  /// A scene's parameter may cost whatever is precomputed for the scene.
  static Change cost(const ParameterInfo& about) {
    return route(about.name).owner == ParameterOwner::scene ? Change::precompute : about.when;
  }
  static std::string sharing_text(const std::string& name, const Value& value) {
    return fmt::format(" {}={}", name, to_text(value));
  }
  static void share(Sharing& sharing, Change when, const std::string& text) {
    if (when == Change::precompute) sharing.precompute += text;
    if (when == Change::program) sharing.program += text;
  }

  /// The last walk runs fastest, as a reader of nested loops expects.
  void choose(const RunBlock& block, std::size_t combination) {
    for (std::size_t w = block.walks.size(); w-- > 0;) {
      const std::size_t length = block.axes[block.walks[w].front()].values.size();
      for (const std::size_t axis : block.walks[w])
        chosen_[axis] = combination % length;
      combination /= length;
    }
  }

  bool allowed(const RunBlock& block) {
    if (constraints_.empty()) return true;
    for (std::size_t a = 0; a < axes_.size(); ++a) {
      if (const auto& number = axes_[a].values[chosen_[a]].number) numbers_[block.axes[a].name] = *number;
    }
    for (std::size_t i = 0; i < constraints_.size(); ++i) {
      try {
        if (constraints_[i].holds(numbers_)) continue;
      } catch (const InputError& e) {
        fail(spec_, block.constraints[i].at, e.what());
      }
      ++skipped_[i];
      return false;
    }
    return true;
  }

  std::string id() {
    for (std::size_t a = 0; a < axes_.size(); ++a)
      identity_[axes_[a].parameter] = axes_[a].values[chosen_[a]].identity;
    text_ = identity_before_;
    for (std::size_t i = 0; i < identity_.size(); ++i) {
      if (i > 0) text_ += ',';
      text_ += identity_[i];
    }
    text_ += identity_after_;
    return sha256_hex(text_).substr(0, 16);
  }

  void add_point(const RunBlock& block, std::size_t combination) {
    choose(block, combination);
    if (!allowed(block)) return;
    std::string name = id();
    const auto [at, is_new] = index_.try_emplace(name, plan_.points.size());
    if (!in_block_.insert(at->second).second) {
      ++skipped_.back();
      return;
    }
    plan_.members.push_back({block.name, at->second});
    if (!is_new) return;
    if (plan_.points.size() == kMaxPoints) too_many(block);
    Sharing sharing = sharing_shared_;
    Point& point = plan_.points.emplace_back(shared_);
    point.id = std::move(name);
    for (std::size_t a = 0; a < axes_.size(); ++a) {
      const AxisValue& value = axes_[a].values[chosen_[a]];
      point.parameters.set(axes_[a].parameter, value.value);
      share(sharing, axes_[a].when, value.sharing);
    }
    sharing_.push_back(std::move(sharing));
  }

  const std::string& code_hash(const std::string& technique) {
    const auto [at, is_new] = code_hashes_.try_emplace(technique);
    if (is_new) at->second = known_names_.code_hash(technique);
    return at->second;
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
      scenes[plan_.points[i].scene][sharing_[i].precompute].push_back(i);
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
  const KnownNames& known_names_;
  Plan plan_;
  std::vector<ParameterInfo> table_;
  std::vector<Expression> constraints_;
  std::vector<std::size_t> skipped_;  // by constraint; the last: again
  std::unordered_set<std::size_t> in_block_;
  std::vector<Sharing> sharing_;

  // The place under expansion.
  Point shared_;
  Sharing sharing_shared_;
  std::string identity_before_, identity_after_;
  std::vector<std::string> identity_;  // of each parameter, in order of names
  std::map<std::string, double> numbers_;
  std::vector<PlacedAxis> axes_;
  std::vector<std::size_t> chosen_;  // index of each axis's value
  std::string text_;

  std::unordered_map<std::string, std::size_t> index_;
  std::map<std::string, std::string> code_hashes_;
  std::mt19937_64 random_{0x70656c6c75636964};  // "pellucid"
};

}  // namespace

Plan make_plan(const Spec& spec, const KnownNames& known_names) {
  return Expander(spec, known_names).expand();
}

std::filesystem::path picture_path(const std::filesystem::path& store, const Point& point) {
  assert(point.keep != Keep::nothing);
  return std::filesystem::path(store.string() + ".pictures") / (point.id + (point.keep == Keep::png ? ".png" : ".exr"));
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
