#include "sweeps/papers/paper.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <utility>

#include <fmt/format.h>
#include <toml++/toml.h>

#include "algorithms/parameters.hpp"
#include "algorithms/technique.hpp"
#include "gl/error.hpp"
#include "gl/resources/resources.hpp"
#include "sweeps/spec/spec.hpp"

namespace pellucid::sweeps {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMaxPaperBytes = std::uintmax_t{1} << 20;
constexpr std::string_view kFolder = "algorithms/";
constexpr std::string_view kFile = "/paper.toml";

/// The name of the spec in a file, without checking the rest of it: what it measures need not be here.
std::string spec_name(const std::string& path) {
  const TomlFile file{path};
  const auto document = parse_toml(read_toml_text(path, "sweep", kMaxPaperBytes), file);
  std::string name;
  TableReader(file, *document).text("name", name, Need::required);
  return name;
}

std::vector<PaperSweep> read_sweeps(TableReader& root, const Paper& paper) {
  std::vector<PaperSweep> sweeps;
  const std::vector<std::string> embedded = list_specs();
  for (const auto& [given, place] : root.texts("sweeps")) {
    PaperSweep sweep{given, given};
    if (given.ends_with(".toml")) {
      if (!fs::path(given).is_absolute() && !paper.built_in)
        sweep.spec = (fs::path(paper.file.shown).parent_path() / given).lexically_normal().string();
      try {
        sweep.name = spec_name(sweep.spec);
      } catch (const InputError& e) {
        root.fail(place, e.what());
      }
    } else if (std::find(embedded.begin(), embedded.end(), given) == embedded.end()) {
      root.fail(place, fmt::format("no sweep named '{}' is built in{} (a file's name ends in .toml)", given,
                                   name_hint(given, embedded)));
    }
    const bool twice =
        std::any_of(sweeps.begin(), sweeps.end(), [&](const PaperSweep& other) { return other.name == sweep.name; });
    if (twice) root.fail(place, fmt::format("sweeps: '{}' is listed twice", sweep.name));
    sweeps.push_back(std::move(sweep));
  }
  return sweeps;
}

std::string default_name(const Paper& paper) {
  const fs::path path(paper.file.shown);
  return paper.built_in ? path.parent_path().filename().string() : path.stem().string();
}

PaperPointer parse(std::string_view text, const std::string& shown, bool built_in) {
  auto paper = std::make_shared<Paper>();
  paper->built_in = built_in;
  paper->file = {shown};
  paper->document = parse_toml(text, paper->file);
  TableReader root = paper->read();
  root.text("name", paper->name);
  if (paper->name.empty()) {
    paper->name = default_name(*paper);
    std::replace(paper->name.begin(), paper->name.end(), '-', '_');
  }
  if (!is_name(paper->name)) {
    root.fail(root.place("name"),
              fmt::format("name: '{}' is not a name: use lower-case letters, digits and underscores, a letter first",
                          paper->name));
  }
  root.text("title", paper->title, Need::required);
  root.text("reference", paper->citation, built_in ? Need::required : Need::optional);
  root.text("source", paper->source);
  root.text("machine", paper->machine);
  paper->sweeps = read_sweeps(root, *paper);
  for (const auto& [technique, place] : root.texts("colours")) {
    try {
      find_technique(technique);
    } catch (const InputError& e) {
      root.fail(place, e.what());
    }
    paper->colours.push_back(technique);
  }
  paper->quantities = read_quantities(root, true);
  for (const Quantity& quantity : paper->quantities) {
    if (sweeps::find_quantity(quantity.name) != nullptr) {
      root.fail(root.place("quantities"),
                fmt::format("quantities.{}: every row has a quantity of this name already", quantity.name));
    }
  }
  // Read by the engines of tables, figures and pictures.
  for (const char* section : {"tables", "row_sets", "figures", "pictures"})
    root.node(section);
  root.finish();
  return paper;
}

const PaperPointer* find_built_in(std::string_view name) {
  const auto found =
      std::find_if(papers().begin(), papers().end(), [&](const PaperPointer& paper) { return paper->name == name; });
  return found == papers().end() ? nullptr : &*found;
}

PaperEntry find_in(const PaperPointer& paper, std::string_view name, std::string_view section, std::string_view noun) {
  const std::vector<std::string> names = entry_names(*paper, section);
  if (std::find(names.begin(), names.end(), name) != names.end()) return {paper, std::string(name)};
  throw InputError(fmt::format("{} has no {} named '{}'{}", paper->file.shown, noun, name, name_hint(name, names)));
}

}  // namespace

std::string name_hint(std::string_view name, const std::vector<std::string>& names) {
  if (const std::string near = nearest_name(name, names); !near.empty())
    return fmt::format("; did you mean '{}'?", near);
  return names.empty() ? "" : fmt::format("; there are {}", fmt::join(names, ", "));
}

const Quantity* Paper::find_quantity(std::string_view wanted) const {
  for (const Quantity& own : quantities) {
    if (own.name == wanted) return &own;
  }
  return sweeps::find_quantity(wanted);
}

const Quantity& Paper::quantity(std::string_view wanted) const {
  if (const Quantity* found = find_quantity(wanted)) return *found;
  std::vector<std::string> names;
  for (const Quantity& own : quantities)
    names.push_back(own.name);
  for (const Quantity& declared : sweeps::quantities())
    names.push_back(declared.name);
  const std::string near = nearest_name(wanted, names);
  throw InputError(
      fmt::format("unknown quantity '{}'; {}", wanted,
                  near.empty() ? "pellucid list quantities names them all" : fmt::format("did you mean '{}'?", near)));
}

std::string Paper::address(std::string_view entry) const {
  return built_in ? fmt::format("{}.{}", name, entry) : fmt::format("{}:{}", file.shown, entry);
}

const std::vector<PaperPointer>& papers() {
  static const std::vector<PaperPointer> all = [] {
    std::vector<PaperPointer> found;
    for (const std::string& resource : list_resources(kFolder, kFile))
      found.push_back(parse(find_resource(resource).value_or(""), resource, true));
    return found;
  }();
  return all;
}

PaperPointer parse_paper(std::string_view text, const std::string& shown) {
  return parse(text, shown, false);
}

PaperPointer load_paper(const std::string& name_or_path, const std::vector<std::string>& also) {
  if (name_or_path.ends_with(".toml"))
    return parse_paper(read_toml_text(name_or_path, "paper", kMaxPaperBytes), name_or_path);
  if (const PaperPointer* found = find_built_in(name_or_path)) return *found;
  std::vector<std::string> names;
  for (const PaperPointer& paper : papers())
    names.push_back(paper->name);
  names.insert(names.end(), also.begin(), also.end());
  throw InputError(fmt::format("unknown paper '{}'{}", name_or_path, name_hint(name_or_path, names)));
}

std::vector<std::string> entry_names(const Paper& paper, std::string_view section) {
  std::vector<std::string> names;
  TableReader root = paper.read();
  const toml::node* node = root.node(section);
  if (node == nullptr) return names;
  if (!node->is_array()) {
    for (const auto& [name, reader] : root.named_tables(section))
      names.push_back(name);
    return names;
  }
  for (TableReader& reader : root.tables(section)) {
    std::string name;
    reader.text("name", name, Need::required);
    if (!is_name(name)) reader.fail("name", fmt::format("'{}' is not a name of a-z, 0-9 and _, a letter first", name));
    if (std::find(names.begin(), names.end(), name) != names.end())
      reader.fail("name", fmt::format("'{}' comes twice", name));
    names.push_back(std::move(name));
  }
  return names;
}

std::vector<PaperEntry> built_in_entries(std::string_view section) {
  std::vector<PaperEntry> entries;
  for (const PaperPointer& paper : papers()) {
    for (const std::string& name : entry_names(*paper, section))
      entries.push_back({paper, name});
  }
  return entries;
}

PaperEntry find_entry(std::string_view wanted, std::string_view section, std::string_view noun) {
  if (wanted.ends_with(".toml")) {
    const PaperPointer paper = load_paper(std::string(wanted));
    const std::vector<std::string> names = entry_names(*paper, section);
    if (names.size() == 1) return {paper, names.front()};
    throw InputError(names.empty() ? fmt::format("{} has no {}", wanted, noun)
                                   : fmt::format("{} has several {}s: say {}:NAME with one of {}", wanted, noun, wanted,
                                                 fmt::join(names, ", ")));
  }
  if (const std::size_t colon = wanted.rfind(".toml:"); colon != std::string_view::npos) {
    const PaperPointer paper = load_paper(std::string(wanted.substr(0, colon + 5)));
    return find_in(paper, wanted.substr(colon + 6), section, noun);
  }
  std::vector<std::string> names, either;  // `either`: short ones too
  std::vector<PaperEntry> short_named;     // "fig8" for "PAPER.fig8"
  for (PaperEntry& entry : built_in_entries(section)) {
    names.push_back(entry.full_name());
    either.insert(either.end(), {entry.full_name(), entry.name});
    if (names.back() == wanted) return entry;
    if (entry.name == wanted) short_named.push_back(std::move(entry));
  }
  if (short_named.size() == 1) return short_named.front();
  if (short_named.size() > 1) {
    throw InputError(fmt::format("'{}' is a {} of several papers: {}, {}{}", wanted, noun, short_named[0].full_name(),
                                 short_named[1].full_name(), short_named.size() > 2 ? ", …" : ""));
  }
  const std::string near = nearest_name(wanted, either);
  throw InputError(near.empty() ? fmt::format("no {} named '{}'; there are: {}", noun, wanted, fmt::join(names, ", "))
                                : fmt::format("no {} named '{}'; did you mean '{}'?", noun, wanted, near));
}

TableReader read_entry(const PaperEntry& entry, std::string_view section) {
  TableReader root = entry.paper->read();
  if (const toml::node* node = root.node(section); node != nullptr && !node->is_array()) {
    for (auto& [name, reader] : root.named_tables(section)) {
      if (name == entry.name) return reader;
    }
  }
  for (TableReader& reader : root.tables(section)) {
    std::string name;
    reader.text("name", name, Need::required);
    if (name == entry.name) return reader;
  }
  throw InputError(fmt::format("{} has no entry '{}' in {}", entry.paper->file.shown, entry.name, section));
}

}  // namespace pellucid::sweeps
