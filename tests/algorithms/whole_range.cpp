// Every parameter of every technique takes its least, its default and its greatest value, gives it back, and draws a
// frame with it.
#include <cstdint>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "algorithms/render_session.hpp"
#include "algorithms/scene/scene.hpp"
#include "algorithms/scene/shapes/procedural.hpp"
#include "algorithms/technique.hpp"
#include "gl/error.hpp"
#include "tests/algorithms/rendered.hpp"
#include "tests/algorithms/scenes.hpp"

namespace pellucid {
namespace {

/// The scene that the technique draws: an interface in a room with an opaque ball, or fog with one.
Scene scene_for(const TechniqueInfo& info) {
  if (!info.interfaces) return test::fog_box_with_ball({4, 4, 4}, 0.75F, 0.9F);
  Scene scene = test::fog_box_with_ball({4, 4, 4}, 0.75F, 0.9F);
  scene.volume.reset();
  scene.materials.push_back({.name = "glass", .kind = SurfaceKind::dielectric, .ior = 1.5F});
  scene.meshes.push_back(make_sphere(0.5F, 12));
  Instance glass{.name = "glass"};
  glass.mesh = 1;
  glass.material = 1;
  glass.to_world = glm::translate(glm::mat4(1.0F), glm::vec3(0.2F, 0.1F, 2.0F));
  scene.instances.push_back(glass);
  return scene;
}

std::vector<Value> ends_and_default(const ParameterInfo& p) {
  std::vector<Value> values{p.default_value};
  if (p.type == ValueType::integer) {
    values.insert(values.end(), {static_cast<std::int64_t>(p.min), static_cast<std::int64_t>(p.max)});
  } else if (p.type == ValueType::real) {
    values.insert(values.end(), {p.min, p.max});
  } else if (p.type == ValueType::boolean) {
    values.insert(values.end(), {false, true});
  } else {
    values.insert(values.end(), p.choices.begin(), p.choices.end());
  }
  return values;
}

class WholeRange : public testing::TestWithParam<std::string> {};

TEST_P(WholeRange, EveryValueIsDrawn) {
  test::use_context();
  const TechniqueInfo& info = find_technique(GetParam());
  const auto technique = info.make();
  const ParameterRef own = technique->parameters();
  RenderSession session(scene_for(info), info.name, "front", 8, 6);
  const auto parameters = info.table().infos();
  const auto assign = [&](const ParameterInfo& p, const Value& value) {
    own.assign(p.name, value, info.name);
    EXPECT_EQ(to_text(own.get(p.name)), to_text(value)) << p.name;
    session.assign(p.name, value);
  };
  // Dear work stays small while another parameter is tried: its numbers are the least, and while one of them is the
  // greatest its kind is the first choice, which is the plainest.
  const auto dear = [](const ParameterInfo& p, ValueType type) {
    return p.when == Change::precompute && p.type == type;
  };
  const auto small = [&](const ParameterInfo& p) -> Value {
    return dear(p, ValueType::integer) ? Value(static_cast<std::int64_t>(p.min)) : p.default_value;
  };
  const auto choose_plainest = [&](bool plainest) {
    for (const ParameterInfo& p : parameters) {
      if (dear(p, ValueType::choice)) assign(p, plainest ? Value(std::string(p.choices.front())) : p.default_value);
    }
  };
  for (const ParameterInfo& p : parameters)
    assign(p, small(p));
  for (const ParameterInfo& p : parameters) {
    EXPECT_NE(p.doc, "") << p.name;
    EXPECT_NE(p.cite, "") << p.name;
    for (const Value& value : ends_and_default(p)) {
      const bool greatest =
          dear(p, ValueType::integer) && to_text(value) == to_text(Value(static_cast<std::int64_t>(p.max)));
      if (greatest) choose_plainest(true);
      assign(p, value);
      gl::PassTimer timer;
      try {
        session.render(timer);
      } catch (const InputError& error) {
        // A limit of a device or a scene is told by the parameter's name.
        EXPECT_NE(std::string(error.what()).find(p.name), std::string::npos) << error.what();
        continue;
      }
      EXPECT_EQ(test::not_finite(session.read_color()), 0) << p.name << " = " << to_text(value);
    }
    if (dear(p, ValueType::integer)) choose_plainest(false);
    assign(p, small(p));
  }
}

std::vector<std::string> names() {
  std::vector<std::string> result;
  for (const TechniqueInfo& info : techniques())
    result.emplace_back(info.name);
  return result;
}
INSTANTIATE_TEST_SUITE_P(Techniques, WholeRange, testing::ValuesIn(names()),
                         [](const auto& tested) { return tested.param; });

}  // namespace
}  // namespace pellucid
