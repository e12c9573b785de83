#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <utility>

#include <nlohmann/json_fwd.hpp>

#include "sweeps/spec/plan.hpp"
#include "sweeps/store/sqlite.hpp"
#include "sweeps/store/store.hpp"

/// The tables of a store. For the room store/ alone.
namespace pellucid::sweeps {

/// Makes an empty database a store.
void create_schema(Database&);
/// Throws InputError unless it is a store whose version this program reads.
void check_schema(const Database&, const std::filesystem::path&);
/// Brings a store of an earlier version up to this one, in one transaction.
void migrate_schema(Database&);
/// Lets a store of an earlier version be read as one of this, without changing it.
void present_as_current(Database&);

/// Keeps the tables `columns` and the view `results` in step with the rows: a typed column for each field.
class ResultsView {
 public:
  explicit ResultsView(Database& database) : database_(database) {}
  // Within a transaction each.
  /// Notes what the plan's parameters mean.
  void describe(const Plan&);
  void describe(const std::string& name, const std::string& type, const std::string& kind, const std::string& unit,
                const std::string& description);
  /// The meaning of the columns of results, for those that come later.
  void explain(std::map<std::string, ColumnMeaning> meanings) { meanings_ = std::move(meanings); }
  /// Adds the columns that are new with this row.
  void add(const nlohmann::json& row);
  /// Makes the view anew if a column has been added or has changed.
  void write_view();

 private:
  void load();
  std::string definition() const;
  /// That of a column; an object's member has that of the object and its own name.
  ColumnMeaning meaning(const std::string& name) const;
  void note(const std::string& name, const nlohmann::json& value);
  Database& database_;
  bool loaded_ = false;
  bool stale_ = false;
  std::map<std::string, std::string> known_;  // type by name
  std::map<std::string, ColumnMeaning> meanings_;
};

}  // namespace pellucid::sweeps
