#include "sweeps/spec/plan.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <set>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "sweeps/spec/constraint.hpp"
#include "tests/sweeps/fake_known_names.hpp"

namespace pellucid::sweeps {
namespace {

using test::FakeKnownNames;
using test::input_error;

const char* const kHead = "name='s'\n[[run]]\nname='r'\ntechniques=['hulls']\nscenes=['forest']\n";

Plan plan_of(const std::string& text, const FakeKnownNames& known_names = {}) {
  return make_plan(parse_spec(text, "s.toml", known_names), known_names);
}

std::vector<std::string> values(const Plan& plan, const std::string& a, const std::string& b) {
  std::vector<std::string> result;
  for (const Member& member : plan.members) {
    const Point& point = plan.points[member.point];
    result.push_back(to_text(point.parameters.at(a)) + " " + to_text(point.parameters.at(b)));
  }
  return result;
}

TEST(Plan, AGridRunsTheLastAxisFastest) {
  const Plan plan = plan_of(std::string(kHead) + "[run.axes]\nhulls=[1,2]\nsamples=[3,4,5]\n");
  EXPECT_EQ(values(plan, "hulls", "samples"), (std::vector<std::string>{"1 3", "1 4", "1 5", "2 3", "2 4", "2 5"}));
}

TEST(Plan, AZipWalksTheAxesTogether) {
  const Plan plan = plan_of(std::string(kHead) + "combine='zip'\n[run.axes]\nhulls=[1,2,4]\nsamples=[32,16,8]\n");
  EXPECT_EQ(values(plan, "hulls", "samples"), (std::vector<std::string>{"1 32", "2 16", "4 8"}));
}

TEST(Plan, PlacesMultiplyWithTheAxes) {
  const Plan plan = plan_of(
      "name='s'\n[[run]]\nname='r'\ntechniques=['hulls','slices']\nscenes=['forest','ball']\nsizes=['8x8','16x8']\n"
      "[run.axes]\nhulls=[1,2,3]\n");
  EXPECT_EQ(plan.points.size(), 2U * 2 * 2 * 3);
  EXPECT_EQ(plan.points.front().view, "front");  // the scene's first
  EXPECT_EQ(plan.points.back().view, "near");
  EXPECT_EQ(plan.points.back().technique, "slices");
  EXPECT_EQ(plan.points.back().size.width, 16);
}

TEST(Plan, ConstraintsKeepWhatTheyAllow) {
  const Plan plan = plan_of(std::string(kHead) +
                            "constraints=['hulls * samples == 32', 'hulls > 1 && width <= 720']\n"
                            "[run.axes]\nhulls={from=1,to=32,log2=true}\nsamples={from=1,to=32,log2=true}\n");
  EXPECT_EQ(values(plan, "hulls", "samples"), (std::vector<std::string>{"2 16", "4 8", "8 4", "16 2", "32 1"}));
}

TEST(Plan, WrongConstraintsNameThePlace) {
  const auto error = [](const std::string& constraint) {
    return input_error([&] { plan_of(std::string(kHead) + "constraints = [\"1 < 2\", \"" + constraint + "\"]\n"); });
  };
  EXPECT_EQ(error("hull <= 3"), "s.toml:6:25: expression 'hull <= 3': unknown name 'hull'; did you mean 'hulls'?");
  EXPECT_EQ(error("hulls * 3"),
            "s.toml:6:25: constraint 'hulls * 3' gives 12, neither true nor false; compare with <=, <, ==, !=, >, >=");
  EXPECT_EQ(error("hulls = 3"), "s.toml:6:25: expression 'hulls = 3': '=' assigns; compare with '=='");
  EXPECT_TRUE(error("0 / 0 * hulls").starts_with("s.toml:6:25: constraint '0 / 0 * hulls' gives nan,"))
      << error("0 / 0 * hulls");
  EXPECT_TRUE(error("hulls < ").starts_with("s.toml:6:25: expression 'hulls < ': ")) << error("hulls < ");
  EXPECT_EQ(error("hulls < 3, 1 < 2"), "s.toml:6:25: expression 'hulls < 3, 1 < 2': more than one expression");
  EXPECT_TRUE(error("format == 1").starts_with("s.toml:6:25: expression 'format == 1': unknown name 'fo"))
      << error("format == 1");
  EXPECT_EQ(error("hulls > 99"), "s.toml:6:16: the constraints leave no point in block 'r'");
}

TEST(Plan, ConstraintsSeeSceneParametersAndSwitches) {
  Expression expression("scene.density * 2 >= 3 && filter", {"scene.density", "filter"});
  EXPECT_TRUE(expression.holds({{"scene.density", 1.5}, {"filter", 1}}));
  EXPECT_FALSE(expression.holds({{"scene.density", 1.5}, {"filter", 0}}));
  EXPECT_FALSE(expression.holds({{"scene.density", 1.4}, {"filter", 1}}));
}

TEST(Plan, RefusesTooManyPointsBeforeMakingThem) {
  const std::string message = input_error([] {
    plan_of(std::string(kHead) +
            "[run.axes]\noffset={from=0,to=1,steps=100000}\nscene.density={from=0,to=1,steps=100000}\n");
  });
  EXPECT_EQ(message, "s.toml:2:1: block 'r' asks for more than 100000 points");
}

TEST(Plan, IsTheSameEveryTime) {
  const std::string text =
      std::string(kHead) + "[run.axes]\nhulls={from=1,to=64,steps=64}\nformat=['unorm8','single']\n";
  const Plan a = plan_of(text);
  const Plan b = plan_of(text);
  EXPECT_EQ(a.order, b.order);
  for (std::size_t i = 0; i < a.points.size(); ++i)
    EXPECT_EQ(a.points[i].id, b.points[i].id);
}

TEST(Plan, OrderIsAShuffleThatSharesPrecomputation) {
  const Plan plan =
      plan_of(std::string(kHead) + "[run.axes]\nhulls={from=1,to=32,steps=32}\nformat=['unorm8','single']\n");
  std::vector<std::size_t> sorted = plan.order;
  std::sort(sorted.begin(), sorted.end());
  for (std::size_t i = 0; i < sorted.size(); ++i)
    EXPECT_EQ(sorted[i], i);
  EXPECT_NE(plan.order, sorted);

  const auto format = [&](std::size_t i) { return plan.points[plan.order[i]].parameters.at("format"); };
  std::size_t changes = 0;
  for (std::size_t i = 1; i < plan.order.size(); ++i)
    changes += format(i) != format(i - 1) ? 1U : 0U;
  EXPECT_LE(changes, 15U);  // chunks of four, so at most 15 seams between 16 chunks
  EXPECT_GE(changes, 3U);   // yet interleaved
}

TEST(Plan, EveryThingThatMattersChangesTheId) {
  const std::string base = std::string(kHead) + "sizes=['64x48']\n";
  std::set<std::string> ids;
  const auto add = [&](const std::string& text, const FakeKnownNames& known_names = {}) {
    const Plan plan = plan_of(text, known_names);
    EXPECT_EQ(plan.points.size(), 1U);
    EXPECT_EQ(plan.points[0].id.size(), 16U);
    EXPECT_TRUE(ids.insert(plan.points[0].id).second) << text;
  };
  add(base);
  add(base + "[run.fixed]\nhulls=5\n");
  add(base + "[run.fixed]\nscene.density=0.5\n");
  add(base + "[run.fixed]\nframe.format='single'\n");
  add(base + "views=['inside']\n");
  add(std::string(kHead) + "sizes=['65x48']\n");
  add(base + "metrics=['flip']\n");
  add(base + "metrics=[]\n");
  add(base + "timing.enabled=false\n");
  add(base + "timing.max_seconds=5\n");
  add(base + "reference.tolerance=1e-3\n");
  add(base + "reference.surfaces='rays'\n");
  FakeKnownNames edited_shader;
  edited_shader.code = "code 2";
  add(base, edited_shader);
  FakeKnownNames edited_scene;
  edited_scene.forest.content_hash = "another hash";
  add(base, edited_scene);
}

TEST(Plan, NamesAndSpellingsDoNotChangeTheId) {
  const std::string id = plan_of(std::string(kHead)).points[0].id;
  EXPECT_EQ(plan_of("name='other'\n[[run]]\nname='x'\ntechniques=['hulls']\nscenes=['forest']\n").points[0].id, id);
  EXPECT_EQ(plan_of(std::string(kHead) + "[run.fixed]\nhulls=4\noffset=0\n").points[0].id, id);  // the defaults
  EXPECT_EQ(plan_of(std::string(kHead) + "metrics=['flip','ssim','psnr','rmse','mse']\n").points[0].id, id);
}

TEST(Plan, APointInTwoBlocksIsMeasuredOnce) {
  const Plan plan =
      plan_of(std::string(kHead) + "[run.axes]\nhulls=[1,2]\n" +
              "[[run]]\nname='q'\ntechniques=['hulls']\nscenes=['forest']\nbaseline=true\n[run.axes]\nhulls=[2,3]\n");
  EXPECT_EQ(plan.points.size(), 3U);
  ASSERT_EQ(plan.members.size(), 4U);
  EXPECT_EQ(plan.members[2].block, "q");
  EXPECT_EQ(plan.members[2].point, plan.members[1].point);
  EXPECT_EQ(plan.baseline, plan.members[2].point);
}

TEST(Plan, PointsShareTheirParametersAndKeepTheirOwnValues) {
  const PointParameters::Table table{{"c", true}, {"a", std::int64_t{1}}, {"b", 2.0}};
  const PointParameters shared(table);
  PointParameters own = shared;
  own.set(1, 3.0);
  own.set(0, std::int64_t{4});
  own.set(1, 5.0);
  const auto text = [](const PointParameters& parameters) {
    std::string all;
    for (const auto& [name, value] : parameters)
      all += name + "=" + to_text(value) + " ";
    return all;
  };
  EXPECT_EQ(text(shared), "a=1 b=2 c=true ");
  EXPECT_EQ(text(own), "a=4 b=5 c=true ");
  EXPECT_EQ(std::get<double>(own.at("b")), 5.0);
  EXPECT_EQ(std::get<double>(shared.at("b")), 2.0);
  EXPECT_THROW(own.at("bb"), std::out_of_range);
  EXPECT_THROW(own.at("d"), std::out_of_range);
}

TEST(Plan, RepeatCommandIsOneSoundLine) {
  const Plan plan = plan_of(std::string(kHead) + "[run.axes]\nhulls=[7]\n[run.fixed]\nscene.density=0.25\n");
  EXPECT_EQ(repeat_command(plan.points[0]),
            "pellucid render forest -t hulls -s hulls=7 -s scene.density=0.25 --view front --size "
            "720x540 -o " +
                plan.points[0].id + ".exr");
  Point odd = plan.points[0];
  odd.scene = "my scene's.toml";
  EXPECT_NE(repeat_command(odd).find("render 'my scene'\\''s.toml' -t"), std::string::npos);
}

}  // namespace
}  // namespace pellucid::sweeps
