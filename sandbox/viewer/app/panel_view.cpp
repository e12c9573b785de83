#include "sandbox/viewer/app/panel_view.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "gl/error.hpp"
#include "sandbox/viewer/panel/controls.hpp"

namespace pellucid::sandbox {
namespace {

constexpr const char* kFreeCamera = "(free camera)";

std::vector<std::string> technique_names() {
  std::vector<std::string> names;
  for (const TechniqueInfo& info : techniques())
    names.emplace_back(info.name);
  return names;
}

std::vector<std::string> scene_names(const std::string& current) {
  std::vector<std::string> names;
  for (const SceneInfo& info : list_scenes())
    names.push_back(info.name);
  // A file of the user's own.
  if (std::find(names.begin(), names.end(), current) == names.end()) names.insert(names.begin(), current);
  return names;
}

template <class T>
T* add(nanogui::Widget* parent, const std::string& id, const std::string& hint) {
  T* widget = new T(parent);
  widget->setId(id);
  widget->set_hint(hint);
  return widget;
}

}  // namespace

PanelView::PanelView(Desk& desk, Workspace& workspace) : desk_(desk), workspace_(workspace) {
  model_.get = [this](const std::string& name) { return workspace_.get(side_, name); };
  model_.set = [this](const std::string& name, const Value& value) {
    guarded([&] { workspace_.set(side_, name, value); });
  };
  model_.set_together = [this](const auto& values) { guarded([&] { workspace_.set(side_, values); }); };
}

void PanelView::guarded(const std::function<void()>& change) {
  try {
    change();
  } catch (const InputError& e) {
    if (failed) failed(e.what());
  }
}

void PanelView::add_part(PanelPart part) {
  parts_.push_back(std::move(part));
  built_ = 0;
}

void PanelView::set_side(Side side) {
  if (side == side_) return;
  side_ = side;
  built_ = 0;
}

void PanelView::build_head(Stack& stack) {
  auto* scene_bar = new Bar(&stack, "Scene");
  scene_ = add<Choice>(scene_bar, "scene", "The scene. Its parameters, where the next has them too, carry over.");
  scene_->items = scene_names(workspace_.scene());
  scene_->chosen = [this](const std::string& name) { guarded([&] { workspace_.set_scene(name); }); };

  auto* technique_bar = new Bar(&stack, side_ == Side::a ? "Technique" : "Technique B");
  technique_ =
      add<Choice>(technique_bar, "technique", "The technique. Each keeps its parameters while another is shown.");
  technique_->items = technique_names();
  technique_->chosen = [this](const std::string& name) { guarded([&] { workspace_.set_technique(side_, name); }); };

  auto* view_bar = new Bar(&stack, "View");
  view_ =
      add<Choice>(view_bar, "view", "A named view of the scene. Dragging in the picture leaves it for a free camera.");
  for (const View& view : workspace_.views())
    view_->items.push_back(view.name);
  view_->chosen = [this](const std::string& name) {
    if (name != kFreeCamera) workspace_.set_view(name);
  };

  auto* search_bar = new Bar(&stack, "Search");
  search_ =
      add<Field>(search_bar, "search", "Shows the parameters whose name, symbol or description has these letters.");
  search_->show(searched_);
  search_->typed = [this](const std::string& text) { search(text); };
  search_->offer = [this](const std::string& text) {
    search(text);
    return std::string{};
  };
  auto* reset = new PushButton(search_bar, "Reset all", [this] { reset_all(); });
  reset->setId("reset all");
  reset->set_hint("Every parameter goes back to its default. A click on one name resets that alone.");
}

void PanelView::rebuild() {
  built_ = workspace_.structure();
  for (const auto& [section, rows] : sections_)
    folded_[section->title()] = !section->open();
  const std::string focused = desk_.focus() != nullptr ? desk_.focus()->id() : "";
  desk_.let_go();
  Stack* content = desk_.panel()->content();
  while (content->childCount() > 0)
    content->removeChild(content->childCount() - 1);
  rows_.clear();
  colors_.clear();
  sections_.clear();
  build_head(*content);
  for (const Workspace::Group& group : workspace_.groups(side_)) {
    const auto folded = folded_.find(group.title);
    const bool rare = group.prefix == "frame." || group.prefix == "shadow.";
    auto* section = new Section(content, group.title, folded == folded_.end() ? !rare : !folded->second);
    std::vector<ParameterRow*> rows;
    for (std::size_t i = 0; i < group.infos.size(); ++i) {
      const ParameterInfo& info = group.infos[i];
      if (const std::string color = color_at(group.infos, i); !color.empty())
        colors_.emplace_back(new ColorRow(section->body(), group.prefix + color, info, model_), rows_.size());
      auto* row = new ParameterRow(section->body(), group.prefix + info.name, info, model_);
      rows.push_back(row);
      rows_.push_back(row);
    }
    sections_.emplace_back(section, std::move(rows));
  }
  for (const PanelPart& part : parts_)
    part.build(*content);
  search(searched_);
  if (!focused.empty()) desk_.focus_on(focused);
}

void PanelView::search(const std::string& text) {
  searched_ = text;
  for (const auto& [section, rows] : sections_) {
    bool any = rows.empty();
    for (ParameterRow* row : rows) {
      row->setVisible(row->matches(text));
      any = any || row->visible();
    }
    section->setVisible(any);
    if (any && !text.empty()) section->set_open(true);
  }
  for (const auto& [color, red] : colors_)
    color->setVisible(rows_[red]->visible() || rows_[red + 1]->visible() || rows_[red + 2]->visible());
  desk_.layout_changed();
}

void PanelView::update() {
  if (built_ != workspace_.structure()) rebuild();
  scene_->current = workspace_.scene();
  technique_->current = workspace_.technique(side_);
  const std::string& view = workspace_.view_name();
  view_->current = view.find('=') != std::string::npos ? kFreeCamera
                   : !view.empty()                     ? view
                   : workspace_.views().empty()        ? ""
                                                       : workspace_.views().front().name;
  for (ParameterRow* row : rows_)
    row->refresh();
  for (const auto& [color, red] : colors_)
    color->refresh();
  if (const std::string now = current_parameter(); !now.empty()) last_ = now;
  for (const PanelPart& part : parts_)
    if (part.refresh) part.refresh();
}

void PanelView::reset_all() {
  for (ParameterRow* row : rows_)
    row->reset();
}

void PanelView::focus_search() {
  desk_.show_panel(true);
  search_->requestFocus();
}

std::string PanelView::current_parameter() const {
  const auto row_of = [](const nanogui::Widget* widget) -> std::string {
    for (; widget != nullptr; widget = widget->parent())
      if (const auto* row = dynamic_cast<const ParameterRow*>(widget)) return row->name();
    return "";
  };
  const std::string under_pointer = row_of(desk_.under_pointer());
  return under_pointer.empty() ? row_of(desk_.focus()) : under_pointer;
}

void PanelView::step_technique(int by) {
  const std::vector<std::string> names = technique_names();
  const auto count = static_cast<int>(names.size());
  const auto at = static_cast<int>(std::find(names.begin(), names.end(), workspace_.technique(side_)) - names.begin());
  guarded([&] { workspace_.set_technique(side_, names[static_cast<std::size_t>((at + by + count) % count)]); });
}

void PanelView::step_view(int by) {
  const auto& views = workspace_.views();
  if (views.empty()) return;
  const auto count = static_cast<int>(views.size());
  const auto it = std::find_if(views.begin(), views.end(), [&](const View& v) { return v.name == view_->current; });
  const int at = it == views.end() ? (by > 0 ? -1 : 0) : static_cast<int>(it - views.begin());
  workspace_.set_view(views[static_cast<std::size_t>((at + by + count) % count)].name);
}

}  // namespace pellucid::sandbox
