#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

struct sqlite3;
struct sqlite3_stmt;

/// The little of SQLite that the store needs, as move-only values whose errors are exceptions. For store.cpp alone.
namespace pellucid::sweeps {

class Statement;

/// An open database. Errors name the file: InputError when it is missing, is no database or is damaged, RuntimeError
/// when the disk is full, the file is locked or cannot be written.
class Database {
 public:
  enum class Mode { read, create };
  Database(const std::filesystem::path&, Mode);
  ~Database();
  Database(Database&&) noexcept;
  Database& operator=(Database&&) noexcept;

  void run(const std::string& sql);
  Statement prepare(std::string_view sql) const;
  /// First column of the first row; 0 without one.
  std::int64_t integer(std::string_view sql) const;
  [[noreturn]] void fail(int code) const;
  sqlite3* handle() const { return handle_; }

 private:
  void open(const std::string& uri, int flags);
  void open_for_reading();
  std::filesystem::path path_;
  sqlite3* handle_ = nullptr;
};

/// A prepared statement: bind by 1-based index, step, read by 0-based column.
class Statement {
 public:
  Statement(const Database&, std::string_view sql);
  ~Statement();
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;

  Statement& bind(int index, std::string_view text);
  Statement& bind(int index, std::int64_t value);
  Statement& bind(int index, double value);
  /// As little-endian float64, on any machine.
  Statement& bind(int index, std::span<const double> blob);
  /// False when there are no more rows.
  bool step();
  void reset();

  std::string text(int column) const;
  std::int64_t integer(int column) const;
  double real(int column) const;
  void read(int column, std::span<double> out) const;
  std::size_t bytes(int column) const;

 private:
  const Database& database_;
  sqlite3_stmt* handle_ = nullptr;
};

/// Commits when told, else rolls back.
class Transaction {
 public:
  explicit Transaction(Database&);
  ~Transaction();
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;
  void commit();

 private:
  Database& database_;
  bool open_ = true;
};

}  // namespace pellucid::sweeps
