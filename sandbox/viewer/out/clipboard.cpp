#include "sandbox/viewer/out/clipboard.hpp"

#include <fstream>
#include <string>
#include <system_error>

#include <fmt/format.h>

#include "gl/error.hpp"
#include "sweeps/workers/process.hpp"

namespace pellucid::sandbox {

void copy_file_to_clipboard(const std::filesystem::path& file, const std::string& type) {
  // xclip reads the file at once and goes on in the background to serve what it read. It would hold our pipes open all
  // that time, so it gets none; what it complains of goes through a file.
  const std::string complaints = file.string() + ".complaints";
  const sweeps::ProcessResult done =
      sweeps::run_process({"sh", "-c",
                           "command -v xclip >/dev/null || exit 127\n"
                           "exec xclip -selection clipboard -t \"$1\" -i \"$2\" </dev/null >/dev/null 2>\"$3\"",
                           "sh", type, file.string(), complaints});
  std::string words;
  if (std::ifstream in(complaints); in) std::getline(in, words);
  std::error_code ignored;
  std::filesystem::remove(complaints, ignored);
  if (done.status == 127)
    throw RuntimeError("pictures are copied by the program xclip, which is not installed (Debian's package xclip)");
  if (done.status != 0) throw RuntimeError(fmt::format("xclip failed with status {}: {}", done.status, words));
}

}  // namespace pellucid::sandbox
