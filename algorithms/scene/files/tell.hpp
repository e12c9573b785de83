#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

namespace pellucid {

/// The text as one line of UTF-8 without control characters: a name may hold line ends, what a terminal obeys, or bytes
/// of another encoding. They become \n, \t and \x1b.
std::string printable(std::string_view text);

/// "1 face", "2 faces"; `plural` where it is not the noun and an s.
std::string counted(std::size_t n, std::string_view noun, std::string_view plural = {});

/// Hears the lines that are told, in place of standard error, while it lives; one at a time in a process.
class TellListener {
 public:
  /// `hear` is called from any thread, by one at a time, with a printable line.
  explicit TellListener(std::function<void(std::string_view line)> hear);
  ~TellListener();
  TellListener(const TellListener&) = delete;
  TellListener& operator=(const TellListener&) = delete;
};

/// Prints one printable line to standard error, or gives it to the listener.
void tell_line(std::string_view line);
template <class... T>
void tell(fmt::format_string<T...> format, T&&... arguments) {
  tell_line(fmt::format(format, std::forward<T>(arguments)...));
}

}  // namespace pellucid
