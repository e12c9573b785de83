#pragma once

#include <cstddef>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

#include "algorithms/technique.hpp"

/// Techniques that tell their errors by pixel share this: the map first, and its statistics.
namespace pellucid {

/// NaN everywhere.
NativeMap make_native_map(std::string_view name, std::string_view unit, std::string_view doc, int width, int height);

/// The map's value for a pixel as OpenGL counts them, in rows from the bottom.
float& gl_pixel(NativeMap&, std::size_t pixel);

/// Over the pixels that have a value: `NAME_mean`, `_median`, `_q95` and `_max`; of a map without a unit, which is 0 or
/// 1, the mean alone, as `NAME_share`. Nothing where no pixel has one.
void summarise(const NativeMap&, nlohmann::json& out);

}  // namespace pellucid
