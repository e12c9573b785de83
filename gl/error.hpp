#pragma once

#include <stdexcept>
#include <string>

namespace pellucid {

/// Bad input from the user: a file, an option or a parameter. `main` prints it as `error: …` and exits with status 2.
/// The message is one line that names the place (file:line:column or parameter), what was found and what is allowed.
struct InputError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The work could not be done although the input was sound: no GL device, a full disk. Exit status 1.
struct RuntimeError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace pellucid
