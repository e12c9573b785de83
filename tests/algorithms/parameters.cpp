#include "algorithms/parameters.hpp"

#include <cmath>
#include <cstdint>
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "tests/input_error.hpp"

namespace pellucid {
namespace {

enum class Mode { slow, quick };

struct Sample {
  bool flag = true;
  int count = 4;
  float width = 0.5F;
  Mode mode = Mode::quick;
  static constexpr void parameters(auto& self, auto&& visit) {
    visit(PARAM(flag), {.cite = "Sec. 1", .doc = "a flag"});
    visit(PARAM(count), {.symbol = "M", .range = {1, 64}, .cite = "Sec. 2", .doc = "a count", .when = Change::program});
    visit(PARAM(width), {.range = {0, 1}, .cite = "Sec. 3", .doc = "a width", .unit = "m"});
    visit(PARAM(mode), {.cite = "Sec. 4", .doc = "a mode", .choices = "slow|quick"});
  }
};
static_assert(well_formed<Sample>());

struct Forgotten {
  int a = 1;
  int b = 1;
  static constexpr void parameters(auto& self, auto&& visit) {
    visit(PARAM(a), {.range = {0, 2}, .cite = "x", .doc = "declared"});
  }
};
static_assert(!well_formed<Forgotten>());

struct OutOfRange {
  int a = 5;
  static constexpr void parameters(auto& self, auto&& visit) {
    visit(PARAM(a), {.range = {0, 2}, .cite = "x", .doc = "default too large"});
  }
};
static_assert(!well_formed<OutOfRange>());

struct Undocumented {
  int a = 1;
  static constexpr void parameters(auto& self, auto&& visit) { visit(PARAM(a), {.range = {0, 2}, .cite = "x"}); }
};
static_assert(!well_formed<Undocumented>());

TEST(Parameters, TableKeepsWhatWasDeclared) {
  const auto infos = parameter_table<Sample>().infos();
  ASSERT_EQ(infos.size(), 4U);
  EXPECT_EQ(infos[1].symbol, "M");
  EXPECT_EQ(infos[1].when, Change::program);
  EXPECT_EQ(std::get<std::int64_t>(infos[1].default_value), 4);
  EXPECT_EQ(infos[2].unit, "m");
  EXPECT_EQ(infos[3].choices, (std::vector<std::string>{"slow", "quick"}));
  EXPECT_EQ(std::get<std::string>(infos[3].default_value), "quick");
}

TEST(Parameters, AssignAndReadBack) {
  Sample sample;
  const ParameterRef ref = bind_parameters(sample);
  EXPECT_EQ(ref.assign("count", std::int64_t{7}, "sample"), Change::program);
  EXPECT_EQ(ref.assign("width", std::int64_t{1}, "sample"), Change::uniform);  // an integer where a real is asked for
  ref.assign("flag", false, "sample");
  ref.assign("mode", std::string("slow"), "sample");
  EXPECT_EQ(sample.count, 7);
  EXPECT_EQ(sample.width, 1.0F);
  EXPECT_FALSE(sample.flag);
  EXPECT_EQ(sample.mode, Mode::slow);
  EXPECT_EQ(to_text(ref.get("mode")), "slow");
  EXPECT_EQ(to_text(ref.get("count")), "7");
}

TEST(Parameters, ErrorsNameTheParameterItsRangeAndTheNearestName) {
  Sample sample;
  const ParameterRef ref = bind_parameters(sample);
  EXPECT_EQ(test::input_error([&] { ref.assign("cuont", std::int64_t{1}, "sample"); }),
            "unknown parameter 'cuont' of sample; did you mean 'count'?");
  EXPECT_EQ(test::input_error([&] { ref.assign("zzzzzz", std::int64_t{1}, "sample"); }),
            "unknown parameter 'zzzzzz' of sample; it has flag, count, width, mode");
  EXPECT_EQ(test::input_error([&] { ref.assign("count", std::int64_t{65}, "sample"); }),
            "sample: count = 65 is out of range [1, 64]");
  EXPECT_EQ(test::input_error([&] { ref.assign("count", 2.5, "sample"); }),
            "sample: count = 2.5 is not an integer in [1, 64]");
  EXPECT_EQ(test::input_error([&] { ref.assign("width", std::nan(""), "sample"); }),
            "sample: width = nan is out of range [0, 1]");
  EXPECT_EQ(test::input_error([&] { ref.assign("flag", std::int64_t{1}, "sample"); }),
            "sample: flag = 1 is not true or false");
  EXPECT_EQ(test::input_error([&] { ref.assign("mode", std::string("slwo"), "sample"); }),
            "sample: mode = 'slwo' is not one of slow, quick; did you mean 'slow'?");
  EXPECT_EQ(sample.count, 4) << "a refused value must not be stored";
}

TEST(Parameters, TextIsReadWholeOrRefused) {
  const ParameterTable& table = parameter_table<Sample>();
  const ParameterInfo& count = *table.find("count");
  EXPECT_EQ(std::get<std::int64_t>(parse_value(count, "12", "sample")), 12);
  for (const char* text : {"", "4x", "4.0", " 4", "0x4", "99999999999999999999"}) {
    EXPECT_NE(test::input_error([&] { parse_value(count, text, "sample"); }), "no error") << "'" << text << "'";
  }
  EXPECT_DOUBLE_EQ(std::get<double>(parse_value(*table.find("width"), "2.5e-1", "sample")), 0.25);
  EXPECT_EQ(test::input_error([&] { parse_value(*table.find("width"), "inf", "sample"); }),
            "sample: width = inf is out of range [0, 1]");
}

// A value that is written comes back, digit by digit, though the member is a float.
TEST(Parameters, FloatsReadBackAsWritten) {
  for (const char* text : {"0.1", "1e-05", "0.04", "123456.7", "0", "0.3333333"}) {
    const double written = std::stod(text);
    EXPECT_EQ(detail::nearest_decimal(static_cast<float>(written)), written) << text;
  }
}

}  // namespace
}  // namespace pellucid
