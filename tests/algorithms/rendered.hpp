#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "algorithms/render_session.hpp"
#include "gl/context.hpp"

/// Frames, their references, and how far apart they are.
namespace pellucid::test {

struct Difference {
  double max = 0, mean = 0;
};

/// Over the colour channels; not a number where either image is.
inline Difference difference(const Image& a, const Image& b) {
  Difference d;
  for (int y = 0; y < a.height; ++y) {
    for (int x = 0; x < a.width; ++x) {
      for (int c = 0; c < 3; ++c) {
        const double e = std::abs(static_cast<double>(a.at(x, y)[c]) - static_cast<double>(b.at(x, y)[c]));
        d.max = e > d.max || std::isnan(e) ? e : d.max;
        d.mean += e / (3.0 * a.width * a.height);
      }
    }
  }
  return d;
}

/// Values that are infinite or not a number, alpha included.
inline int not_finite(const Image& image) {
  return static_cast<int>(
      std::count_if(image.pixels.begin(), image.pixels.end(), [](float v) { return !std::isfinite(v); }));
}

using Values = std::vector<std::pair<std::string, std::string>>;

struct Settings {
  std::string technique = "sampling_hulls";
  Values values;
  std::string view = "front";
  int width = 120, height = 90;
};

struct Rendered {
  Image image;
  Reference reference;
};

/// Current for the caller; one for all tests of the process.
inline void use_context() {
  static gl::Context context;
  context.make_current();
}

inline RenderSession start(Scene scene, const Settings& settings) {
  use_context();
  RenderSession session(std::move(scene), settings.technique, settings.view, settings.width, settings.height);
  for (const auto& [name, value] : settings.values)
    session.assign_text(name, value);
  return session;
}

inline Image frame(Scene scene, const Settings& settings) {
  RenderSession session = start(std::move(scene), settings);
  gl::PassTimer timer;
  session.render(timer);
  return session.read_color();
}

/// A frame and its reference over the same surfaces.
inline Rendered render(Scene scene, const Settings& settings) {
  RenderSession session = start(std::move(scene), settings);
  gl::PassTimer timer;
  session.render(timer);
  return {session.read_color(), render_reference(session.scene(), session.camera(), session.raster_surfaces())};
}

}  // namespace pellucid::test
