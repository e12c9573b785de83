#include <string>

#include <gtest/gtest.h>

#include "tests/sweeps/fake_known_names.hpp"

namespace pellucid::sweeps::test {

bool lacks_assets(const std::string& spec) {
  try {
    load_spec(spec);
    return false;
  } catch (const InputError& e) {
    if (std::string(e.what()).find("./bootstrap assets") == std::string::npos) throw;
    return true;
  }
}

}  // namespace pellucid::sweeps::test
