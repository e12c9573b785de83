#include <algorithm>
#include <array>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "algorithms/scene/files/tell.hpp"
#include "algorithms/scene/meshes/raw_mesh.hpp"
#include "algorithms/scene/meshes/text_lines.hpp"

/// Wavefront OBJ, its polygons. Ours, because Assimp 5.2 rounds coordinates to 32 bits before they can be shifted and
/// gives faces without normals normals of no length.
namespace pellucid {

namespace fs = std::filesystem;

namespace {

/// Statements that shape no polygon: grouping, materials, display.
constexpr std::array kAside = {"g",   "o",     "s",        "mg",       "usemtl",     "maplib",   "usemap",
                               "lod", "bevel", "c_interp", "d_interp", "shadow_obj", "trace_obj"};
/// Free-form curves and surfaces, and calls of other files.
constexpr std::array kNotRead = {"vp",    "cstype", "deg",  "bmat", "step", "curv", "curv2", "surf",
                                 "parm",  "trim",   "hole", "scrv", "sp",   "end",  "con",   "ctech",
                                 "stech", "call",   "csh",  "bzp",  "bsp",  "cdc",  "cdp",   "res"};

template <class List>
bool contains(const List& list, std::string_view word) {
  return std::find(list.begin(), list.end(), word) != list.end();
}

/// A backslash at a line's end joins it with the next.
std::string joined(std::string text) {
  for (auto at = text.find('\\'); at != std::string::npos; at = text.find('\\', at + 1)) {
    std::size_t end = at + 1;
    if (end < text.size() && text[end] == '\r') ++end;
    if (end < text.size() && text[end] == '\n')
      std::fill(text.begin() + static_cast<std::ptrdiff_t>(at), text.begin() + static_cast<std::ptrdiff_t>(end) + 1,
                ' ');
  }
  return text;
}

class ObjReader {
 public:
  ObjReader(const fs::path& path, const std::string& text) : path_(path), lines_(text, true) {}

  RawMesh read() {
    while (lines_.next())
      statement(lines_.word());
    mesh_.normals.resize(any_normal_ ? mesh_.positions.size() : 0);
    if (!all_mapped_) mesh_.uvs.clear();
    if (!colors_.empty() && colors_.size() == points_.size()) {
      const std::vector<glm::vec3> shares = colors_of_text(path_, colors_);
      for (const std::uint32_t point : point_of_)
        mesh_.colors.push_back(shares[point]);
    } else if (!colors_.empty()) {
      mesh_.warnings.emplace_back("only some of its vertices have colours; they are left out");
    }
    if (elements_left_out_ > 0)
      mesh_.warnings.push_back(
          fmt::format("{} left out", counted(elements_left_out_, "point or line is", "points and lines are")));
    faces_.triangulate(path_, mesh_);
    return std::move(mesh_);
  }

 private:
  [[noreturn]] void fail(std::string_view reason) const {
    throw unreadable_mesh(path_, fmt::format("{} in line {}", reason, lines_.number()));
  }

  void statement(std::string_view word) {
    if (word == "v")
      point();
    else if (word == "vn")
      vector(normals_.emplace_back(), 3, "vn");
    else if (word == "vt")
      texture();
    else if (word == "f" || word == "fo")
      face();
    else if (word == "l" || word == "p")
      ++elements_left_out_;
    else if (word == "mtllib")
      library();
    else if (contains(kNotRead, word))
      fail(fmt::format("'{}': free-form geometry and calls are not read,", word));
    else if (!contains(kAside, word))
      fail(fmt::format("'{}' is no statement of OBJ", std::string(word.substr(0, 40))));
  }

  template <class Vector>
  void vector(Vector& out, int n, std::string_view word) {
    for (int i = 0; i < n; ++i)
      if (!lines_.number(out[i])) fail(fmt::format("{} needs {} numbers", word, n));
  }

  /// x y z, perhaps a weight, which polygons do not use, or a colour.
  void point() {
    if (points_.size() >= std::numeric_limits<std::uint32_t>::max() / 2) fail("too many vertices");
    vector(points_.emplace_back(), 3, "v");
    first_.push_back(kNone);
    std::array<double, 5> more{};
    std::size_t n = 0;
    while (!lines_.at_end_of_line()) {
      if (n == more.size() || !lines_.number(more[n])) fail("v has 3 numbers, and perhaps a weight or a colour");
      ++n;
    }
    if (n == 1 && more[0] != 1) fail(fmt::format("a vertex of weight {}", more[0]));
    if (n >= 3) colors_.emplace_back(more[0], more[1], more[2]);  // a fourth is alpha
    if (n == 2 || n == 5) fail("v has 3 numbers, and perhaps a weight or a colour");
  }
  void texture() {
    glm::vec2& uv = uvs_.emplace_back(0.0F);
    if (!lines_.number(uv.x)) fail("vt needs a number");
    if (!lines_.at_end_of_line() && !lines_.number(uv.y)) fail("vt needs numbers");
  }

  void library() {
    const fs::path file =
        path_.parent_path() / std::string(lines_.line().substr(0, lines_.line().find_last_not_of(" \t") + 1));
    std::error_code error;
    if (fs::is_regular_file(file, error)) mesh_.files.push_back(file);  // a part of what the scene is made of
  }

  struct Corner {
    long long point = 0, uv = 0, normal = 0;  ///< from 1, negative ones from the end; 0: none
  };
  /// "1", "1/2", "1//3", "1/2/3", and what some exporters leave behind: "1/", "1//".
  Corner corner(std::string_view word) const {
    Corner c;
    long long* const parts[] = {&c.point, &c.uv, &c.normal};
    for (int part = 0; part < 3; ++part) {
      const auto slash = word.find('/');
      const std::string_view digits = word.substr(0, slash);
      if (!digits.empty()) {
        const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), *parts[part]);
        if (error != std::errc{} || end != digits.data() + digits.size()) fail("a corner that is no index");
      } else if (part == 0) {
        fail("a corner without a vertex");
      }
      if (slash == std::string_view::npos) return c;
      word.remove_prefix(slash + 1);
    }
    fail("a corner of more than three indices");
  }
  std::uint32_t resolve(long long index, std::size_t count, std::string_view what) const {
    const long long from_zero = index > 0 ? index - 1 : index + static_cast<long long>(count);
    if (index == 0 || from_zero < 0 || from_zero >= static_cast<long long>(count))
      fail(fmt::format("{} {} of {}", what, index, count));
    return static_cast<std::uint32_t>(from_zero);
  }

  void face() {
    faces_.begin();
    std::size_t corners = 0;
    bool slash = false;  // at the last corner's end
    for (; !lines_.at_end_of_line(); ++corners) {
      const std::string_view word = lines_.word();
      slash = word.back() == '/';
      const Corner c = corner(word);
      const std::uint32_t point = resolve(c.point, points_.size(), "a face names vertex");
      const std::uint32_t uv = c.uv != 0 ? resolve(c.uv, uvs_.size(), "a face names texture vertex") : kNone;
      const std::uint32_t normal = c.normal != 0 ? resolve(c.normal, normals_.size(), "a face names normal") : kNone;
      faces_.corner(vertex(point, uv, normal));
    }
    if (lines_.open_ended() && (corners < 3 || slash)) fail("the file ends inside a face,");
  }

  /// The mesh's vertex for a triple of indices, made at its first use.
  std::uint32_t vertex(std::uint32_t point, std::uint32_t uv, std::uint32_t normal) {
    for (std::uint32_t v = first_[point]; v != kNone; v = next_[v])
      if (uv_of_[v] == uv && normal_of_[v] == normal) return v;
    const auto made = static_cast<std::uint32_t>(mesh_.positions.size());
    mesh_.positions.push_back(points_[point]);
    mesh_.normals.push_back(normal != kNone ? normals_[normal] : glm::vec3(0.0F));
    mesh_.uvs.push_back(uv != kNone ? uvs_[uv] : glm::vec2(0.0F));
    any_normal_ = any_normal_ || normal != kNone;
    all_mapped_ = all_mapped_ && uv != kNone;
    point_of_.push_back(point);
    uv_of_.push_back(uv);
    normal_of_.push_back(normal);
    next_.push_back(first_[point]);
    first_[point] = made;
    return made;
  }

  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  const fs::path& path_;
  TextLines lines_;
  RawMesh mesh_;
  Faces faces_;
  std::vector<glm::dvec3> points_;
  std::vector<glm::vec3> normals_, colors_;
  std::vector<glm::vec2> uvs_;
  std::vector<std::uint32_t> first_;                                ///< vertex made of each point, or kNone
  std::vector<std::uint32_t> next_, point_of_, uv_of_, normal_of_;  ///< of each vertex made
  bool any_normal_ = false, all_mapped_ = true;
  std::size_t elements_left_out_ = 0;
};

}  // namespace

RawMesh read_obj(const fs::path& path) {
  const std::string text = joined(mesh_bytes(path));
  return ObjReader(path, text).read();
}

}  // namespace pellucid
