#include "sandbox/reproduce/run_pellucid.hpp"

#include <cstddef>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "gl/error.hpp"
#include "sandbox/status.hpp"
#include "sweeps/workers/process.hpp"

namespace pellucid::sandbox {
namespace {

// The line "error: …", else the last one.
std::string reason(std::string_view diagnostics) {
  constexpr std::string_view kError = "error: ";
  std::size_t start = diagnostics.starts_with(kError) ? 0 : diagnostics.find("\nerror: ");
  if (start != std::string_view::npos) {
    diagnostics.remove_prefix(start + (start == 0 ? 0 : 1) + kError.size());
    return std::string(diagnostics.substr(0, diagnostics.find('\n')));
  }
  while (diagnostics.ends_with('\n'))
    diagnostics.remove_suffix(1);
  start = diagnostics.rfind('\n');
  return std::string(start == std::string_view::npos ? diagnostics : diagnostics.substr(start + 1));
}

}  // namespace

std::string run_pellucid(const std::vector<std::string>& arguments) {
  // By its name, which goes on record; by the kernel's link when the file has been replaced meanwhile.
  std::error_code error;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", error);
  const bool there = !error && std::filesystem::exists(program, error);
  std::vector<std::string> command{there ? program.string() : "/proc/self/exe"};
  command.insert(command.end(), arguments.begin(), arguments.end());
  sweeps::ProcessResult result = sweeps::run_process(command);
  if (result.status == kDone) return std::move(result.output);
  const std::string words = reason(result.diagnostics);
  if (result.status == kBadInput) throw InputError(words);
  if (result.status > 128) {
    throw RuntimeError(fmt::format("pellucid {} was killed by signal {}{}{}", arguments.front(), result.status - 128,
                                   words.empty() ? "" : ": ", words));
  }
  throw RuntimeError(words.empty() ? fmt::format("pellucid {} ended with status {}", arguments.front(), result.status)
                                   : words);
}

}  // namespace pellucid::sandbox
