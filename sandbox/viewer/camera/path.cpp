#include "sandbox/viewer/camera/path.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>

#include "algorithms/scene/view_text.hpp"

namespace pellucid::sandbox {

View view_along(std::span<const View> views, double share) {
  assert(!views.empty());
  if (views.size() == 1) return views.front();
  const auto last = static_cast<int>(views.size()) - 1;
  const double at = std::clamp(share, 0.0, 1.0) * last;
  const int from = std::min(static_cast<int>(std::floor(at)), last - 1);
  const auto t = static_cast<float>(at - from);
  if (t == 0) return views[static_cast<std::size_t>(from)];
  if (t == 1) return views[static_cast<std::size_t>(from) + 1];
  const auto view = [&](int i) -> const View& { return views[static_cast<std::size_t>(std::clamp(i, 0, last))]; };
  const auto spline = [&](auto&& of) {
    const auto p0 = of(view(from - 1)), p1 = of(view(from)), p2 = of(view(from + 1)), p3 = of(view(from + 2));
    return 0.5F * (2.0F * p1 + (p2 - p0) * t + (2.0F * p0 - 5.0F * p1 + 4.0F * p2 - p3) * (t * t) +
                   (3.0F * p1 - p0 - 3.0F * p2 + p3) * (t * t * t));
  };
  View out = view(from);
  out.eye = spline([](const View& v) { return v.eye; });
  out.target = spline([](const View& v) { return v.target; });
  out.up = spline([](const View& v) { return v.up; });
  out.fov_y_deg = std::clamp(spline([](const View& v) { return v.fov_y_deg; }), 1.0F, 179.0F);
  out.near_m = std::min(view(from).near_m, view(from + 1).near_m);
  out.far_m = std::max(view(from).far_m, view(from + 1).far_m);
  out.name = to_view_text(out);
  return out;
}

}  // namespace pellucid::sandbox
