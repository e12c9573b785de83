#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "algorithms/scene/toml/toml_reader.hpp"
#include "sweeps/quantities/quantities.hpp"

/// A paper as data: what is known of it besides its technique. A built-in one is the embedded
/// algorithms/NAME/paper.toml, a user's is any file of the same format (sweeps/README.md). This reads the file's head;
/// the tables, figures and pictures in it are read by their own engines (sweeps/tables, plots).
namespace pellucid::sweeps {

/// A sweep that measures the paper's rows.
struct PaperSweep {
  std::string spec;  ///< what load_spec takes: an embedded spec's name, or a path
  std::string name;  ///< what its rows carry as `sweep`
};

struct Paper {
  std::string name;  ///< snake_case: the module's folder, or a file's `name` (default: the file's, without .toml)
  std::string title;
  std::string citation;  ///< key in references.bib; empty in a user's file that names none
  std::string source;    ///< "Imagire et al. 2007", for captions
  std::string machine;   ///< the authors': "GeForce 7800 GTX, 720 × 540"
  std::vector<PaperSweep> sweeps;
  std::vector<std::string> colours;  ///< techniques in the order of the palette, for all figures
  std::vector<Quantity> quantities;  ///< of this paper alone: worked out from others
  bool built_in = false;
  TomlFile file;  ///< a path, or the resource's name
  std::shared_ptr<const toml::table> document;

  /// The whole file, for the engine that reads a section of it. Its head has been checked.
  TableReader read() const { return {file, *document}; }
  /// A quantity of this paper or declared for all; throws InputError with the nearest name.
  const Quantity& quantity(std::string_view name) const;
  const Quantity* find_quantity(std::string_view name) const;
  /// How the command line calls an entry of it: "PAPER.table1", "my.toml:table1".
  std::string address(std::string_view entry) const;
};
using PaperPointer = std::shared_ptr<const Paper>;

/// The built-in papers, by name.
const std::vector<PaperPointer>& papers();

/// A built-in paper by its name, or a file whose name ends in .toml. Throws InputError with the nearest name, or with
/// "file:line:column: …" for the first mistake in the file's head. `also`: names that the caller takes besides ("all").
PaperPointer load_paper(const std::string& name_or_path, const std::vector<std::string>& also = {});
/// `text` as the file `shown`.
PaperPointer parse_paper(std::string_view text, const std::string& shown);

/// A table, a figure or a set of pictures of a paper.
struct PaperEntry {
  PaperPointer paper;
  std::string name;  ///< within its section: "table1"
  std::string full_name() const { return paper->name + "." + name; }
};

/// The names of a section ("tables", "figures", "pictures") in the order of the file. A section is a table of tables
/// ([tables.NAME]) or a list of tables with a `name` each ([[figures]]). Throws InputError for a name that is missing,
/// is no name or comes twice.
std::vector<std::string> entry_names(const Paper&, std::string_view section);
/// Those of every built-in paper.
std::vector<PaperEntry> built_in_entries(std::string_view section);

/// "PAPER.NAME", "NAME" where one built-in paper alone has such an entry, "FILE.toml:NAME", or "FILE.toml" where the
/// file has one only. Throws InputError with the nearest name. `noun`: "table".
PaperEntry find_entry(std::string_view wanted, std::string_view section, std::string_view noun);

/// "; did you mean 'x'?", "; there are x, y", or nothing where there are none.
std::string name_hint(std::string_view name, const std::vector<std::string>& names);

/// The entry's own table of the file.
TableReader read_entry(const PaperEntry&, std::string_view section);

}  // namespace pellucid::sweeps
