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
class DisplayFunction {
 public:
  explicit DisplayFunction(const OCIO_NAMESPACE::ConstGPUProcessorRcPtr& processor);
  /// A program whose fragment shader calls `vec4 ocio_display(vec4 scene_linear)`.
  Program program(const std::string& label, const Stage& vertex, const Stage& fragment, const Defines&) const;
  void bind_luts() const;
  void draw(const Texture& source, float gain);

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
  std::string text_;
  std::vector<Lut> luts_;
  std::vector<std::string> samplers_;  // of the LUTs
  Program program_;                    // made by the first draw()
  VertexArray triangle_;
};

}  // namespace pellucid::gl
