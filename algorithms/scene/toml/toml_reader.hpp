#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <glm/glm.hpp>

#include "gl/error.hpp"

namespace toml {
inline namespace v3 {
class node;
class table;
}  // namespace v3
}  // namespace toml

/// Reading a TOML file key by key: each value is checked once, where it is read. In a scene a number is from then on
/// known by its dotted path to the scene's parameters. Every error is an InputError "file:line:column: message".
namespace pellucid {

/// A line and column of a text file, 1-based.
struct FilePosition {
  int line = 0;
  int column = 0;
};
FilePosition place_of(const toml::node&);
/// The name of its kind, for an error: "a table", "a string" and so on.
std::string_view type_name(const toml::node&);

/// The name of the file, as errors show it.
struct TomlFile {
  std::string shown;
  InputError error(FilePosition, std::string_view message) const;
};

/// The text of a regular file of at most so many bytes. Throws InputError "cannot read WHAT 'PATH': reason".
std::string read_toml_text(const std::string& path, std::string_view what, std::uintmax_t most_bytes);
/// Throws InputError with the place of what is no TOML.
std::shared_ptr<toml::table> parse_toml(std::string_view text, const TomlFile&);

/// Inclusive, unless `above_min`.
struct NumberRange {
  double min = 0;
  double max = 0;
  bool above_min = false;
  bool contains(double v) const { return v <= max && (above_min ? v > min : v >= min); }
  std::string text() const;
};
inline constexpr NumberRange kCoordinate{-1e6, 1e6};
inline constexpr NumberRange kLength{1e-6, 1e6};
inline constexpr NumberRange kShare{0, 1};
inline constexpr NumberRange kRefractiveIndex{0.2, 5};
inline constexpr NumberRange kRadiance{0, 1e9};
inline constexpr NumberRange kAngleDeg{-36000, 36000};

/// The parts of a scene that are evaluated separately, in this order.
enum class Part {
  mesh,
  forest,
  material,
  relief_maps,
  relief,
  instance,
  light,
  view,
  voxels,
  scattering,
  transfer,
  medium,
  environment,
  ambient
};
struct Affected {
  Part part = Part::ambient;
  std::size_t index = 0;
  auto operator<=>(const Affected&) const = default;
};

/// Numbers of the description that a parameter may drive, under the dotted path that the file gives them.
struct DriveTarget {
  std::string path;
  std::vector<double*> numbers;  ///< one, or all components of a vector
  NumberRange range;
  bool integer = false;
  bool given = false;  ///< by the file, at `place`; else the default
  FilePosition place;
  Affected affected;
  std::vector<Affected> also;  ///< what else changes, as a volume that follows a light
};

enum class Need { optional, required };

/// One table of the file. Keys that are never asked for are errors: call finish() at the end.
class TableReader {
 public:
  TableReader(const TomlFile& file, const toml::table& table, std::string path, std::vector<DriveTarget>& targets)
      : file_(&file), table_(&table), path_(std::move(path)), targets_(&targets) {}
  /// For a file whose numbers no parameter drives.
  TableReader(const TomlFile& file, const toml::table& table, std::string path = "")
      : file_(&file), table_(&table), path_(std::move(path)) {}

  /// The part that changes when a number read from now on changes; nothing: parameters cannot drive it.
  void set_affected(std::optional<Affected> affected) { affected_ = affected; }

  bool has(std::string_view key) const;
  FilePosition place() const { return place_of_table(); }
  FilePosition place(std::string_view key) const;         ///< of the key's value; of the table without it
  FilePosition place_of_key(std::string_view key) const;  ///< of the key itself, which must be there
  const std::string& path() const { return path_; }

  void number(std::string_view key, double& value, NumberRange, Need = Need::optional);
  void integer(std::string_view key, double& value, NumberRange, Need = Need::optional);
  /// [x, z]: on the ground.
  void vector(std::string_view key, glm::dvec2& value, NumberRange, Need = Need::optional);
  void vector(std::string_view key, glm::dvec3& value, NumberRange, Need = Need::optional);
  /// [r, g, b], or one number for gray.
  void color(std::string_view key, glm::dvec3& value, NumberRange, Need = Need::optional);
  /// [x, y, z], or one number for all three.
  void extent(std::string_view key, glm::dvec3& value, NumberRange, bool integers, Need = Need::optional);
  /// [min, max]
  void pair(std::string_view key, glm::dvec2& value, NumberRange, bool integers, Need = Need::optional);
  /// [[x, y, z], …]: one to `most` points, which drives know as key[0].x and so on. `values` must keep its size.
  void points(std::string_view key, std::vector<glm::dvec3>& values, NumberRange, std::size_t most);
  /// A count that no parameter drives.
  void integer(std::string_view key, int& value, int min, int max, Need = Need::optional);
  void boolean(std::string_view key, bool& value);
  void text(std::string_view key, std::string& value, Need = Need::optional);
  /// A text that is one of `choices`; returns its position.
  std::size_t choice(std::string_view key, std::initializer_list<std::string_view> choices, std::size_t otherwise);
  std::vector<std::pair<std::string, FilePosition>> texts(std::string_view key, Need = Need::optional);
  /// The value itself, for what the calls above do not read; null when it is absent.
  const toml::node* node(std::string_view key, Need need = Need::optional) { return find(key, need); }
  /// Every key, in the order of the file.
  std::vector<std::string> keys() const;

  std::optional<TableReader> table(std::string_view key);
  /// The tables in a table, named, in the order of the file.
  std::vector<std::pair<std::string, TableReader>> named_tables(std::string_view key);
  std::vector<TableReader> tables(std::string_view key, Need = Need::optional);  ///< an array of tables

  /// Complains at `place` about a value that is none of `names`: "unknown WHAT 'value'; did you mean …?".
  void one_of(FilePosition place, std::string_view what, std::string_view value,
              std::span<const std::string> names) const;

  void require(std::string_view key);
  /// Not both.
  void exclude(std::string_view key, std::string_view other);
  void finish();

  [[noreturn]] void fail(FilePosition, std::string_view message) const;
  /// "path.key: message"
  [[noreturn]] void fail(std::string_view key, std::string_view message) const;

 private:
  FilePosition place_of_table() const;
  std::string dotted(std::string_view key) const;
  const toml::node* find(std::string_view key, Need);
  double scalar(const toml::node&, const std::string& shown, NumberRange, bool integer) const;
  TableReader inner(const toml::table& table, std::string path) const;
  void components(std::string_view key, double* values, std::size_t count, NumberRange, bool integer, bool one_for_all,
                  std::string_view names, Need);
  void components(const std::string& shown, const toml::node*, double* values, std::size_t count, NumberRange,
                  bool integer, bool one_for_all, std::string_view names);
  void add_target(std::string path, std::vector<double*> numbers, NumberRange, bool integer, const toml::node*);

  const TomlFile* file_;
  const toml::table* table_;
  std::string path_;
  std::vector<DriveTarget>* targets_ = nullptr;
  std::optional<Affected> affected_;
  std::vector<std::string> asked_;
};

/// Names of things in a scene: lower-case letters, digits and underscores, a letter first.
bool is_name(std::string_view);

}  // namespace pellucid
