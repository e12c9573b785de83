#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include <OpenColorIO/OpenColorIO.h>

#include "gl/objects.hpp"
#include "gl/program.hpp"

namespace pellucid::gl {

/// OpenColorIO's GPU form of a processor: its generated function, and its LUTs as textures. Belongs to the GL context
/// in which it was made.
class DisplayProgram {
 public:
  explicit DisplayProgram(const OCIO_NAMESPACE::ConstGPUProcessorRcPtr& processor);
  void draw(const Texture& source, float gain) const;
  int lut_count() const { return static_cast<int>(luts_.size()); }

 private:
  struct Lut {
    Lut(std::string label, GLenum target, GLenum internal_format, const std::array<int, 3>& size, bool smooth);
    ~Lut();
    Lut(Lut&& other) noexcept;
    Lut& operator=(Lut&&) = delete;
    void upload(GLenum pixel_format, const float* values, const std::array<int, 3>& size) const;

    Handle<delete_texture> handle;
    GLenum target;
    std::size_t bytes;
    std::string label;
  };
  Handle<delete_program> program_;
  VertexArray triangle_;
  std::vector<Lut> luts_;
  GLint gain_ = -1;
};

}  // namespace pellucid::gl
