#include "sweeps/store/sqlite.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cstddef>
#include <cstring>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <sqlite3.h>

#include "gl/error.hpp"

namespace pellucid::sweeps {

Database::Database(const std::filesystem::path& path, Mode mode) : path_(path) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) {
    throw InputError(fmt::format("store '{}' is a folder", path.string()));
  }
  if (mode == Mode::create) {
    open(path.string(), SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE);
    // SQLite opens a file that it may not write for reading, and says so at the first write only.
    if (sqlite3_db_readonly(handle_, "main") == 1) {
      sqlite3_close(std::exchange(handle_, nullptr));
      throw RuntimeError(fmt::format("store '{}' cannot be written: the file is read-only", path.string()));
    }
    return;
  }
  if (!std::filesystem::exists(path, error)) {
    throw InputError(fmt::format("store '{}' does not exist", path.string()));
  }
  try {
    open_for_reading();
  } catch (...) {  // no destructor runs for what is not yet constructed
    sqlite3_close(handle_);
    throw;
  }
}

void Database::open_for_reading() {
  // Able to write where it may, so that the last to close tidies the log away; the rows are safe from it.
  open(path_.string(), SQLITE_OPEN_READWRITE);
  sqlite3_exec(handle_, "PRAGMA query_only = 1", nullptr, nullptr, nullptr);
  // A WAL database in a folder that cannot be written gets no shared memory; without a log there is nothing to share.
  const int code = sqlite3_exec(handle_, "SELECT count(*) FROM sqlite_master", nullptr, nullptr, nullptr);
  if (code == SQLITE_OK) return;
  const bool unwritable = code == SQLITE_CANTOPEN || code == SQLITE_READONLY;
  std::error_code error;
  if (!unwritable) fail(code);
  if (std::filesystem::exists(path_.string() + "-wal", error)) {
    throw RuntimeError(fmt::format(
        "store '{0}' has rows in its log, {0}-wal, which only a program that may write their folder can read; "
        "copy both files to another folder",
        path_.string()));
  }
  std::string uri = "file:";
  for (const char c : std::filesystem::absolute(path_).string()) {
    uri += c == '?' || c == '#' || c == '%' ? fmt::format("%{:02x}", static_cast<unsigned>(c)) : std::string(1, c);
  }
  sqlite3_close(std::exchange(handle_, nullptr));
  open(uri + "?immutable=1", SQLITE_OPEN_READONLY | SQLITE_OPEN_URI);
}

void Database::open(const std::string& uri, int flags) {
  const int code = sqlite3_open_v2(uri.c_str(), &handle_, flags, nullptr);
  if (code != SQLITE_OK) {
    sqlite3_close(std::exchange(handle_, nullptr));
    throw RuntimeError(fmt::format("store '{}' cannot be opened: {}", path_.string(), sqlite3_errstr(code)));
  }
  sqlite3_busy_timeout(handle_, 10'000);
}

Database::~Database() {
  sqlite3_close(handle_);
}
Database::Database(Database&& other) noexcept
    : path_(std::move(other.path_)), handle_(std::exchange(other.handle_, nullptr)) {}
Database& Database::operator=(Database&& other) noexcept {
  std::swap(path_, other.path_);
  std::swap(handle_, other.handle_);
  return *this;
}

void Database::fail(int code) const {
  const std::string where = fmt::format("store '{}'", path_.string());
  const char* words = handle_ != nullptr ? sqlite3_errmsg(handle_) : sqlite3_errstr(code);
  switch (code & 0xff) {
    case SQLITE_NOTADB:
      throw InputError(where + " is not a Pellucid store");
    case SQLITE_CORRUPT:
      throw InputError(fmt::format("{} is damaged: {}", where, words));
    case SQLITE_FULL:
    case SQLITE_IOERR:
      throw RuntimeError(
          fmt::format("{} cannot be written: {}; is the disk full? Rows stored so far stay", where, words));
    case SQLITE_READONLY:
      throw RuntimeError(fmt::format("{} cannot be written: {}", where, words));
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      throw RuntimeError(where + " is locked by another program");
    default:
      throw RuntimeError(fmt::format("{}: {}", where, words));
  }
}

void Database::run(const std::string& sql) {
  const int code = sqlite3_exec(handle_, sql.c_str(), nullptr, nullptr, nullptr);
  if (code != SQLITE_OK) fail(code);
}

Statement Database::prepare(std::string_view sql) const {
  return Statement(*this, sql);
}

std::int64_t Database::integer(std::string_view sql) const {
  Statement statement(*this, sql);
  return statement.step() ? statement.integer(0) : 0;
}

Statement::Statement(const Database& database, std::string_view sql) : database_(database) {
  const int code = sqlite3_prepare_v2(database.handle(), sql.data(), static_cast<int>(sql.size()), &handle_, nullptr);
  if (code != SQLITE_OK) database.fail(code);
}

Statement::~Statement() {
  sqlite3_finalize(handle_);
}

Statement& Statement::bind(int index, std::string_view text) {
  const int code = sqlite3_bind_text64(handle_, index, text.data(), text.size(), SQLITE_TRANSIENT, SQLITE_UTF8);
  if (code != SQLITE_OK) database_.fail(code);
  return *this;
}

Statement& Statement::bind(int index, std::int64_t value) {
  const int code = sqlite3_bind_int64(handle_, index, value);
  if (code != SQLITE_OK) database_.fail(code);
  return *this;
}

Statement& Statement::bind(int index, double value) {
  const int code = sqlite3_bind_double(handle_, index, value);
  if (code != SQLITE_OK) database_.fail(code);
  return *this;
}

namespace {

/// Turns float64 between this machine's byte order and the store's.
[[maybe_unused]] void swap_bytes(std::span<double> values) {
  for (double& value : values) {
    auto bytes = std::bit_cast<std::array<std::byte, sizeof(double)>>(value);
    std::reverse(bytes.begin(), bytes.end());
    value = std::bit_cast<double>(bytes);
  }
}

}  // namespace

Statement& Statement::bind(int index, std::span<const double> blob) {
  if constexpr (std::endian::native == std::endian::big) {
    std::vector<double> swapped(blob.begin(), blob.end());
    swap_bytes(swapped);
    const int code = sqlite3_bind_blob64(handle_, index, swapped.data(), blob.size_bytes(), SQLITE_TRANSIENT);
    if (code != SQLITE_OK) database_.fail(code);
    return *this;
  }
  const void* data = blob.empty() ? "" : static_cast<const void*>(blob.data());
  const int code = sqlite3_bind_blob64(handle_, index, data, blob.size_bytes(), SQLITE_TRANSIENT);
  if (code != SQLITE_OK) database_.fail(code);
  return *this;
}

bool Statement::step() {
  const int code = sqlite3_step(handle_);
  if (code == SQLITE_ROW) return true;
  if (code != SQLITE_DONE) database_.fail(code);
  return false;
}

void Statement::reset() {
  sqlite3_reset(handle_);
  sqlite3_clear_bindings(handle_);
}

std::string Statement::text(int column) const {
  const auto* data = reinterpret_cast<const char*>(sqlite3_column_text(handle_, column));
  return data == nullptr ? std::string{} : std::string(data, bytes(column));
}

std::int64_t Statement::integer(int column) const {
  return sqlite3_column_int64(handle_, column);
}
double Statement::real(int column) const {
  return sqlite3_column_double(handle_, column);
}

std::size_t Statement::bytes(int column) const {
  return static_cast<std::size_t>(sqlite3_column_bytes(handle_, column));
}

void Statement::read(int column, std::span<double> out) const {
  assert(out.size_bytes() <= bytes(column));
  if (!out.empty()) std::memcpy(out.data(), sqlite3_column_blob(handle_, column), out.size_bytes());
  if constexpr (std::endian::native == std::endian::big) swap_bytes(out);
}

Transaction::Transaction(Database& database) : database_(database) {
  database_.run("BEGIN IMMEDIATE");
}

Transaction::~Transaction() {
  if (open_) sqlite3_exec(database_.handle(), "ROLLBACK", nullptr, nullptr, nullptr);
}

void Transaction::commit() {
  database_.run("COMMIT");
  open_ = false;
}

}  // namespace pellucid::sweeps
