#pragma once

#include <string>

#include <gtest/gtest.h>

#include "gl/error.hpp"

namespace pellucid::test {

/// The message of the InputError that `f` throws; fails the test where none is thrown.
std::string input_error(auto&& f) {
  try {
    f();
  } catch (const InputError& e) {
    return e.what();
  }
  ADD_FAILURE() << "no InputError";
  return "";
}

}  // namespace pellucid::test
