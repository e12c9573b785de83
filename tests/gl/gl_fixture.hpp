#pragma once

#include <cstdlib>
#include <exception>
#include <functional>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "gl/context.hpp"
#include "gl/error.hpp"
#include "tests/temporary_folder.hpp"

namespace pellucid::gl::test {

/// One context for all tests of a process; each starts with it current and must leave no error and no memory behind.
class GlTest : public testing::Test {
 protected:
  void SetUp() override {
    context().make_current();
    bytes_before_ = allocated_bytes();
  }
  void TearDown() override {
    EXPECT_NO_THROW(check("end", "test"));
    EXPECT_EQ(allocated_bytes(), bytes_before_);
  }
  static Context& context() {
    static Context shared;
    return shared;
  }

 private:
  std::size_t bytes_before_ = 0;
};

/// The message of the `Error` that `work` must throw.
template <class Error>
std::string message_of(const std::function<void()>& work) {
  try {
    work();
  } catch (const Error& error) {
    return error.what();
  } catch (const std::exception& error) {
    ADD_FAILURE() << "threw another kind of error: " << error.what();
    return {};
  }
  ADD_FAILURE() << "threw nothing";
  return {};
}

inline bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

using pellucid::test::TemporaryFolder;

/// Sets an environment variable for the length of a scope.
class ScopedEnvironment {
 public:
  ScopedEnvironment(std::string name, const std::string& value) : name_(std::move(name)) {
    if (const char* old = std::getenv(name_.c_str())) {
      had_value_ = true;
      old_ = old;
    }
    setenv(name_.c_str(), value.c_str(), 1);
  }
  ~ScopedEnvironment() {
    if (had_value_)
      setenv(name_.c_str(), old_.c_str(), 1);
    else
      unsetenv(name_.c_str());
  }
  ScopedEnvironment(const ScopedEnvironment&) = delete;
  ScopedEnvironment& operator=(const ScopedEnvironment&) = delete;

 private:
  std::string name_, old_;
  bool had_value_ = false;
};

}  // namespace pellucid::gl::test
