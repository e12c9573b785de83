#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "sweeps/store/store.hpp"
#include "tests/sweeps/fake_known_names.hpp"

/// A small plan and a store of one row.
namespace pellucid::sweeps::test {

inline const char* const kSpec =
    "name='s'\n[[run]]\nname='a'\ntechniques=['hulls']\nscenes=['forest']\nbaseline=true\n[run.axes]\nhulls=[1,2]\n"
    "[[run]]\nname='b'\ntechniques=['hulls']\nscenes=['forest']\n[run.axes]\nhulls=[2,3]\n";

struct Example {
  FakeKnownNames known_names;
  Spec spec = parse_spec(kSpec, "s.toml", known_names);
  Plan plan = make_plan(spec, known_names);
};

inline nlohmann::json row_of(const std::string& status, double timed_unix_s) {
  return {{"status", status},
          {"hulls", 2},
          {"timing", "converged"},
          {"frame_ms_median", 0.1},
          {"timed_unix_s", timed_unix_s},
          {"done_unix_s", timed_unix_s + 1},
          {"device", "d"},
          {"driver", "v"},
          {"commit", "c"},
          {"wall_s", 2.5},
          {"pass_ms", {{"back", 0.05}}}};
}

inline void fill(const std::filesystem::path& path, const Example& e) {
  Store store(path, Access::write);
  store.put_plan(e.spec, e.plan);
  store.put_row(e.plan.points[1].id, row_of("ok", 150), std::vector<double>{0.1, 0.2, 1.0 / 3});
}

}  // namespace pellucid::sweeps::test
