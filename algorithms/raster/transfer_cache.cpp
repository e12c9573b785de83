#include "algorithms/raster/transfer_cache.hpp"

#include <cstddef>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "algorithms/scene/files/cache_file.hpp"
#include "algorithms/scene/files/hash.hpp"
#include "gl/error.hpp"

namespace pellucid {
namespace {

using scattering::TransferTable;

/// Raise it when what is computed or how it is written changes.
constexpr int kTableVersion = 1;

std::string table_key(const scattering::SlabMedium& medium, scattering::TransferModel model) {
  Sha256 hash;
  hash.add(fmt::format("{} {} {} {} {} {}", kTableVersion, TransferTable::kEntries, TransferTable::kHalfDepth,
                       medium.anisotropy, medium.albedo, static_cast<int>(model)));
  return hash.hex();
}

}  // namespace

TransferTable transfer_table(const scattering::SlabMedium& medium, scattering::TransferModel model,
                             const std::filesystem::path& folder) {
  if (folder.empty()) return TransferTable(medium, model);
  const std::string key = table_key(medium, model);
  const CacheFile file{folder / (key + ".table"), "transfer functions", key};
  std::vector<scattering::TransferFit> entries;
  const auto unpack = [&](std::span<const std::byte> bytes) {
    ByteReader in(bytes);
    in.take(entries);
    if (entries.size() != TransferTable::kEntries || !in.done()) throw InputError("it has another number of entries");
  };
  if (file.read(unpack)) return TransferTable(std::move(entries));
  TransferTable table(medium, model);
  ByteWriter out;
  out.add(table.entries);
  file.keep(out.bytes());
  return table;
}

}  // namespace pellucid
