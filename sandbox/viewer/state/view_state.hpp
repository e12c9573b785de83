#pragma once

#include <map>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "algorithms/parameters.hpp"
#include "algorithms/scene/images/image.hpp"

/// All that determines a picture: what the panel shows, what the renderer is asked for, what an EXR remembers.
namespace pellucid::sandbox {

struct ViewState {
  std::string scene, technique;
  std::string view;  ///< a name or a camera as text (view_text.hpp); empty: the scene's first
  int width = 720, height = 540;
  /// Under the names that RenderSession::assign() takes; those that are absent have their defaults.
  std::map<std::string, Value> parameters;

  bool operator==(const ViewState&) const = default;
};

/// The recipe of `pellucid render`, as its EXR holds it.
nlohmann::json to_recipe(const ViewState&);
/// Throws InputError that names `source` when a field is missing or of another type.
ViewState from_recipe(const nlohmann::json&, const std::string& source);

/// The state that made an EXR of `pellucid render` or of the window. Throws InputError for any other file.
ViewState state_of_file(const ImageFile&, const std::string& path);

/// The same picture from a shell: `pellucid render SCENE -t … -s … -o OUTPUT`, as words.
std::vector<std::string> render_words(const ViewState&, const std::string& output);

/// Where a parameter belongs: the table in which it is declared, by its prefix ("" for the technique's own, "scene.",
/// "frame.", "shadow.").
std::string prefix_of(const std::string& name);

}  // namespace pellucid::sandbox
