// pellucid slab.
#include <cstddef>
#include <iterator>
#include <string>

#include <nlohmann/json.hpp>

#include "tests/sandbox/program.hpp"

namespace pellucid::test {
namespace {

using nlohmann::json;

TEST(SlabCommand, PrintsVanDeHulstsNumbers) {
  const Outcome outcome = pellucid({"slab", "--depth", "2", "--anisotropy", "0.75", "--albedo", "0.9", "--json"});
  ASSERT_TRUE(succeeded(outcome));
  const json out = json::parse(outcome.out);
  EXPECT_NEAR(out.at("reflectance").get<double>(), 0.09739, 1e-4);
  EXPECT_NEAR(out.at("transmittance").get<double>(), 0.66096, 1e-4);
  EXPECT_NEAR(out.at("unscattered").get<double>(), 0.135335, 1e-5);
  const double together = out.at("f_t").get<double>() + out.at("c_t").get<double>();
  EXPECT_NEAR(together, out.at("transmittance").get<double>(), 1e-9);
  for (const char* name : {"theta_bar_deg", "c_r", "fit_rms"})
    EXPECT_GT(out.at(name).get<double>(), 0) << name;
  for (const char* name : {"transmission", "reflection"}) {
    ASSERT_GE(out.at(name).size(), 16U);
    EXPECT_EQ(out.at(name)[0].at("angle_deg"), 0.0);
    EXPECT_GT(out.at(name)[0].at("radiance").get<double>(), 0.0);
  }
}

TEST(SlabCommand, RefusesWhatIsNoMedium) {
  const char* bad[][3] = {{"-1", "0.5", "0.5"}, {"nan", "0.5", "0.5"}, {"1", "1", "0.5"},
                          {"1", "0.5", "1.5"},  {"1", "0.5", "-0.1"},  {"1", "nan", "0.5"}};
  const char* named[] = {"depth", "depth", "anisotropy", "albedo", "albedo", "anisotropy"};
  for (std::size_t i = 0; i < std::size(bad); ++i) {
    const Outcome outcome = pellucid({"slab", std::string("--depth=") + bad[i][0],
                                      std::string("--anisotropy=") + bad[i][1], std::string("--albedo=") + bad[i][2]});
    EXPECT_TRUE(refused(outcome, 2, {named[i]}));
  }
}

}  // namespace
}  // namespace pellucid::test
