#include "sandbox/file_provenance.hpp"

#include <nlohmann/json.hpp>

#include "sandbox/arguments.hpp"
#include "sweeps/spec/clock.hpp"
#include "sweeps/spec/provenance.hpp"

namespace pellucid::sandbox {

using nlohmann::ordered_json;

ordered_json file_provenance() {
  return {{"version", PELLUCID_VERSION},
          {"commit", sweeps::kCommit},
          {"dirty", sweeps::kDirty},
          {"started_utc", sweeps::utc_text(sweeps::unix_now_s())},
          {"argv", process_arguments()}};
}

Attributes file_attributes(const char* command, const ordered_json& recipe, const ordered_json& origin) {
  return {{"pellucid.command", command}, {"pellucid.recipe", recipe.dump()}, {"pellucid.provenance", origin.dump()}};
}

}  // namespace pellucid::sandbox
