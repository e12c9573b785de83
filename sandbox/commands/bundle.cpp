// pellucid bundle: the program with all that it needs, in one archive.
#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <set>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include "algorithms/scene/files/asset_path.hpp"
#include "algorithms/scene/files/atomic_file.hpp"
#include "algorithms/scene/files/tell.hpp"
#include "gl/error.hpp"
#include "sandbox/arguments.hpp"
#include "sandbox/commands/commands.hpp"
#include "sweeps/spec/provenance.hpp"

namespace pellucid::sandbox {
namespace {

namespace fs = std::filesystem;

struct BundleArguments {
  fs::path output;
  std::vector<std::string> assets;
};

/// Libraries that belong to the machine: the C library with its loader, and the GL driver's entrance.
constexpr std::array<std::string_view, 11> kOfTheMachine{"linux-vdso", "ld-linux",   "libc.so",  "libm.so",
                                                         "libdl.so",   "libpthread", "librt.so", "libresolv",
                                                         "libEGL.so",  "libdrm",     "libgbm"};
/// Libraries that the driver may share with us, and want newer than ours: the machine's own are taken where it has
/// them.
constexpr std::array<std::string_view, 9> kShared{"libstdc++.so", "libgcc_s.so", "libGL",    "libOpenGL.so", "libX",
                                                  "libxcb",       "libbsd.so",   "libmd.so", "libSM.so"};

constexpr const char* kLauncher = R"sh(#!/bin/sh
# Starts the program with the libraries beside it.
here=$(CDPATH= cd -- "$(dirname -- "$(readlink -f -- "$0")")" && pwd)
paths=$here/lib
# The GL driver brings libraries of its own, which may want a newer one of these than lies here: the machine's goes first.
find_own() {
  for folder in /usr/lib/x86_64-linux-gnu /lib/x86_64-linux-gnu /usr/lib64 /lib64 /usr/lib; do
    if [ -e "$folder/$1" ]; then
      echo "$folder/$1"
      return
    fi
  done
}
for folder in "$here"/lib/fallback/*; do
  own=$(find_own "${folder##*/}")
  case $folder in
    */libstdc++.so.6) if [ -n "$own" ] && ! grep -qs GLIBCXX_3.4.30 "$own"; then own=; fi ;;
  esac
  if [ -z "$own" ]; then paths=$paths:$folder; fi
done
LD_LIBRARY_PATH=$paths${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH} exec "$here/bin/pellucid" "$@"
)sh";

constexpr const char* kReadme =
    R"(Pellucid with its libraries, for x86-64 Linux with glibc 2.36 or newer and an EGL driver for OpenGL 4.5 (Mesa, or NVIDIA's).
Nothing needs to be installed: ./pellucid --help, ./pellucid devices.
PNG and PDF charts need rsvg-convert on the PATH; SVG charts need nothing. lib/ holds libraries under their own licences;
share/doc/ holds Pellucid's.
)";

std::string output_of(const std::vector<std::string>& command) {
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(::popen(sweeps::shell_line(command).c_str(), "r"), &::pclose);
  if (!pipe) throw RuntimeError(fmt::format("{} cannot be started", command.front()));
  std::string text;
  std::array<char, 4096> chunk{};
  for (std::size_t n = 0; (n = std::fread(chunk.data(), 1, chunk.size(), pipe.get())) > 0;)
    text.append(chunk.data(), n);
  return text;
}

template <std::size_t N>
bool among(const std::string& name, const std::array<std::string_view, N>& names) {
  return std::any_of(names.begin(), names.end(), [&](std::string_view start) { return name.starts_with(start); });
}

/// Every shared library of the program, as the loader finds it: name and path.
std::vector<std::pair<std::string, fs::path>> libraries(const fs::path& program) {
  std::vector<std::pair<std::string, fs::path>> result;
  std::istringstream lines(output_of({"ldd", program.string()}));
  for (std::string line; std::getline(lines, line);) {
    const std::size_t arrow = line.find(" => ");
    if (arrow == std::string::npos) continue;
    const std::size_t start = line.find_first_not_of(" \t");
    const std::string name = line.substr(start, arrow - start);
    std::string path = line.substr(arrow + 4);
    path = path.substr(0, path.find(" ("));
    if (path == "not found") throw RuntimeError(fmt::format("{} needs {}, which is not here", program.string(), name));
    result.emplace_back(name, path);
  }
  if (result.empty()) throw RuntimeError(fmt::format("ldd finds no libraries of {}", program.string()));
  return result;
}

/// A folder in the system's place for such, gone at the end.
class Scratch {
 public:
  Scratch() {
    std::string name = (fs::temp_directory_path() / "pellucid-bundle-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) throw RuntimeError("no temporary folder can be made");
    path_ = name;
  }
  ~Scratch() {
    std::error_code error;
    fs::remove_all(path_, error);
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

int bundle(const BundleArguments& arguments) {
  check_output(arguments.output, {".xz"});
  if (!arguments.output.string().ends_with(".tar.xz")) throw InputError("-o: the name must end in .tar.xz");
  const fs::path program = fs::read_symlink("/proc/self/exe");
  const Scratch scratch;
  const fs::path root = scratch.path() / "pellucid";
  for (const char* folder : {"bin", "lib", "share/pellucid/assets", "share/doc"})
    fs::create_directories(root / folder);
  fs::copy_file(program, root / "bin/pellucid");
  for (const auto& [name, path] : libraries(program)) {
    if (among(name, kOfTheMachine)) continue;
    const fs::path folder = root / (among(name, kShared) ? "lib/fallback/" + name : "lib");
    fs::create_directories(folder);
    fs::copy_file(fs::canonical(path), folder / name);
  }
  for (const std::string& asset : arguments.assets) {
    const fs::path from = resolve_asset("asset:" + asset, {});
    const fs::path to = root / "share/pellucid/assets" / asset;
    fs::create_directories(to.parent_path());
    fs::copy_file(from, to);
  }
  write_text_file(root / "pellucid", kLauncher);
  fs::permissions(root / "pellucid", fs::perms::owner_all | fs::perms::group_read | fs::perms::group_exec |
                                         fs::perms::others_read | fs::perms::others_exec);
  write_text_file(root / "README.txt", kReadme);
  const fs::path made = scratch.path() / "bundle.tar.xz";
  output_of({"strip", "--strip-unneeded", (root / "bin/pellucid").string()});
  const std::string words = output_of({"env", "XZ_OPT=-T0", "tar", "-C", scratch.path().string(), "--sort=name",
                                       "--owner=0", "--group=0", "-cJf", made.string(), "pellucid"});
  std::error_code error;
  if (!fs::exists(made, error) || fs::file_size(made, error) == 0)
    throw RuntimeError("tar made no archive; is xz there? " + words);
  fs::copy_file(made, arguments.output, fs::copy_options::overwrite_existing);
  tell("{}: {:.1f} MiB, {} assets", arguments.output.string(),
       static_cast<double>(fs::file_size(arguments.output)) / (1 << 20), arguments.assets.size());
  return kDone;
}

}  // namespace

void add_bundle(cli::App& root, std::vector<Command>& commands) {
  auto arguments = std::make_shared<BundleArguments>();
  cli::App* app = root.add_subcommand("bundle", "Pack the program with its libraries for machines that have neither");
  app->add_option("-o,--output", arguments->output, "the archive, NAME.tar.xz")->required();
  app->add_option("--asset", arguments->assets, "an asset to take along, as meshes/bunny00.off; repeatable");
  app->footer(
      "Example: pellucid bundle -o pellucid.tar.xz --asset meshes/bunny00.off\n"
      "On the other machine, with a GL driver and glibc no older than here: tar -xf pellucid.tar.xz; "
      "pellucid/pellucid devices");
  commands.push_back({app, [arguments] { return bundle(*arguments); }});
}

}  // namespace pellucid::sandbox
