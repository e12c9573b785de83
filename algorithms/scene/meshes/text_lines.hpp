#pragma once

#include <charconv>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <system_error>

namespace pellucid {

/// Walks through the lines of a text (LF, CR LF or CR) and the blank-separated words of a line; '#' begins a comment
/// where `comments` says so.
class TextLines {
 public:
  TextLines(std::string_view text, bool comments, std::size_t first_number = 1)
      : rest_(text), comments_(comments), number_(first_number - 1) {}

  /// Goes to the next line with a word in it; false at the end.
  bool next() {
    while (!rest_.empty()) {
      const auto end = rest_.find_first_of("\r\n");
      line_ = rest_.substr(0, end);
      if (end == std::string_view::npos) {
        rest_ = {};
        open_ended_ = true;
      } else {
        const bool pair = rest_[end] == '\r' && end + 1 < rest_.size() && rest_[end + 1] == '\n';
        rest_.remove_prefix(end + (pair ? 2 : 1));
      }
      ++number_;
      if (comments_) line_ = line_.substr(0, line_.find('#'));
      skip_blanks();
      if (!line_.empty()) return true;
    }
    return false;
  }

  std::size_t number() const { return number_; }   ///< of the line, from 1
  std::string_view line() const { return line_; }  ///< what is left of it
  bool at_end_of_line() const { return line_.empty(); }
  bool open_ended() const { return open_ended_; }  ///< the text ends here, in the middle of a line it may be

  /// Passes over characters of the line.
  void skip(std::size_t characters) {
    line_.remove_prefix(characters);
    skip_blanks();
  }
  std::string_view word() {
    std::size_t end = 0;
    while (end < line_.size() && !is_blank(line_[end]))
      ++end;
    const std::string_view word = line_.substr(0, end);
    line_.remove_prefix(end);
    skip_blanks();
    return word;
  }
  /// The next word as a number; false when there is none or it is something else.
  template <class T>
  bool number(T& value) {
    std::string_view text = line_;
    if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || (end != text.data() + text.size() && !is_blank(*end))) return false;
    line_.remove_prefix(static_cast<std::size_t>(end - line_.data()));
    skip_blanks();
    return true;
  }

 private:
  static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\v' || c == '\f'; }
  void skip_blanks() {
    std::size_t n = 0;
    while (n < line_.size() && is_blank(line_[n]))
      ++n;
    line_.remove_prefix(n);
  }
  std::string_view rest_, line_;
  bool comments_, open_ended_ = false;
  std::size_t number_;
};

}  // namespace pellucid
