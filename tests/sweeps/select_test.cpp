#include "sweeps/store/select.hpp"

#include <cstddef>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/sweeps/fake_known_names.hpp"

namespace pellucid::sweeps {
namespace {

using nlohmann::json;
using test::input_error;

const std::vector<json> kRows{{{"hulls", 2}, {"technique", "a"}, {"scene.density", 0.9}, {"pass_ms", {{"fog", 1.5}}}},
                              {{"hulls", 4}, {"technique", "b"}, {"scene.density", 1.0}},
                              {{"hulls", 16}, {"technique", "c"}}};

std::size_t count(const std::vector<std::string>& texts) {
  std::vector<RowCondition> conditions;
  for (const std::string& text : texts)
    conditions.push_back(parse_row_condition(text));
  return select_rows(kRows, conditions).size();
}

TEST(SelectRows, ComparesNumbersAsNumbers) {
  EXPECT_EQ(count({"hulls=4"}), 1U);
  EXPECT_EQ(count({"hulls=4.0"}), 1U);
  EXPECT_EQ(count({"hulls!=4"}), 2U);
  EXPECT_EQ(count({"hulls>=4"}), 2U);
  EXPECT_EQ(count({"hulls>4"}), 1U);
  EXPECT_EQ(count({"hulls<=4", "technique!=a"}), 1U);
  EXPECT_EQ(count({"scene.density=0.9"}), 1U);
  EXPECT_EQ(count({"scene.density<2"}), 2U);
  EXPECT_EQ(count({"scene.density!=0.9"}), 2U);
  EXPECT_EQ(count({"pass_ms.fog>1"}), 1U);
  EXPECT_EQ(count({"technique=b"}), 1U);
  EXPECT_EQ(input_error([] { count({"hulls=many"}); }), "'hulls' holds numbers; 'many' is no finite number");
  EXPECT_EQ(input_error([] { count({"scene.density<nan"}); }),
            "'scene.density' holds numbers; 'nan' is no finite number");
}

TEST(SelectRows, ErrorsSayWhatIsMeant) {
  EXPECT_EQ(input_error([] { count({"hull=4"}); }), "no row has a field 'hull'; did you mean 'hulls'?");
  EXPECT_NE(input_error([] { count({"hulls"}); }).find("is not field=value"), std::string::npos);
  EXPECT_NE(input_error([] { count({"=4"}); }).find("is not field=value"), std::string::npos);
  EXPECT_EQ(input_error([] {
              select_fields(kRows, {"hulls", "techniqe"});
            }),
            "no row has a field 'techniqe'; did you mean 'technique'?");
}

TEST(SelectFields, KeepsTheirOrder) {
  EXPECT_EQ(select_fields(kRows, {"technique", "pass_ms.fog", "hulls"})[0].dump(),
            R"({"technique":"a","pass_ms.fog":1.5,"hulls":2})");
  EXPECT_EQ(select_fields(kRows, {"scene.density"})[2].dump(), R"({"scene.density":null})");
}

}  // namespace
}  // namespace pellucid::sweeps
