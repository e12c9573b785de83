#include <algorithm>
#include <charconv>
#include <cstddef>
#include <optional>
#include <set>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "gl/error.hpp"
#include "gl/program.hpp"
#include "gl/resources/resources.hpp"

namespace pellucid::gl {

namespace {

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

// The part of `line` outside block comments; `in_comment` carries over from line to line.
std::string without_comments(std::string_view line, bool& in_comment) {
  std::string code;
  for (std::size_t i = 0; i < line.size();) {
    if (in_comment) {
      const auto end = line.find("*/", i);
      if (end == std::string_view::npos) break;
      in_comment = false;
      i = end + 2;
    } else if (line.substr(i, 2) == "/*") {
      in_comment = true;
      i += 2;
    } else if (line.substr(i, 2) == "//") {
      break;
    } else {
      code += line[i++];
    }
  }
  return code;
}

enum class Directive { none, include, version, malformed_include };

struct Parsed {
  Directive directive = Directive::none;
  std::string name;
};

Parsed parse_directive(std::string_view code) {
  std::string_view rest = trimmed(code);
  if (!rest.starts_with('#')) return {};
  rest = trimmed(rest.substr(1));
  if (rest.starts_with("version")) return {Directive::version, {}};
  if (!rest.starts_with("include")) return {};
  rest = trimmed(rest.substr(7));
  if (rest.size() < 3 || rest.front() != '"' || rest.find('"', 1) != rest.size() - 1)
    return {Directive::malformed_include, {}};
  return {Directive::include, std::string(rest.substr(1, rest.size() - 2))};
}

class Expander {
 public:
  explicit Expander(ExpandedSource& out) : out_(out) {}

  void add_line(std::string_view line, ExpandedSource::Line from) {
    out_.text.append(line);
    out_.text += '\n';
    out_.lines.push_back(from);
  }

  void add_file(const std::string& name, const std::string& text) {
    seen_.insert(name);
    const int file = static_cast<int>(out_.files.size());
    out_.files.push_back(name);
    bool in_comment = false;
    int number = 0;
    for (std::size_t at = 0; at < text.size();) {
      const std::size_t end = std::min(text.find('\n', at), text.size());
      std::string_view line(text.data() + at, end - at);
      if (line.ends_with('\r')) line.remove_suffix(1);
      at = end + 1;
      ++number;
      const Parsed parsed = parse_directive(without_comments(line, in_comment));
      const auto fail = [&](const std::string& why) {
        throw RuntimeError(fmt::format("{}:{}: {}\n  {}", name, number, why, trimmed(line)));
      };
      switch (parsed.directive) {
        case Directive::none:
          add_line(line, {file, number});
          break;
        case Directive::version:
          fail("a shader file has no #version of its own, `#version 450 core` is added");
          break;
        case Directive::malformed_include:
          fail("expected #include \"path/from/the/source/root.glsl\"");
          break;
        case Directive::include:
          // Each file at most once: that also ends cycles.
          if (seen_.contains(parsed.name)) {
            add_line("", {file, number});
          } else if (const auto included = find_resource(parsed.name)) {
            add_file(parsed.name, *included);
          } else {
            fail(fmt::format("there is no shader '{}' to include", parsed.name));
          }
          break;
      }
    }
  }

 private:
  ExpandedSource& out_;
  std::set<std::string> seen_;
};

std::string line_of(const std::string& text, int number) {
  std::size_t at = 0;
  for (int i = 1; i < number && at != std::string::npos; ++i) {
    at = text.find('\n', at);
    if (at != std::string::npos) ++at;
  }
  if (at == std::string::npos || at >= text.size()) return {};
  return text.substr(at, text.find('\n', at) - at);
}

struct Complaint {
  int line = 0;
  std::string message;
};

// Reads a log line from the left; each step says whether it found what it looked for.
struct Scanner {
  std::string_view rest;
  bool literal(std::string_view text) {
    const bool found = rest.starts_with(text);
    if (found) rest.remove_prefix(text.size());
    return found;
  }
  bool number(int& value) {
    const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), value);
    if (error != std::errc{}) return false;
    rest.remove_prefix(static_cast<std::size_t>(end - rest.data()));
    return true;
  }
  std::string message() const { return std::string(trimmed(rest)); }
};

// The three forms in use: Mesa's `0:5(10): …`, NVIDIA's `0(5) : …`, and `ERROR: 0:5: …` of most others.
std::optional<Complaint> parse_complaint(std::string_view text) {
  Scanner scan{trimmed(text)};
  std::string severity;
  if (scan.literal("ERROR: ")) severity = "error: ";
  if (scan.literal("WARNING: ")) severity = "warning: ";
  int string_index = 0, line = 0, column = 0;
  if (!scan.number(string_index)) return std::nullopt;
  if (scan.literal("(")) {
    if (!scan.number(line) || !scan.literal(")")) return std::nullopt;
    scan.rest = trimmed(scan.rest);
    if (!scan.literal(":")) return std::nullopt;
    return Complaint{line, severity + scan.message()};
  }
  if (!scan.literal(":") || !scan.number(line)) return std::nullopt;
  if (scan.literal("(") && (!scan.number(column) || !scan.literal(")"))) return std::nullopt;
  if (!scan.literal(":")) return std::nullopt;
  return Complaint{line, severity + scan.message()};
}

}  // namespace

ExpandedSource expand_includes(std::string_view resource, const Defines& defines) {
  const std::string name(resource);
  const std::optional<std::string> text = find_resource(name);
  if (!text) throw RuntimeError(fmt::format("there is no shader '{}'", name));
  ExpandedSource source;
  Expander expander(source);
  expander.add_line("#version 450 core", {});
  for (const auto& [key, value] : defines)
    expander.add_line(fmt::format("#define {} {}", key, value), {});
  expander.add_file(name, *text);
  return source;
}

std::string explain_log(std::string_view log, const ExpandedSource& source) {
  constexpr int kMostComplaints = 8;  // what follows is mostly consequence
  std::string out;
  int complaints = 0;
  for (std::size_t at = 0; at < log.size();) {
    const std::size_t end = std::min(log.find('\n', at), log.size());
    const std::string line(trimmed(log.substr(at, end - at)));
    at = end + 1;
    if (line.empty() || line.front() == '\0') continue;
    const auto complaint = parse_complaint(line);
    if (!out.empty()) out += '\n';
    if (++complaints > kMostComplaints) return out + "…";
    if (!complaint || complaint->line < 1 || complaint->line > static_cast<int>(source.lines.size())) {
      out += line;
      continue;
    }
    const ExpandedSource::Line& from = source.lines[static_cast<std::size_t>(complaint->line) - 1];
    const std::string& file = source.files[static_cast<std::size_t>(from.file)];
    const std::string place = from.line > 0 ? fmt::format("{}:{}", file, from.line) : fmt::format("{}: defines", file);
    out += fmt::format("{}: {}\n  {}", place, complaint->message, trimmed(line_of(source.text, complaint->line)));
  }
  return out;
}

}  // namespace pellucid::gl
