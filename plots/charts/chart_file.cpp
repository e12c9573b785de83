// A finished SVG document to a file, converted where PNG or PDF is asked for.
#include <algorithm>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "algorithms/scene/files/atomic_file.hpp"
#include "gl/error.hpp"
#include "plots/charts/chart.hpp"
#include "plots/charts/scratch_file.hpp"
#include "sweeps/workers/process.hpp"

namespace pellucid::plots {
namespace {

/// Pixels of a PNG per CSS pixel: 3 gives 288 dots per inch.
constexpr int kPngZoom = 3;

std::string extension(const std::filesystem::path& path) {
  std::string text = path.extension().string();
  std::transform(text.begin(), text.end(), text.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return text;
}

/// The bytes of a PNG or PDF file.
std::string convert(const std::string& svg, bool png) {
  const ScratchFile source;
  write_text_file(source.path(), svg);
  std::vector<std::string> argv{"rsvg-convert", "--background-color", "white", "--format", png ? "png" : "pdf"};
  if (png) argv.insert(argv.end(), {"--zoom", std::to_string(kPngZoom)});
  argv.push_back(source.path().string());
  sweeps::ProcessResult result = sweeps::run_process(argv);
  if (result.status == 127) {
    throw RuntimeError(
        fmt::format("{} files need the program rsvg-convert (Debian package librsvg2-bin), which is not in PATH; "
                    "install it, or write .svg",
                    png ? "PNG" : "PDF"));
  }
  if (result.status != 0 || result.output.empty()) {
    const std::string words = result.diagnostics.substr(0, result.diagnostics.find('\n'));
    throw RuntimeError(fmt::format("rsvg-convert failed with status {}: {}", result.status, words));
  }
  return std::move(result.output);
}

}  // namespace

void check_chart_path(const std::filesystem::path& path) {
  const std::string found = extension(path);
  if (found == ".svg" || found == ".png" || found == ".pdf") return;
  throw InputError(fmt::format("'{}': the name of a figure must end in .svg, .png or .pdf", path.string()));
}

void write_svg_as(const std::string& svg, const std::filesystem::path& path) {
  check_chart_path(path);
  const std::string kind = extension(path);
  write_text_file(path, kind == ".svg" ? svg : convert(svg, kind == ".png"));
}

}  // namespace pellucid::plots
