// ./bootstrap where it says what it would do, and does nothing.
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "tests/sandbox/program.hpp"

namespace pellucid::test {
namespace {

constexpr const char* kBootstrap = PELLUCID_SOURCE_DIR "/bootstrap";

Outcome bootstrap_on(std::string_view os_release, const std::vector<std::string>& verbs) {
  const TemporaryFolder folder;
  const auto path = write_file(folder / "os-release", os_release);
  std::vector<std::string> command{kBootstrap};
  command.insert(command.end(), verbs.begin(), verbs.end());
  return run(command, {.folder = folder.path(), .environment = {{"PELLUCID_OS_RELEASE", path.string()}}});
}

TEST(Bootstrap, HelpNamesEveryVerb) {
  const Outcome help = run({kBootstrap, "help"});
  ASSERT_TRUE(succeeded(help));
  for (const char* verb : {"\n  run ", "\n  test ", "\n  assets ", "\n  help "})
    EXPECT_NE(help.out.find(verb), std::string::npos) << verb;
}

TEST(Bootstrap, RefusesAnUnknownVerb) {
  const Outcome outcome = run({kBootstrap, "rnu"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_NE(outcome.err.find("error: unknown verb rnu"), std::string::npos) << outcome.err;
  EXPECT_EQ(run({kBootstrap, "run", "test"}).status, 2);
}

TEST(Bootstrap, NamesWhatToInstallElsewhere) {
  for (const char* verb : {"", "run", "test"}) {
    const Outcome outcome = bootstrap_on("NAME=\"Fedora Linux\"\nID=fedora\nVERSION_ID=41\n",
                                         *verb == '\0' ? std::vector<std::string>{} : std::vector<std::string>{verb});
    EXPECT_EQ(outcome.status, 1);
    EXPECT_EQ(outcome.out, "");
    EXPECT_TRUE(outcome.err.starts_with("error: ")) << outcome.err;
    for (const char* needed : {"fedora", "CMake", "EGL", "OpenEXR", "VTK", "Embree", "cmake --preset release"})
      EXPECT_NE(outcome.err.find(needed), std::string::npos) << needed << "\n" << outcome.err;
  }
}

TEST(Bootstrap, RefusesReleasesWithoutTheLibraries) {
  EXPECT_TRUE(refused(bootstrap_on("ID=debian\nVERSION_ID=\"11\"\n", {}), 1, {"debian 11", "Debian 12"}));
  EXPECT_TRUE(refused(bootstrap_on("ID=ubuntu\nID_LIKE=debian\nVERSION_ID=\"22.04\"\n", {"run"}), 1, {"Ubuntu 24.04"}));
}

TEST(Bootstrap, NamesEachToolThatIsTooOldAndBuildsNothing) {
  if (run({"sh", "-c", "command -v dpkg-query"}).status != 0) GTEST_SKIP() << "takes a Debian machine";
  const TemporaryFolder folder;
  std::filesystem::copy_file(kBootstrap, folder / "bootstrap");
  // Every package is installed, but an older compiler and CMake come first in the path.
  write_file(folder / "dpkg-query",
             "#!/bin/sh\nfor word; do case $word in -*) ;; *) echo $word installed;; esac; done\n");
  write_file(folder / "cmake", "#!/bin/sh\necho cmake version 3.18.4\n");
  write_file(folder / "old-g++", "#!/bin/sh\necho 10.2.1\n");
  const auto os_release = write_file(folder / "os-release", "ID=debian\nVERSION_ID=\"12\"\n");
  ASSERT_TRUE(succeeded(run({"chmod", "-R", "a+rx", folder.path().string()})));
  const Outcome outcome =
      run({"sh", "-c", "PATH='" + folder.path().string() + "':$PATH ./bootstrap"},
          {.folder = folder.path(), .environment = {{"PELLUCID_OS_RELEASE", os_release.string()}, {"CXX", "old-g++"}}});
  EXPECT_EQ(outcome.status, 1);
  EXPECT_EQ(outcome.err,
            "error: old-g++ 10.2.1 is too old: Pellucid needs 12 or newer\n"
            "error: cmake 3.18.4 is too old: Pellucid needs 3.25 or newer\n");
  EXPECT_FALSE(std::filesystem::exists(folder / "build"));
}

TEST(Bootstrap, TellsWhatIsMissingWithoutARightToInstall) {
  if (run({"id", "-u"}).out != "0\n") GTEST_SKIP() << "takes root, to become nobody";
  const TemporaryFolder folder;
  // A dpkg-query that knows of no package, and no sudo, for a user who is not root.
  write_file(folder / "dpkg-query", "#!/bin/sh\nexit 1\n");
  ASSERT_TRUE(succeeded(run({"chmod", "-R", "a+rx", folder.path().string()})));
  ASSERT_TRUE(succeeded(run({"sh", "-c",
                             "for t in bash cat dirname env grep head id sed sort tr; do ln -s $(command -v $t) '" +
                                 folder.path().string() + "/'; done"})));
  const Outcome outcome = run({"setpriv", "--reuid=65534", "--regid=65534", "--clear-groups", "env",
                               "PATH=" + folder.path().string(), "bash", kBootstrap});
  if (outcome.err.find("Permission denied") != std::string::npos) GTEST_SKIP() << "the tree is closed to others";
  EXPECT_EQ(outcome.status, 1);
  EXPECT_NE(outcome.err.find("neither root nor usable sudo"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("apt-get install --no-install-recommends g++ cmake"), std::string::npos) << outcome.err;
}

}  // namespace
}  // namespace pellucid::test
