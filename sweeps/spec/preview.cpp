#include "sweeps/spec/preview.hpp"

#include <algorithm>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "sweeps/spec/spec_values.hpp"

namespace pellucid::sweeps {
namespace {

void move_to(toml::table& base, const toml::key& key, toml::node& node) {
  node.visit([&](auto& concrete) { base.insert_or_assign(key, std::move(concrete)); });
}

/// A table of keys, as against a range, which is one value.
bool is_group(const toml::node& node) {
  return node.is_table() && !node.as_table()->contains("from");
}

/// Moves what `overlay` holds into `base`.
void merge(toml::table& overlay, toml::table& base) {
  for (auto&& [key, node] : overlay) {
    toml::node* old = base.get(key.str());
    if (old != nullptr && old->is_table() && is_group(node)) {
      merge(*node.as_table(), *old->as_table());
    } else {
      move_to(base, key, node);
    }
  }
}

/// Moves from `overlay` the values of those axes that `axes` has, and notes their names.
void merge_axes(toml::table& overlay, toml::table& axes, const std::string& prefix, std::set<std::string>& used) {
  for (auto&& [key, node] : overlay) {
    toml::node* old = axes.get(key.str());
    if (old == nullptr) continue;
    if (is_group(node) && old->is_table()) {
      merge_axes(*node.as_table(), *old->as_table(), fmt::format("{}{}.", prefix, key.str()), used);
    } else {
      move_to(axes, key, node);
      used.insert(prefix + std::string(key.str()));
    }
  }
}

/// Complains about the first axis that no block has.
void check_axes(const TableReader& preview, const toml::table& overlay, const std::string& prefix,
                const std::set<std::string>& used) {
  for (const auto& [key, node] : overlay) {
    const std::string name = prefix + std::string(key.str());
    if (is_group(node)) {
      check_axes(preview, *node.as_table(), name + ".", used);
    } else if (!used.contains(name)) {
      preview.fail(place_of(node), fmt::format("no block of the spec has the axis {}", name));
    }
  }
}

std::string name_of(const toml::table& block) {
  return block["name"].value_or(std::string());
}

/// One spec on its way to its preview.
class Preview {
 public:
  Preview(const TomlFile& file, const std::function<toml::table()>& parse)
      : file_(file), parse_(parse), spec_(parse()), checked_(fresh()), preview_(file, checked_, "preview") {
    for (const char* key : {"title", "description", "metrics", "timeout_s", "timing", "reference", "sizes", "scenes",
                            "axes", "omit", "run"})
      preview_.node(key);
    preview_.finish();
  }

  toml::table apply() {
    if (toml::value<std::string>* name = spec_.get_as<std::string>("name")) *name = name->get() + "_preview";
    omit_blocks();
    for (toml::table* block : blocks())
      overlay_block(*block);
    check_used();
    spec_.erase("preview");
    toml::table rest = fresh();
    for (const char* key : {"omit", "sizes", "scenes", "axes", "run"})
      rest.erase(key);
    merge(rest, spec_);
    return std::move(spec_);
  }

 private:
  toml::table fresh() const {
    toml::table spec = parse_();
    if (!spec.contains("preview")) throw file_.error({1, 1}, "the spec has no [preview]");
    TableReader(file_, spec).table("preview");  // complains when it is something else
    return std::move(*spec.get_as<toml::table>("preview"));
  }

  /// Whatever is no table is left for the reader of the spec to refuse.
  std::vector<toml::table*> blocks() {
    std::vector<toml::table*> out;
    if (toml::array* runs = spec_.get_as<toml::array>("run")) {
      for (toml::node& node : *runs) {
        if (node.is_table()) out.push_back(node.as_table());
      }
    }
    return out;
  }
  std::vector<std::string> block_names() {
    std::vector<std::string> names;
    for (const toml::table* block : blocks())
      names.push_back(name_of(*block));
    return names;
  }

  void omit_blocks() {
    for (const PlacedText& name : distinct_texts(preview_, "omit", Need::optional, true)) {
      preview_.one_of(name.at, "block", name.text, block_names());
      toml::array& runs = *spec_.get_as<toml::array>("run");
      runs.erase(std::find_if(runs.cbegin(), runs.cend(), [&](const toml::node& node) {
        return node.is_table() && name_of(*node.as_table()) == name.text;
      }));
    }
  }

  void overlay_block(toml::table& block) {
    toml::table own = fresh();
    for (const char* key : {"sizes", "scenes"}) {
      if (toml::array* list = own.get_as<toml::array>(key)) block.insert_or_assign(key, std::move(*list));
    }
    toml::table* stand_ins = own.get_as<toml::table>("scenes");
    toml::array* scenes = block.get_as<toml::array>("scenes");
    if (stand_ins != nullptr && scenes != nullptr) {
      for (toml::node& scene : *scenes) {
        const std::string name = scene.value_or(std::string());
        toml::value<std::string>* stand_in = stand_ins->get_as<std::string>(name);
        if (stand_in == nullptr) continue;
        *scene.as_string() = std::move(*stand_in);
        used_scenes_.insert(name);
      }
    }
    toml::table* overlaid = own.get_as<toml::table>("axes");
    toml::table* axes = block.get_as<toml::table>("axes");
    if (overlaid != nullptr && axes != nullptr) merge_axes(*overlaid, *axes, "", used_axes_);
    if (toml::table* runs = own.get_as<toml::table>("run")) {
      if (toml::table* mine = runs->get_as<toml::table>(name_of(block))) merge(*mine, block);
    }
  }

  /// Every name of the overlay must be one of the spec.
  void check_used() {
    if (preview_.table("axes")) check_axes(preview_, *checked_.get_as<toml::table>("axes"), "", used_axes_);
    if (const toml::table* stand_ins = checked_.get_as<toml::table>("scenes")) {
      for (const auto& [scene, stand_in] : *stand_ins) {
        if (!stand_in.is_string()) preview_.fail(place_of(stand_in), "a scene's stand-in is the name of a scene");
        if (!used_scenes_.contains(std::string(scene.str())))
          preview_.fail(place_of(stand_in), fmt::format("no block of the spec has the scene '{}'", scene.str()));
      }
    } else {
      distinct_texts(preview_, "scenes");
    }
    distinct_texts(preview_, "sizes");
    if (std::optional<TableReader> runs = preview_.table("run")) {
      for (const std::string& name : runs->keys()) {
        preview_.one_of(runs->place(name), "block", name, block_names());
        runs->table(name);  // complains when it is something else
      }
    }
  }

  const TomlFile& file_;
  const std::function<toml::table()>& parse_;
  toml::table spec_;
  toml::table checked_;  ///< the overlay as it was read, for its complaints
  TableReader preview_;
  std::set<std::string> used_axes_, used_scenes_;
};

}  // namespace

toml::table preview_of(const TomlFile& file, const std::function<toml::table()>& parse) {
  return Preview(file, parse).apply();
}

}  // namespace pellucid::sweeps
