#pragma once

#include <functional>

#include <toml++/toml.h>

#include "algorithms/scene/toml/toml_reader.hpp"

namespace pellucid::sweeps {

/// The tree of a spec with its [preview] applied and taken away (keys: sweeps/README.md). `parse` reads the file; it is
/// called more than once, since a node keeps its place in the file only while it is moved, not when it is copied.
/// Throws InputError with the place for an overlay that is missing, has an unknown key, or names a block, scene or axis
/// that the spec lacks.
toml::table preview_of(const TomlFile&, const std::function<toml::table()>& parse);

}  // namespace pellucid::sweeps
