#pragma once

#include <cstddef>
#include <filesystem>
#include <iterator>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

#include "gl/error.hpp"
#include "tests/temporary_folder.hpp"

namespace pellucid::test {

/// A fixture with an empty folder of its own.
class FolderTest : public ::testing::Test {
 protected:
  std::filesystem::path file(std::string_view name) const { return folder_ / name; }
  std::filesystem::path write(std::string_view name, std::string_view content) const {
    return folder_.write(name, content);
  }
  static std::string content(const std::filesystem::path& path) { return read_file(path); }
  std::size_t files() const {
    return static_cast<std::size_t>(
        std::distance(std::filesystem::directory_iterator(folder_.path()), std::filesystem::directory_iterator()));
  }

  TemporaryFolder folder_;
};

/// The message of the `Error` that `work` throws; empty, and a failure, when it throws none.
template <class Error = InputError, class Work>
std::string message_of(Work&& work) {
  try {
    work();
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << "more than one line";
    return error.what();
  }
  ADD_FAILURE() << "no error was thrown";
  return {};
}

}  // namespace pellucid::test
