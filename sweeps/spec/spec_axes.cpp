#include "sweeps/spec/spec_axes.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <toml++/toml.h>

#include "algorithms/parameter_names.hpp"
#include "algorithms/render_session.hpp"
#include "gl/error.hpp"
#include "sweeps/spec/design.hpp"
#include "sweeps/spec/plan.hpp"
#include "sweeps/spec/spec_values.hpp"

namespace pellucid::sweeps {
namespace {

/// The choices of one block: every pair of technique and scene, whose tables must all know an axis.
struct Owners {
  const TableReader& run;
  const KnownNames& known_names;
  const RunBlock& block;

  /// The tables that must hold `name`, and the name they know it by.
  struct Owner {
    std::string label;
    std::vector<ParameterInfo> infos;
  };
  std::vector<Owner> owners_of(const std::string& name) const {
    std::vector<Owner> owners;
    if (route(name).owner == ParameterOwner::scene) {
      for (const std::string& scene : block.scenes)
        owners.push_back({"scene " + scene, known_names.scene(scene).parameters});
    } else if (const auto common = std::find_if(
                   common_settings().begin(), common_settings().end(),
                   [&](const CommonSettings& group) { return name.starts_with(std::string(group.prefix) + "."); });
               common != common_settings().end()) {
      owners.push_back({std::string(common->prefix), {common->table->infos().begin(), common->table->infos().end()}});
    } else {
      for (const std::string& technique : block.techniques) {
        owners.push_back({technique, known_names.technique_parameters(technique)});
      }
    }
    return owners;
  }

  using Found = std::vector<std::pair<std::string, ParameterInfo>>;

  /// The parameter in every table, each with its owner's name; complains at the key.
  Found find(const NamedValue& entry) const {
    const std::size_t dot = entry.name.find('.');
    const std::string bare = dot == std::string::npos ? entry.name : entry.name.substr(dot + 1);
    Found found;
    for (const Owner& owner : owners_of(entry.name)) {
      const auto info =
          std::find_if(owner.infos.begin(), owner.infos.end(), [&](const auto& i) { return i.name == bare; });
      if (info == owner.infos.end()) run.fail(entry.at, unknown_parameter(bare, owner.label, owner.infos).what());
      found.emplace_back(owner.label, *info);
    }
    return found;
  }

  Value check(const Found& infos, const toml::node& node, const Value& value) const {
    Value result = value;
    for (const auto& [label, info] : infos) {
      try {
        result = checked(info, value, label);
      } catch (const InputError& e) {
        run.fail(place_of(node), e.what());
      }
    }
    return result;
  }
};

/// `design = { kind = "sobol", count = 64, seed = 1 }`
std::optional<Design> read_design(TableReader& run) {
  std::optional<TableReader> table = run.table("design");
  if (!table) return std::nullopt;
  Design design;
  constexpr DesignKind kKinds[] = {DesignKind::random, DesignKind::latin_hypercube, DesignKind::sobol};
  design.kind = kKinds[table->choice("kind", {"random", "latin_hypercube", "sobol"}, 2)];
  table->integer("count", design.count, 1, static_cast<int>(kMaxPoints), Need::required);
  int seed = 1;
  table->integer("seed", seed, 0, std::numeric_limits<int>::max());
  design.seed = static_cast<std::uint64_t>(seed);
  table->finish();
  return design;
}

/// Reads [run.axes] and tells which axes walk together.
class AxesReader {
 public:
  AxesReader(TableReader& run, const KnownNames& known_names, RunBlock& block)
      : run_(run), block_(block), owners_{run, known_names, block}, design_(read_design(run)) {
    whole_zip_ = run.choice("combine", {"grid", "zip"}, 0) == 1;
    if (whole_zip_ && design_) {
      run.fail(run.place("combine"), "a design spreads its axes itself; zip them with others by `zip`");
    }
  }

  void read_all() {
    read_zips();
    if (std::optional<TableReader> axes = run_.table("axes")) {
      for (NamedValue& entry : named_values(*axes)) {
        std::vector<Value> values = read_axis(entry);
        block_.axes.push_back({entry.name, std::move(values), entry.at});
      }
    }
    if (whole_zip_ && block_.axes.empty()) run_.fail(block_.at, "combine = \"zip\" needs [run.axes]");
    if (design_ && drawn_.empty()) {
      run_.fail(run_.place("design"),
                "the design has no axis; one is a range of [run.axes] without `steps`: { from, to }");
    }
    draw();
    make_walks();
  }

 private:
  /// A range that the design draws from.
  struct Drawn {
    std::size_t axis;
    Owners::Found infos;
    AxisRange range;
    NamedValue entry;
  };

  /// `zip = [["hulls", "samples"], …]`: names of axes that walk together within the grid.
  void read_zips() {
    const toml::node* node = run_.node("zip");
    if (node == nullptr) return;
    const toml::array* list = node->as_array();
    if (list == nullptr || list->empty() || !list->is_homogeneous(toml::node_type::array)) {
      run_.fail(place_of(*node), "zip is a list of lists of axes, for example [[\"hulls\", \"samples\"]]");
    }
    if (whole_zip_) run_.fail(place_of(*node), "combine = \"zip\" zips all axes already");
    for (const toml::node& inner : *list) {
      std::vector<PlacedText> zip;
      for (const toml::node& name : *inner.as_array()) {
        if (!name.is_string()) run_.fail(place_of(name), fmt::format("zip names axes, not {}", type_name(name)));
        const std::string& axis = name.as_string()->get();
        const auto has = [&](const auto& names) {
          return std::any_of(names.begin(), names.end(), [&](const PlacedText& other) { return other.text == axis; });
        };
        if (has(zip) || std::any_of(zips_.begin(), zips_.end(), has))
          run_.fail(place_of(name), fmt::format("{} is in a zip already", axis));
        zip.push_back({axis, place_of(name)});
      }
      if (zip.size() < 2) run_.fail(place_of(inner), "a zip needs two axes at least");
      zips_.push_back(std::move(zip));
    }
  }

  bool zipped(const std::string& axis) const {
    return whole_zip_ || std::any_of(zips_.begin(), zips_.end(), [&](const auto& zip) {
             return std::any_of(zip.begin(), zip.end(), [&](const auto& name) { return name.text == axis; });
           });
  }

  std::vector<Value> read_axis(NamedValue& entry) {
    auto infos = owners_.find(entry);
    std::vector<Value> values;
    if (entry.table) {
      const AxisRange range = read_range(*entry.table);
      const bool drawn = design_ && !range.steps;
      try {
        if (drawn) {
          check_range(infos.front().second, range);
        } else {
          values = expand_range(infos.front().second, range);
        }
      } catch (const InputError& e) {
        run_.fail(place_of(*entry.node), fmt::format("{}: {}", entry.name, e.what()));
      }
      if (drawn) {
        for (const double end : {range.from, range.to})
          check_end(entry, infos, end);
        drawn_.push_back({block_.axes.size(), std::move(infos), range, entry});
        return {};
      }
      for (Value& value : values)
        value = owners_.check(infos, *entry.node, value);
      return values;
    }
    const toml::array* list = entry.node->as_array();
    if (list == nullptr) {
      run_.fail(place_of(*entry.node),
                fmt::format("axis {} is a list of values or a range {{ from, to, steps | log2 }}; a single value "
                            "belongs under [run.fixed]",
                            entry.name));
    }
    if (list->empty()) run_.fail(place_of(*list), fmt::format("axis {} lists no value", entry.name));
    for (const toml::node& node : *list) {
      Value value = owners_.check(infos, node, value_of(run_, node, entry.name));
      // Walked together with other axes, a value may well come again.
      if (!zipped(entry.name) && std::find(values.begin(), values.end(), value) != values.end()) {
        run_.fail(place_of(node), fmt::format("axis {} lists {} twice", entry.name, to_text(value)));
      }
      values.push_back(std::move(value));
    }
    return values;
  }

  /// A drawn axis never lies outside of its ends, so these alone are checked here.
  void check_end(const NamedValue& entry, const Owners::Found& infos, double end) const {
    const bool whole = infos.front().second.type == ValueType::integer;
    if (whole && end != std::round(end)) {
      run_.fail(place_of(*entry.node), fmt::format("{}: the range ends at {}, and {} is an integer", entry.name, end,
                                                   infos.front().second.name));
    }
    owners_.check(infos, *entry.node, whole ? Value(static_cast<std::int64_t>(end)) : Value(end));
  }

  void draw() {
    if (drawn_.empty()) return;
    if (drawn_.size() > kMaxDesignAxes) {
      run_.fail(run_.place("design"), fmt::format("a design may have {} axes", kMaxDesignAxes));
    }
    for (const std::vector<double>& point : unit_points(*design_, drawn_.size())) {
      for (std::size_t d = 0; d < drawn_.size(); ++d) {
        const Drawn& drawn = drawn_[d];
        const Value value = value_at(drawn.infos.front().second, drawn.range, point[d]);
        block_.axes[drawn.axis].values.push_back(owners_.check(drawn.infos, *drawn.entry.node, value));
      }
    }
  }

  void make_walks() {
    std::vector<bool> taken(block_.axes.size(), false);
    const auto walk = [&](Walk axes) {
      for (const std::size_t axis : axes)
        taken[axis] = true;
      block_.walks.push_back(std::move(axes));
    };
    Walk drawn;
    for (const Drawn& d : drawn_)
      drawn.push_back(d.axis);
    for (std::size_t i = 0; i < block_.axes.size(); ++i) {
      if (taken[i]) continue;
      if (whole_zip_) {
        Walk all(block_.axes.size());
        std::iota(all.begin(), all.end(), 0);
        walk(std::move(all));
      } else if (std::find(drawn.begin(), drawn.end(), i) != drawn.end()) {
        walk(drawn);
      } else {
        walk(zip_of(i));
      }
      check_lengths(block_.walks.back());
    }
    for (const std::vector<PlacedText>& zip : zips_) {
      for (const PlacedText& name : zip)
        static_cast<void>(axis_named(name));
    }
  }

  std::size_t axis_named(const PlacedText& name) const {
    std::vector<std::string> names;
    for (const Axis& axis : block_.axes)
      names.push_back(axis.name);
    run_.one_of(name.at, "axis", name.text, names);
    const std::size_t axis = static_cast<std::size_t>(std::find(names.begin(), names.end(), name.text) - names.begin());
    if (std::any_of(drawn_.begin(), drawn_.end(), [&](const Drawn& d) { return d.axis == axis; })) {
      run_.fail(name.at, fmt::format("{} is drawn by the design, which walks its axes together already", name.text));
    }
    return axis;
  }

  Walk zip_of(std::size_t axis) const {
    for (const std::vector<PlacedText>& zip : zips_) {
      if (std::none_of(zip.begin(), zip.end(), [&](const auto& n) { return n.text == block_.axes[axis].name; }))
        continue;
      Walk axes;
      for (const PlacedText& name : zip)
        axes.push_back(axis_named(name));
      std::sort(axes.begin(), axes.end());
      return axes;
    }
    return {axis};
  }

  void check_lengths(const Walk& walk) const {
    const Axis& first = block_.axes[walk.front()];
    for (const std::size_t i : walk) {
      const Axis& axis = block_.axes[i];
      if (axis.values.size() != first.values.size()) {
        run_.fail(axis.at, fmt::format("a zip needs axes of equal length: {} has {} values, {} has {}", axis.name,
                                       axis.values.size(), first.name, first.values.size()));
      }
    }
  }

  TableReader& run_;
  RunBlock& block_;
  Owners owners_;
  std::optional<Design> design_;
  bool whole_zip_ = false;
  std::vector<std::vector<PlacedText>> zips_;
  std::vector<Drawn> drawn_;
};

void read_fixed(TableReader& run, const KnownNames& known_names, RunBlock& block) {
  std::optional<TableReader> fixed = run.table("fixed");
  if (!fixed) return;
  const Owners owners{run, known_names, block};
  for (const NamedValue& entry : named_values(*fixed)) {
    const Owners::Found infos = owners.find(entry);
    const auto same = [&](const Axis& axis) { return axis.name == entry.name; };
    if (std::any_of(block.axes.begin(), block.axes.end(), same))
      run.fail(entry.at, fmt::format("{} is an axis of this block already", entry.name));
    block.fixed.push_back({entry.name, owners.check(infos, *entry.node, value_of(run, *entry.node, entry.name))});
  }
}

}  // namespace

void read_axes(TableReader& run, const KnownNames& known_names, RunBlock& block) {
  AxesReader(run, known_names, block).read_all();
  read_fixed(run, known_names, block);
}

}  // namespace pellucid::sweeps
