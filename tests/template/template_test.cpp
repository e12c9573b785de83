// The folder tests/template/my_technique, added as CONTRIBUTING.md says: copied into algorithms/, one line in each of
// two lists.
#include <algorithm>
#include <cstdlib>
#include <string>

#include <gtest/gtest.h>

#include "algorithms/render_session.hpp"
#include "algorithms/scene/scene.hpp"
#include "algorithms/technique.hpp"
#include "gl/context.hpp"

namespace pellucid {
namespace {

Image frame(const char* strength, const char* inverted) {
  RenderSession session(load_scene(PELLUCID_TEMPLATE_TREE "/algorithms/my_technique/scenes/my_scene.toml"),
                        "my_technique", "front", 16, 12);
  session.assign_text("frame.format", "single");
  session.assign_text("strength", strength);
  session.assign_text("inverted", inverted);
  gl::PassTimer timer;
  session.render(timer);
  return session.read_color();
}

TEST(Template, IsListedBesideTheOthers) {
  EXPECT_EQ(find_technique("my_technique").title, "My technique");
  EXPECT_EQ(find_technique("ray_marching").name, "ray_marching");
}

TEST(Template, DrawsWhatItsEquationSays) {
  setenv("PELLUCID_SHADER_PATH", PELLUCID_TEMPLATE_TREE, 1);
  const gl::Context context;
  const Image plain = frame("0", "false"), half = frame("0.5", "false"), inverted = frame("1", "true");
  const float tint[] = {1, 0.5F, 0.25F};
  float brightest = 0;
  for (int y = 0; y < plain.height; ++y) {
    for (int x = 0; x < plain.width; ++x) {
      for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(half.at(x, y)[c], 0.5F * plain.at(x, y)[c] + 0.5F * tint[c], 1e-6F);
        EXPECT_NEAR(inverted.at(x, y)[c], 1 - tint[c], 1e-6F);
        brightest = std::max(brightest, plain.at(x, y)[c]);
      }
    }
  }
  EXPECT_GT(brightest, 0.1F) << "a black picture tells nothing";
}

}  // namespace
}  // namespace pellucid
