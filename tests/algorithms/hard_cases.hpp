#pragma once

#include <functional>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/algorithms/rendered.hpp"
#include "tests/algorithms/scenes.hpp"

/// The media techniques where they are easily wrong: cameras and lights in odd places, least settings, extreme media.
namespace pellucid::test {

/// A technique at its least settings and at such fine ones that little but rounding is left.
struct Contender {
  const char* name;
  std::string technique;
  Values least, fine;
  bool slices = false;  ///< their slabs are drawn whole or not at all
};
inline std::ostream& operator<<(std::ostream& out, const Contender& c) {
  return out << c.name;
}

inline const std::vector<Contender>& contenders() {
  static const std::vector<Contender> all{
      {"hulls",
       "sampling_hulls",
       {{"hulls", "1"}, {"samples", "1"}},
       {{"hulls", "16"}, {"samples", "64"}, {"sample_offset", "0.5"}, {"coordinates", "single"}}},
      {"image_slices", "volume_slices", {{"slices", "1"}}, {{"slices", "2048"}}, true},
      {"object_slices",
       "volume_slices",
       {{"slices", "1"}, {"alignment", "object"}},
       {{"slices", "2048"}, {"alignment", "object"}},
       true},
      {"marching", "ray_marching", {{"samples", "1"}}, {{"samples", "1024"}}},
      {"jittered_marching",
       "ray_marching",
       {{"samples", "1"}, {"jitter", "interleaved"}},
       {{"samples", "1024"}, {"jitter", "interleaved"}}},
  };
  return all;
}

inline Settings settings(const Contender& c, Values values, const std::string& view = "front") {
  values.emplace_back("frame.format", "single");
  return {.technique = c.technique, .values = std::move(values), .view = view, .width = 60, .height = 45};
}

/// No NaN and no infinity, in the paper's 16-bit frame, where numbers above 65504 do not fit.
inline void expect_finite(const std::function<Scene()>& make, const Contender& c, const std::string& view) {
  for (const Values& values : {Values{}, c.least}) {
    Settings s{.technique = c.technique, .values = values, .view = view, .width = 33, .height = 25};
    EXPECT_EQ(not_finite(frame(make(), s)), 0) << view << (values.empty() ? "" : ", least settings");
  }
}

class HardCases : public testing::TestWithParam<Contender> {
 protected:
  const Contender& c = GetParam();

  /// The fine settings against the reference.
  void expect_near(const std::function<Scene()>& make, double max, double mean, const std::string& view = "front",
                   Values more = {}) const {
    Values values = c.fine;
    values.insert(values.end(), more.begin(), more.end());
    const Rendered r = render(make(), settings(c, values, view));
    ASSERT_EQ(not_finite(r.image), 0) << view;
    const Difference d = difference(r.image, r.reference.image);
    EXPECT_LE(d.max, max) << view;
    EXPECT_LE(d.mean, mean) << view;
  }
};

inline View view_at(const char* name, const glm::vec3& eye, const glm::vec3& target, float fov_y_deg = 60.0F,
                    float near_m = 0.1F) {
  return {.name = name, .eye = eye, .target = target, .fov_y_deg = fov_y_deg, .near_m = near_m};
}

/// Fog of 0.5 per metre in [−1, 1]³, a black world around it, seen from +z by a camera whose middle pixel's ray runs
/// along the z axis.
inline Scene aligned_fog(float extinction = 0.5F, const glm::ivec3& voxels = glm::ivec3(1), float density = 1.0F) {
  Scene scene;
  scene.name = "aligned";
  Volume fog;
  fog.name = "fog";
  fog.size = voxels;
  fog.density = make_constant_density(voxels, density);
  fog.extinction = extinction;
  fog.albedo = {0.9F, 0.6F, 0.3F};
  fog.to_world = glm::translate(glm::mat4(1.0F), glm::vec3(-1.0F)) * glm::scale(glm::mat4(1.0F), glm::vec3(2.0F));
  scene.volume = fog;
  scene.views.push_back(view_at("front", {0.0F, 0.0F, 4.0F}, glm::vec3(0.0F), 30.0F));
  return scene;
}

inline Light lamp(const glm::vec3& place, float intensity, LightKind kind = LightKind::point, bool shadow = false) {
  Light light{.name = "lamp", .kind = kind, .position = place, .casts_shadow = shadow};
  light.intensity = intensity * glm::vec3(1.0F, 0.8F, 0.6F);
  return light;
}

}  // namespace pellucid::test
