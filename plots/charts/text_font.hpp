#pragma once

#include <string>

class vtkTextProperty;

/// VTK draws nothing for a character that its font lacks, not even a box. Each text is therefore given a font that has
/// all of it, and characters that no font has are spelled out.
namespace pellucid::plots {

struct DrawnText {
  std::string text;       ///< printable, and with "U+65E5" in place of a character that no installed font has
  std::string font_file;  ///< empty: VTK's built-in font
};

DrawnText drawn_text(const std::string& text, bool bold);

/// Width of one line in the property's font and size [px].
int drawn_width(vtkTextProperty*, const std::string& text);

}  // namespace pellucid::plots
