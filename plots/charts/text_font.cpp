#include "plots/charts/text_font.hpp"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <sstream>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <vtkNew.h>
#include <vtkStdString.h>
#include <vtkTextProperty.h>
#include <vtkTextRenderer.h>

#include "algorithms/scene/files/tell.hpp"
#include "sweeps/workers/process.hpp"

namespace pellucid::plots {
namespace {

/// The code points of a UTF-8 text, each with its bytes.
std::vector<std::pair<std::uint32_t, std::string>> characters(const std::string& text) {
  std::vector<std::pair<std::uint32_t, std::string>> all;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (!all.empty() && (byte & 0xC0U) == 0x80U) {
      all.back().first = all.back().first << 6U | (byte & 0x3FU);
      all.back().second += c;
    } else {
      const unsigned first = byte < 0x80U ? byte : byte & (byte < 0xE0U ? 0x1FU : byte < 0xF0U ? 0x0FU : 0x07U);
      all.emplace_back(first, std::string(1, c));
    }
  }
  return all;
}

/// A character that VTK's font lacks takes no room.
bool built_in_font_has(const std::string& character) {
  static std::map<std::string, bool> known;
  if (character.size() == 1) return true;
  const auto [at, is_new] = known.emplace(character, false);
  if (is_new) {
    vtkNew<vtkTextProperty> property;
    property->SetFontFamilyToArial();
    property->SetFontSize(24);
    at->second = drawn_width(property, "n" + character + "n") > drawn_width(property, "nn");
  }
  return at->second;
}

/// A font's file and what it has: ranges of code points.
struct Font {
  std::string file;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> ranges;

  /// VTK draws nothing beyond U+FFFF, whatever the font has.
  bool has(std::uint32_t code) const {
    return code <= 0xFFFF && std::any_of(ranges.begin(), ranges.end(), [&](const auto& range) {
             return code >= range.first && code <= range.second;
           });
  }
};

/// Fontconfig's choice for a pattern; without a file where there is none.
const Font& font_for(const std::string& pattern) {
  static std::map<std::string, Font> known;
  const auto [at, is_new] = known.emplace(pattern, Font{});
  if (!is_new) return at->second;
  const sweeps::ProcessResult result = sweeps::run_process({"fc-match", "--format=%{file}\n%{charset}", pattern});
  std::istringstream lines(result.status == 0 ? result.output : std::string());
  std::getline(lines, at->second.file);
  for (std::string range; lines >> range;) {  // hexadecimal: "20-7e" or "a9"
    char* end = nullptr;
    const auto first = static_cast<std::uint32_t>(std::strtoul(range.c_str(), &end, 16));
    const auto last = *end == '-' ? static_cast<std::uint32_t>(std::strtoul(end + 1, nullptr, 16)) : first;
    at->second.ranges.emplace_back(first, last);
  }
  return at->second;
}

}  // namespace

DrawnText drawn_text(const std::string& any_text, bool bold) {
  const std::string text = printable(any_text);
  const auto all = characters(text);
  if (std::all_of(all.begin(), all.end(), [](const auto& character) { return built_in_font_has(character.second); }))
    return {text, {}};
  const Font& usual = font_for(bold ? "DejaVu Sans:style=Bold" : "DejaVu Sans:style=Book");
  const auto has_all = [&](const Font& font) {
    return std::all_of(all.begin(), all.end(), [&](const auto& character) { return font.has(character.first); });
  };
  if (has_all(usual)) return {text, usual.file};
  std::string wanted = fmt::format("sans-serif:{}charset=", bold ? "bold:" : "");
  for (const auto& [code, bytes] : all)
    wanted += fmt::format("{:x} ", code);
  if (const Font& other = font_for(wanted); has_all(other)) return {text, other.file};
  DrawnText spelled{{}, usual.file};
  for (const auto& [code, bytes] : all) {
    const bool drawn = usual.file.empty() ? built_in_font_has(bytes) : usual.has(code);
    spelled.text += drawn ? bytes : fmt::format("U+{:04X}", code);
  }
  return spelled;
}

int drawn_width(vtkTextProperty* property, const std::string& text) {
  int box[4] = {0, 0, 0, 0};
  if (!vtkTextRenderer::GetInstance()->GetBoundingBox(property, text, box, 72)) return 0;
  return box[1] - box[0] + 1;
}

}  // namespace pellucid::plots
