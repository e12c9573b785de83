// Transfer functions that are kept in files.
#include "algorithms/raster/transfer_cache.hpp"

#include <chrono>
#include <cstring>
#include <filesystem>
#include <iterator>

#include <gtest/gtest.h>

#include "algorithms/scattering/transfer_table.hpp"
#include "tests/temporary_folder.hpp"

namespace pellucid {
namespace {

using namespace scattering;

TEST(TransferCache, KeepsTablesByWhatTheyAreOf) {
  const test::TemporaryFolder folder;
  const std::filesystem::path tables = folder.path() / "tables";
  const auto count = [&] { return std::distance(std::filesystem::directory_iterator(tables), {}); };
  const SlabMedium medium{0.8, 0.95};
  const TransferTable made = transfer_table(medium, TransferModel::gaussian, tables);
  const std::filesystem::path file = std::filesystem::directory_iterator(tables)->path();
  const auto long_ago = std::filesystem::last_write_time(file) - std::chrono::hours(1);
  std::filesystem::last_write_time(file, long_ago);
  const TransferTable kept = transfer_table(medium, TransferModel::gaussian, tables);
  ASSERT_EQ(kept.entries.size(), made.entries.size());
  EXPECT_EQ(std::memcmp(kept.entries.data(), made.entries.data(), made.entries.size() * sizeof(TransferFit)), 0);
  EXPECT_EQ(count(), 1);
  EXPECT_EQ(std::filesystem::last_write_time(file), long_ago) << "it was read";
  transfer_table(medium, TransferModel::unscattered, tables);
  transfer_table({0.8, 0.9501}, TransferModel::gaussian, tables);
  EXPECT_EQ(count(), 3);
  // A file that is damaged is made again.
  for (const auto& entry : std::filesystem::directory_iterator(tables))
    std::filesystem::resize_file(entry.path(), 1000);
  EXPECT_EQ(transfer_table(medium, TransferModel::gaussian, tables).at(0.5).f_t, made.at(0.5).f_t);
}

}  // namespace
}  // namespace pellucid
