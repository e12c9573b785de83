#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "sandbox/viewer/panel/color_row.hpp"
#include "sandbox/viewer/panel/desk.hpp"
#include "sandbox/viewer/panel/parameter_row.hpp"
#include "sandbox/viewer/state/workspace.hpp"

namespace pellucid::sandbox {

class Field;
class Choice;

/// A part of the panel beside the parameters: it builds its widgets into the panel, and brings them up to date.
struct PanelPart {
  std::function<void(Stack&)> build;
  std::function<void()> refresh;
};

/// Fills the desk's panel: scene, technique and view, the search, a section for each table of parameters, and further
/// parts. Built again when the workspace's structure changed.
class PanelView {
 public:
  PanelView(Desk&, Workspace&);
  void add_part(PanelPart);
  void set_side(Side);
  Side side() const { return side_; }
  /// Rebuilds where that is needed, and shows all values as they are.
  void update();
  void reset_all();
  void focus_search();
  /// The parameter that the keyboard's focus or the pointer is on; empty when there is none.
  std::string current_parameter() const;
  /// The parameter that was current last.
  const std::string& last_parameter() const { return last_; }
  /// The next scene, technique or view of the list, for keys.
  void step_technique(int by);
  void step_view(int by);
  std::function<void(const std::string&)> failed;  ///< told why a change was not taken

 private:
  void rebuild();
  void build_head(Stack&);
  void search(const std::string&);
  void guarded(const std::function<void()>&);
  Desk& desk_;
  Workspace& workspace_;
  Side side_ = Side::a;
  std::uint64_t built_ = 0;
  ParameterModel model_;
  std::vector<PanelPart> parts_;
  std::vector<ParameterRow*> rows_;
  std::vector<std::pair<ColorRow*, std::size_t>> colors_;  // with the place of its red channel in rows_
  std::vector<std::pair<Section*, std::vector<ParameterRow*>>> sections_;
  std::map<std::string, bool> folded_;
  Choice* scene_ = nullptr;
  Choice* technique_ = nullptr;
  Choice* view_ = nullptr;
  Field* search_ = nullptr;
  std::string searched_, last_;
};

}  // namespace pellucid::sandbox
