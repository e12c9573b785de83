#include <gtest/gtest.h>

#include "tests/sweeps/fake_catalogue.hpp"

namespace pellucid::sweeps::test {

std::string input_error(const std::function<void()>& f) {
  try {
    f();
  } catch (const InputError& e) {
    return e.what();
  }
  ADD_FAILURE() << "no InputError";
  return "";
}

}  // namespace pellucid::sweeps::test
