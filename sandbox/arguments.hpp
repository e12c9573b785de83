#pragma once

#include <filesystem>
#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "algorithms/scene/images/image.hpp"

/// Arguments that several sub-commands take, read one way.
namespace pellucid::sandbox {

/// "name=value". Throws InputError.
std::pair<std::string, std::string> parse_assignment(const std::string& text);

/// Throws InputError unless the path ends in one of `extensions` (".exr", …), RuntimeError unless its folder exists:
/// found out before the work, not after.
void check_output(const std::filesystem::path& path, std::initializer_list<std::string_view> extensions);

/// Throws InputError when `output` is the file `input` (which need not exist): what is read is not overwritten.
void check_no_input(const std::filesystem::path& output, const std::filesystem::path& input, std::string_view option);

/// This process's command line, for the record.
std::vector<std::string> process_arguments();

/// How a scene-linear image becomes a PNG.
struct DisplayOptions {
  std::string display, view;  ///< of the OpenColorIO config; empty: its default
  double exposure_ev = 0;
  std::string look{};  ///< of the config; empty: none
};

/// EXR with every value as it is, in 16-bit floats where they hold all of them; PNG through the display transform.
void write_picture(const std::filesystem::path& path, const ImageFile& file, const DisplayOptions&);

}  // namespace pellucid::sandbox
