#include "plots/charts/style.hpp"

#include <algorithm>
#include <iterator>
#include <string>

namespace pellucid::plots {
namespace {

constexpr Marker kMarkers[] = {Marker::circle,        Marker::square, Marker::diamond, Marker::triangle_up,
                               Marker::triangle_down, Marker::cross,  Marker::plus};

}  // namespace

Style style(std::size_t i) {
  Style result;
  result.color = kPalette[i % std::size(kPalette)];
  result.marker = kMarkers[i % std::size(kMarkers)];
  result.line = i < std::size(kPalette) ? Line::solid : Line::dashed;
  return result;
}

Style variant(const Style& base, std::size_t n) {
  const auto own = std::find(std::begin(kMarkers), std::end(kMarkers), base.marker);
  const std::size_t first = own == std::end(kMarkers) ? 0 : static_cast<std::size_t>(own - std::begin(kMarkers));
  // Three further on, so that the first variants do not take another technique's marker.
  return {base.color, kMarkers[(first + 3 * n) % std::size(kMarkers)], n % 2 == 1 ? Line::dashed : Line::dotted};
}

std::string technique_title(std::string_view technique) {
  std::string title(technique);
  std::replace(title.begin(), title.end(), '_', ' ');
  return title;
}

}  // namespace pellucid::plots
