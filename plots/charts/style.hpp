#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "plots/charts/chart.hpp"

namespace pellucid::plots {

/// Eight colours that stay apart for the common kinds of colour blindness (Okabe and Ito 2008, "Color Universal
/// Design"), yellow last since it is faint on paper.
inline constexpr Color kPalette[] = {{0, 114, 178},  {213, 94, 0},  {0, 158, 115}, {204, 121, 167},
                                     {86, 180, 233}, {230, 159, 0}, {0, 0, 0},     {240, 228, 66}};
inline constexpr Color kInk{34, 34, 34};
inline constexpr Color kFaintInk{102, 102, 102};
inline constexpr Color kGrid{224, 224, 224};

/// The i-th of a row of styles; colour and marker change together, so that a grey print can be read too.
Style style(std::size_t i);

/// The same colour with another marker and line, for the n-th group of one technique (n >= 1).
Style variant(const Style&, std::size_t n);
/// "volume slices" for "volume_slices".
std::string technique_title(std::string_view technique);

}  // namespace pellucid::plots
