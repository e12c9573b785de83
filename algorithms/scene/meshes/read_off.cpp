#include <cctype>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "algorithms/scene/meshes/raw_mesh.hpp"
#include "algorithms/scene/meshes/text_lines.hpp"

/// OFF (geomview.org/docs/html/OFF.html) as text. Ours, because Assimp 5.2 loses the faces at comment lines.
namespace pellucid {

namespace fs = std::filesystem;

namespace {

/// The keyword "[ST][C][N][4][n]OFF" tells what a vertex has beside its place.
struct VertexLayout {
  bool uvs = false, colors = false, normals = false;
};

class OffReader {
 public:
  OffReader(const fs::path& path, const std::string& text) : path_(path), lines_(text, true), bytes_(text.size()) {}

  RawMesh read() {
    if (!lines_.next()) throw fail("it has nothing but comments");
    const VertexLayout layout = keyword();
    const std::uint64_t vertices = count("vertices"), faces = count("faces");
    count("edges");  // not used
    check_mesh_size(path_, vertices, faces);
    if (vertices + faces > bytes_)  // each takes a byte at the very least
      throw fail(fmt::format("its header claims {} vertices and {} faces, more than {} bytes can hold", vertices, faces,
                             bytes_));
    if (!lines_.at_end_of_line()) throw fail_line("more than three counts");
    for (std::uint64_t v = 0; v < vertices; ++v) {
      if (!lines_.next()) throw fail(fmt::format("it ends at vertex {} of {}", v, vertices));
      vertex(layout, v);
    }
    if (!colors_.empty()) mesh_.colors = colors_of_text(path_, colors_);
    Faces all;
    all.reserve(faces);
    for (std::uint64_t f = 0; f < faces; ++f) {
      if (!lines_.next()) throw fail(fmt::format("it ends at face {} of {}", f, faces));
      face(f, vertices, all);
    }
    if (lines_.next()) throw fail_line(fmt::format("something follows the {} faces that its header promises", faces));
    all.triangulate(path_, mesh_);
    return std::move(mesh_);
  }

 private:
  InputError fail(std::string_view reason) const { return unreadable_mesh(path_, reason); }
  InputError fail_line(std::string_view reason) const {
    return fail(fmt::format("{} in line {}", reason, lines_.number()));
  }

  /// The keyword may be missing, and the counts may follow it without a blank.
  VertexLayout keyword() {
    std::string_view line = lines_.line();
    VertexLayout layout;
    if (!line.empty() && std::isdigit(static_cast<unsigned char>(line[0])) != 0 && !line.starts_with("4OFF"))
      return layout;
    const auto take = [&](std::string_view prefix) {
      if (!line.starts_with(prefix)) return false;
      line.remove_prefix(prefix.size());
      return true;
    };
    layout.uvs = take("ST");
    layout.colors = take("C");
    layout.normals = take("N");
    if (take("4") || take("n"))
      throw fail("points of four or n dimensions (4OFF, nOFF) are not read; OFF, COFF, NOFF and STOFF are, as text");
    if (!take("OFF")) throw fail("malformed OFF header");
    lines_.skip(lines_.line().size() - line.size());
    if (lines_.line().starts_with("BINARY")) throw fail("binary OFF is not read; OFF as text is");
    return layout;
  }

  /// All on one line, or on lines of their own.
  std::uint64_t count(std::string_view what) {
    if (lines_.at_end_of_line() && !lines_.next()) throw fail(fmt::format("its header has no number of {}", what));
    std::uint64_t value = 0;
    if (!lines_.number(value)) throw fail("malformed OFF header");
    return value;
  }

  void vertex(const VertexLayout& layout, std::uint64_t v) {
    const auto numbers = [&](auto& vector, int n) {
      for (int i = 0; i < n; ++i) {
        if (!lines_.number(vector[i]))
          throw fail_line(fmt::format("vertex {} has fewer numbers than its keyword says, or something else,", v));
      }
    };
    numbers(mesh_.positions.emplace_back(), 3);
    if (layout.normals) numbers(mesh_.normals.emplace_back(), 3);
    if (layout.colors) {
      numbers(colors_.emplace_back(), 3);
      float alpha = 0;  // there or not
      const std::size_t left = words_left();
      if (left == (layout.uvs ? 3U : 1U) && !lines_.number(alpha)) throw fail_line("a colour is no number");
    }
    if (layout.uvs) numbers(mesh_.uvs.emplace_back(), 2);
    if (!lines_.at_end_of_line()) throw fail_line(fmt::format("vertex {} has more numbers than its keyword says", v));
  }
  std::size_t words_left() const {
    TextLines copy = lines_;
    std::size_t words = 0;
    for (; !copy.at_end_of_line(); ++words)
      copy.word();
    return words;
  }

  /// The numbers after the corners are the face's colour, which is left aside.
  void face(std::uint64_t f, std::uint64_t vertices, Faces& all) {
    std::uint64_t corners = 0;
    bool good = lines_.number(corners);
    all.begin();
    for (std::uint64_t c = 0; good && c < corners; ++c) {
      std::uint64_t vertex = 0;
      good = lines_.number(vertex) && vertex < vertices;
      all.corner(static_cast<std::uint32_t>(vertex));
    }
    if (!good) throw fail(fmt::format("face {} names a vertex that does not exist", f));
  }

  const fs::path& path_;
  TextLines lines_;
  std::size_t bytes_;
  RawMesh mesh_;
  std::vector<glm::vec3> colors_;
};

}  // namespace

RawMesh read_off(const fs::path& path) {
  const std::string text = mesh_bytes(path);
  return OffReader(path, text).read();
}

}  // namespace pellucid
