#pragma once

#include <string>
#include <string_view>

#include "algorithms/scene/scene.hpp"

/// A camera written as one word, which stands wherever a view's name does (`--view`, a sweep's `views`, a recipe):
///
///   front:eye=0,1.5,4:target=0,0.5,0:up=0,1,0:fov=45:near=0.1:far=100
///
/// The first part names the view of the scene that gives what is left out; without it that is the scene's first.
/// Lengths are in metres, `fov` is the vertical angle in degrees.
namespace pellucid {

/// True for a text of that form; other texts can only be names.
bool is_view_text(std::string_view);

/// The view of `scene` that a user asked for: by its name (Scene::find_view) or as such a text.
View view_of(const Scene& scene, std::string_view name_or_text);

/// The view, named by the text itself. Throws InputError that names the part which is wrong.
View parse_view_text(std::string_view, const Scene&);

/// Reads back as the same view, bit for bit; names no base, since it gives every part.
std::string to_view_text(const View&);

}  // namespace pellucid
