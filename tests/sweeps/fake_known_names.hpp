#pragma once

#include <algorithm>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "gl/error.hpp"
#include "sweeps/spec/known_names.hpp"
#include "sweeps/spec/plan.hpp"
#include "sweeps/spec/spec.hpp"
#include "tests/input_error.hpp"
#include "tests/temporary_folder.hpp"

/// Techniques and scenes that need no GL: what specs, plans and sweeps are tested with.
namespace pellucid::sweeps::test {

struct Technique {
  int hulls = 4;
  int samples = 8;
  double offset = 0;
  bool filter = false;
  enum class Format { automatic, unorm8, single } format = Format::automatic;
  static constexpr void parameters(auto& self, auto&& visit) {
    visit(PARAM(hulls), {.range = {1, 64}, .cite = "test", .doc = "a uniform"});
    visit(PARAM(samples), {.range = {1, 256}, .cite = "test", .doc = "a define", .when = Change::program});
    visit(PARAM(offset), {.range = {0, 1}, .cite = "test", .doc = "a real"});
    visit(PARAM(filter), {.cite = "test", .doc = "a switch"});
    visit(PARAM(format),
          {.cite = "test", .doc = "a format", .when = Change::precompute, .choices = "automatic|unorm8|single"});
  }
};
static_assert(well_formed<Technique>());

/// The fake worker's action on the point (fake_worker.cpp).
struct Faulty {
  enum class Does {
    good,
    fail,
    crash,
    abort,
    hang,
    nan,
    garbage,
    truncate,
    leave,
    unconverged,
    stop,
    killed
  } does = Does::good;
  int n = 0;
  int sleep_ms = 0;
  int frames = 30;
  static constexpr void parameters(auto& self, auto&& visit) {
    visit(PARAM(does), {.cite = "test",
                        .doc = "how the worker ends",
                        .choices = "good|fail|crash|abort|hang|nan|garbage|truncate|leave|unconverged|stop|killed"});
    visit(PARAM(n), {.range = {0, 100000}, .cite = "test", .doc = "tells points apart"});
    visit(PARAM(sleep_ms), {.range = {0, 10000}, .cite = "test", .doc = "how long it takes"});
    visit(PARAM(frames), {.range = {1, 1000000}, .cite = "test", .doc = "samples it sends"});
  }
};
static_assert(well_formed<Faulty>());

struct SceneParameters {
  double density = 1;
  static constexpr void parameters(auto& self, auto&& visit) {
    visit(PARAM(density), {.range = {0, 10}, .cite = "test", .doc = "of the fog"});
  }
};

class FakeKnownNames final : public KnownNames {
 public:
  std::string code = "code 1";
  SceneFacts forest{"hash of the forest", {"front", "inside"}, infos<SceneParameters>()};
  SceneFacts ball{"hash of the ball", {"near"}, infos<SceneParameters>()};

  std::vector<std::string> techniques() const override { return {"hulls", "slices", "faulty"}; }
  std::vector<ParameterInfo> technique_parameters(std::string_view name) const override {
    if (name == "hulls" || name == "slices") return infos<Technique>();
    if (name == "faulty") return infos<Faulty>();
    throw InputError("unknown technique '" + std::string(name) + "'");
  }
  std::string code_hash(std::string_view name) const override { return code + " of " + std::string(name); }
  const SceneFacts& scene(const std::string& name) const override {
    if (name == "forest") return forest;
    if (name == "ball" || name.ends_with("ball.toml")) return ball;
    throw InputError("unknown scene '" + name + "'");
  }

 private:
  template <class T>
  static std::vector<ParameterInfo> infos() {
    const auto table = parameter_table<T>().infos();
    return {table.begin(), table.end()};
  }
};

using pellucid::test::input_error;
using pellucid::test::TemporaryFolder;

/// True if a built-in spec cannot be read because its scenes' assets have not been fetched.
bool lacks_assets(const std::string& spec);

}  // namespace pellucid::sweeps::test
