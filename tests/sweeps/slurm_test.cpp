#include "sweeps/cluster/slurm.hpp"

#include <cstdlib>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "tests/temporary_folder.hpp"

namespace pellucid::sweeps {
namespace {

SlurmOptions options(const std::filesystem::path& folder) {
  SlurmOptions o;
  o.folder = folder;
  o.program = "/opt/pell ucid/bin/pellucid";
  o.spec = "/home/me/it's.toml";
  o.name = "s";
  o.partition = "gpu";
  o.gpus_per_task = "a100:1";
  o.constraint = "a100";
  o.time = "01:00:00";
  o.shards = 16;
  o.at_once = 4;
  o.timed = o.untimed = o.metrics = true;
  o.sbatch = {"--mem=8G"};
  return o;
}

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(Slurm, WritesScriptsThatAShellCanRead) {
  const pellucid::test::TemporaryFolder folder;
  write_slurm_scripts(options(folder / "out"));
  for (const char* name : {"references.sbatch", "quality.sbatch", "timing.sbatch", "merge.sbatch", "submit.sh"}) {
    const std::string path = (folder / "out" / name).string();
    ASSERT_TRUE(std::filesystem::exists(path)) << name;
    EXPECT_EQ(std::system(("bash -n '" + path + "'").c_str()), 0) << name;
  }
  EXPECT_TRUE(std::filesystem::is_directory(folder / "out" / "shards"));
}

TEST(Slurm, TimingHasItsNodesToItselfAndQualityDoesNot) {
  const auto scripts = slurm_scripts(options("/shared/out"));
  const std::string& timing = scripts.at("timing.sbatch");
  const std::string& quality = scripts.at("quality.sbatch");
  for (const std::string* script : {&timing, &quality}) {
    for (const char* line : {"#SBATCH --array=1-16%4\n", "#SBATCH --requeue\n", "#SBATCH --partition=gpu\n",
                             "#SBATCH --gpus-per-task=a100:1\n", "#SBATCH --constraint=a100\n", "#SBATCH --mem=8G\n",
                             "#SBATCH --signal=B:USR1@120\n", "spec='/home/me/it'\\''s.toml'\n"})
      EXPECT_TRUE(has(*script, line)) << line;
  }
  EXPECT_TRUE(has(timing, "#SBATCH --exclusive\n"));
  EXPECT_FALSE(has(quality, "--exclusive"));
  EXPECT_TRUE(has(scripts.at("submit.sh"), "--dependency=afterany:$quality:$timing merge.sbatch"));
  EXPECT_TRUE(has(scripts.at("submit.sh"), "--dependency=afterany:$references timing.sbatch"));
}

/// The merge of a folder, run by a shell with stand-ins for Slurm's programs and for this one.
class SlurmMerge : public testing::Test {
 protected:
  SlurmMerge() {
    SlurmOptions o = options(folder / "out");
    o.shards = 2;
    o.untimed = false;
    o.program = (folder / "bin/pellucid").string();
    write_slurm_scripts(o);
    program("pellucid", "echo \"$1 $2\" >> " + told.string());
    program("sbatch", "echo sbatch \"$@\" >> " + told.string() + "; echo 77");
    program("squeue", "");
    folder.write("out/jobs", "timing 12\nmerge 13\n");
    for (const char* shard : {"1", "2"})
      folder.write(std::string("out/shards/timing-") + shard + ".db", "rows");
    folder.write("out/shards/timing-1.done", "");
  }
  void program(const std::string& name, const std::string& does) {
    folder.write("bin/" + name, "#!/bin/sh\n" + does + "\n");
    std::filesystem::permissions(folder / "bin" / name, std::filesystem::perms::owner_all);
  }
  /// Its exit status.
  int merge() {
    const std::string script = (folder / "out/merge.sbatch").string();
    const int status = std::system(("PATH='" + (folder / "bin").string() + "':$PATH bash '" + script + "' > '" +
                                    (folder / "words").string() + "' 2>&1")
                                       .c_str());
    return WEXITSTATUS(status);
  }
  std::string words() const { return pellucid::test::read_file(folder / "words"); }

  pellucid::test::TemporaryFolder folder;
  std::filesystem::path told = folder / "told";
};

TEST_F(SlurmMerge, JoinsAllAndNamesTheTasksThatAreNotDone) {
  EXPECT_EQ(merge(), 1);
  EXPECT_TRUE(has(words(), "points may be missing: timing-2\n")) << words();
  EXPECT_TRUE(has(pellucid::test::read_file(told), "sweep merge")) << "one lost task does not sink the rest";
  folder.write("out/shards/timing-2.done", "");
  EXPECT_EQ(merge(), 0);
}

TEST_F(SlurmMerge, WaitsAgainForATaskThatWasRequeuedAtItsEnd) {
  program("squeue", "echo 12_2");
  EXPECT_EQ(merge(), 0);
  EXPECT_TRUE(has(words(), "at work again: 12_2; ")) << words();
  EXPECT_EQ(pellucid::test::read_file(told), "sbatch --parsable --dependency=afterany:12 merge.sbatch\n");
  EXPECT_EQ(pellucid::test::read_file(folder / "out/jobs"), "timing 12\nmerge 77\n");
}

TEST(Slurm, LeavesOutWhatIsNotNeeded) {
  SlurmOptions o = options("/shared/out");
  o.untimed = o.metrics = false;
  const auto scripts = slurm_scripts(o);
  EXPECT_FALSE(scripts.contains("quality.sbatch"));
  EXPECT_FALSE(scripts.contains("references.sbatch"));
  EXPECT_FALSE(has(scripts.at("submit.sh"), "$references"));
}

}  // namespace
}  // namespace pellucid::sweeps
