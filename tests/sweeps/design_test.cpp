#include "sweeps/spec/design.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <numeric>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "sweeps/spec/plan.hpp"
#include "tests/sweeps/fake_known_names.hpp"

namespace pellucid::sweeps {
namespace {

using test::FakeKnownNames;
using test::input_error;

const char* const kDesignHead = "name='s'\n[[run]]\nname='r'\ntechniques=['hulls']\nscenes=['forest']\n";

Spec spec_of(const std::string& text) {
  return parse_spec(kDesignHead + text, "s.toml", FakeKnownNames());
}
Plan design_plan(const std::string& text) {
  const FakeKnownNames known_names;
  return make_plan(spec_of(text), known_names);
}
std::string design_error(const std::string& text) {
  return input_error([&] { design_plan(text); });
}

/// How far the share of points in a corner box differs from its volume, at worst over a grid of boxes: a lower bound of
/// the star discrepancy.
double discrepancy(const std::vector<std::vector<double>>& points) {
  double worst = 0;
  for (int i = 1; i <= 16; ++i) {
    for (int j = 1; j <= 16; ++j) {
      const double x = i / 16.0;
      const double y = j / 16.0;
      const auto inside =
          std::count_if(points.begin(), points.end(), [&](const auto& p) { return p[0] < x && p[1] < y; });
      worst = std::max(worst, std::abs(static_cast<double>(inside) / static_cast<double>(points.size()) - x * y));
    }
  }
  return worst;
}

TEST(Design, IsTheSameForTheSameSeedAlone) {
  for (const DesignKind kind : {DesignKind::random, DesignKind::latin_hypercube, DesignKind::sobol}) {
    EXPECT_EQ(unit_points({kind, 32, 5}, 3), unit_points({kind, 32, 5}, 3));
    EXPECT_NE(unit_points({kind, 32, 5}, 3), unit_points({kind, 32, 6}, 3));
    for (const std::vector<double>& point : unit_points({kind, 100, 7}, 4)) {
      EXPECT_EQ(point.size(), 4U);
      for (const double u : point) {
        EXPECT_GE(u, 0);
        EXPECT_LT(u, 1);
      }
    }
  }
}

TEST(Design, ALatinHypercubeHasOnePointInEachPartOfEachAxis) {
  const auto points = unit_points({DesignKind::latin_hypercube, 50, 3}, 3);
  for (std::size_t d = 0; d < 3; ++d) {
    std::set<int> parts;
    for (const auto& point : points)
      parts.insert(static_cast<int>(point[d] * 50));
    EXPECT_EQ(parts.size(), 50U);
  }
}

// Each axis of 2^k points of a Sobol sequence has one in each of 2^k equal parts, and each pair of axes that forms a
// (0, 2)-sequence, as the first two do, one in each box of equal area. A digital shift keeps both.
TEST(Design, ASobolSequenceIsANet) {
  const auto points = unit_points({DesignKind::sobol, 256, 11}, 20);
  // The sequence proper begins with the origin, which the library leaves out: one part is hit twice at most.
  for (std::size_t d = 0; d < 20; ++d) {
    std::set<int> parts;
    for (const auto& point : points)
      parts.insert(static_cast<int>(point[d] * 256));
    EXPECT_GE(parts.size(), 255U) << d;
  }
  EXPECT_LT(discrepancy(points), 0.02);
  EXPECT_GT(discrepancy(unit_points({DesignKind::random, 256, 11}, 2)), 0.03);
}

TEST(Design, ALongerSobolDesignBeginsWithAShorterOne) {
  const auto longer = unit_points({DesignKind::sobol, 64, 2}, 5);
  const auto shorter = unit_points({DesignKind::sobol, 16, 2}, 5);
  EXPECT_TRUE(std::equal(shorter.begin(), shorter.end(), longer.begin()));
}

TEST(Design, IntegersAreEquallyLikelyAndRealsCanBeTyped) {
  ParameterInfo whole;
  whole.name = "n";
  whole.type = ValueType::integer;
  std::map<std::int64_t, int> counts;
  for (int i = 0; i < 4000; ++i)
    ++counts[std::get<std::int64_t>(value_at(whole, {.from = 1, .to = 4, .steps = {}, .log2 = false}, i / 4000.0))];
  EXPECT_EQ(counts.size(), 4U);
  for (const auto& [n, count] : counts)
    EXPECT_NEAR(count, 1000, 1) << n;
  ParameterInfo real;
  real.name = "x";
  real.type = ValueType::real;
  EXPECT_EQ(value_at(real, {.from = 0, .to = 1, .steps = {}, .log2 = false}, 1.0 / 3), Value(0.333333));
  EXPECT_EQ(value_at(real, {.from = 0.01, .to = 100, .steps = {}, .log2 = true}, 0.5), Value(1.0));
}

TEST(Design, DrawsTheRangesWithoutStepsAndGridsTheRest) {
  const Plan plan = design_plan(
      "design = { kind = 'latin_hypercube', count = 10, seed = 4 }\n[run.axes]\noffset = { from = 0, to = 1 }\n"
      "filter = [false, true]\nscene.density = { from = 0.1, to = 10, log2 = true }\n");
  ASSERT_EQ(plan.points.size(), 20U);
  std::set<double> offsets;
  std::set<std::pair<double, double>> pairs;
  for (const Point& point : plan.points) {
    offsets.insert(std::get<double>(point.parameters.at("offset")));
    pairs.emplace(std::get<double>(point.parameters.at("offset")),
                  std::get<double>(point.parameters.at("scene.density")));
  }
  EXPECT_EQ(offsets.size(), 10U);
  EXPECT_EQ(pairs.size(), 10U) << "the drawn axes walk together";
}

TEST(Design, LeavesOutThePointsThatComeAgain) {
  const Plan plan =
      design_plan("design = { kind = 'random', count = 100 }\n[run.axes]\nhulls = { from = 1, to = 4 }\n");
  EXPECT_EQ(plan.points.size(), 4U);
  EXPECT_EQ(plan.members.size(), 4U);
  ASSERT_EQ(plan.skipped.size(), 1U);
  EXPECT_EQ(plan.skipped[0].why, "the same point again");
  EXPECT_EQ(plan.skipped[0].points, 96U);
}

TEST(Design, ErrorsNameThePlace) {
  EXPECT_EQ(
      design_error("design = { kind = 'sobel', count = 4 }\n[run.axes]\nhulls={from=1,to=4}\n"),
      "s.toml:6:19: run[0].design.kind = 'sobel' is not one of random, latin_hypercube, sobol; did you mean 'sobol'?");
  EXPECT_EQ(design_error("design = { kind = 'sobol' }\n[run.axes]\nhulls={from=1,to=4}\n"),
            "s.toml:6:10: 'count' is missing in run[0].design");
  EXPECT_EQ(design_error("design = { count = 4 }\n[run.axes]\nhulls=[1,4]\n"),
            "s.toml:6:10: the design has no axis; one is a range of [run.axes] without `steps`: { from, to }");
  EXPECT_EQ(design_error("design = { count = 4 }\n[run.axes]\nhulls={from=1,to=400}\n"),
            "s.toml:8:7: hulls: hulls = 400 is out of range [1, 64]");
  EXPECT_EQ(design_error("design = { count = 4 }\n[run.axes]\nhulls={from=1.5,to=4}\n"),
            "s.toml:8:7: hulls: the range ends at 1.5, and hulls is an integer");
}

TEST(Zip, WalksWithinAGrid) {
  const Plan plan = design_plan(
      "zip = [['hulls', 'samples']]\n[run.axes]\nhulls = [1, 2, 4]\nfilter = [false, true]\nsamples = [32, 16, 8]\n");
  std::vector<std::string> values;
  for (const Point& point : plan.points) {
    values.push_back(to_text(point.parameters.at("hulls")) + " " + to_text(point.parameters.at("samples")) + " " +
                     to_text(point.parameters.at("filter")));
  }
  EXPECT_EQ(values,
            (std::vector<std::string>{"1 32 false", "1 32 true", "2 16 false", "2 16 true", "4 8 false", "4 8 true"}));
}

TEST(Zip, ErrorsNameThePlace) {
  EXPECT_EQ(design_error("zip = [['hulls', 'sample']]\n[run.axes]\nhulls=[1,2]\nsamples=[1,2]\n"),
            "s.toml:6:18: unknown axis 'sample'; did you mean 'samples'?");
  EXPECT_EQ(design_error("zip = [['hulls', 'samples']]\n[run.axes]\nhulls=[1,2,3]\nsamples=[1,2]\n"),
            "s.toml:9:1: a zip needs axes of equal length: samples has 2 values, hulls has 3");
  EXPECT_EQ(design_error("zip = [['hulls']]\n[run.axes]\nhulls=[1,2,3]\n"),
            "s.toml:6:8: a zip needs two axes at least");
  EXPECT_EQ(design_error("zip = ['hulls', 'samples']\n[run.axes]\nhulls=[1,2,3]\nsamples=[1,2,3]\n"),
            "s.toml:6:7: zip is a list of lists of axes, for example [[\"hulls\", \"samples\"]]");
  EXPECT_EQ(design_error("zip = [['hulls', 'samples'], ['hulls', 'offset']]\n[run.axes]\nhulls=[1]\n"),
            "s.toml:6:31: hulls is in a zip already");
  EXPECT_EQ(design_error("combine = 'zip'\nzip = [['hulls', 'samples']]\n[run.axes]\nhulls=[1]\nsamples=[1]\n"),
            "s.toml:7:7: combine = \"zip\" zips all axes already");
}

TEST(Range, ReadsAsWritten) {
  const auto values = [](const std::string& range) {
    std::vector<std::string> texts;
    const Spec spec = spec_of("[run.axes]\nscene.density=" + range + "\n");
    for (const Value& value : spec.blocks[0].axes[0].values)
      texts.push_back(to_text(value));
    return texts;
  };
  using Texts = std::vector<std::string>;
  EXPECT_EQ(values("{from=0.1,to=1,steps=10}"),
            (Texts{"0.1", "0.2", "0.3", "0.4", "0.5", "0.6", "0.7", "0.8", "0.9", "1"}));
  EXPECT_EQ(values("{from=0.001,to=10,steps=5,log2=true}"), (Texts{"0.001", "0.01", "0.1", "1", "10"}));
  EXPECT_EQ(values("{from=0,to=1,steps=4}")[1], "0.3333333333333333");  // no short decimal
  for (const std::string& text : values("{from=0.05,to=9.95,steps=199}"))
    EXPECT_LE(text.size(), 4U) << text;
}

}  // namespace
}  // namespace pellucid::sweeps
