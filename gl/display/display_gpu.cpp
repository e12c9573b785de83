#include "gl/display/display_gpu.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>
#include <utility>

#include <fmt/format.h>

#include "gl/context.hpp"
#include "gl/label.hpp"

namespace OCIO = OCIO_NAMESPACE;

namespace pellucid::gl {

namespace {

// Units below are for the pictures that a shader reads.
constexpr GLuint kFirstLutUnit = 4;

// Full-screen drawing needs these off; the viewer's other passes keep what they had set.
class PlainRaster {
 public:
  PlainRaster() {
    for (std::size_t i = 0; i < kStates.size(); ++i) {
      was_[i] = glIsEnabled(kStates[i]) == GL_TRUE;
      glDisable(kStates[i]);
    }
  }
  ~PlainRaster() {
    for (std::size_t i = 0; i < kStates.size(); ++i)
      if (was_[i]) glEnable(kStates[i]);
  }
  PlainRaster(const PlainRaster&) = delete;
  PlainRaster& operator=(const PlainRaster&) = delete;

 private:
  static constexpr std::array<GLenum, 4> kStates = {GL_DEPTH_TEST, GL_BLEND, GL_CULL_FACE, GL_SCISSOR_TEST};
  std::array<bool, kStates.size()> was_{};
};

}  // namespace

DisplayFunction::Lut::Lut(std::string name, GLenum kind, GLenum internal_format, const std::array<int, 3>& size,
                          bool smooth)
    : target(kind),
      bytes(sizeof(float) * static_cast<std::size_t>(internal_format == GL_R32F ? 1 : 4) *
            static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]) * static_cast<std::size_t>(size[2])),
      label(std::move(name)) {
  GLuint id = 0;
  glCreateTextures(target, 1, &id);
  handle = Handle<delete_texture>(id);
  set_label(GL_TEXTURE, id, label);
  if (target == GL_TEXTURE_1D) glTextureStorage1D(id, 1, internal_format, size[0]);
  if (target == GL_TEXTURE_2D) glTextureStorage2D(id, 1, internal_format, size[0], size[1]);
  if (target == GL_TEXTURE_3D) glTextureStorage3D(id, 1, internal_format, size[0], size[1], size[2]);
  const GLint filter = smooth ? GL_LINEAR : GL_NEAREST;
  glTextureParameteri(id, GL_TEXTURE_MIN_FILTER, filter);
  glTextureParameteri(id, GL_TEXTURE_MAG_FILTER, filter);
  for (const GLenum axis : std::array<GLenum, 3>{GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R})
    glTextureParameteri(id, axis, GL_CLAMP_TO_EDGE);
  check("allocate the display transform's LUT", label);
  account_bytes(static_cast<std::ptrdiff_t>(bytes));
}

DisplayFunction::Lut::~Lut() {
  if (handle.id() != 0) account_bytes(-static_cast<std::ptrdiff_t>(bytes));
}

DisplayFunction::Lut::Lut(Lut&& other) noexcept
    : handle(std::move(other.handle)), target(other.target), bytes(other.bytes), label(std::move(other.label)) {}

void DisplayFunction::Lut::upload(GLenum pixel_format, const float* values, const std::array<int, 3>& size) const {
  const GLuint id = handle.id();
  if (target == GL_TEXTURE_1D) glTextureSubImage1D(id, 0, 0, size[0], pixel_format, GL_FLOAT, values);
  if (target == GL_TEXTURE_2D) glTextureSubImage2D(id, 0, 0, 0, size[0], size[1], pixel_format, GL_FLOAT, values);
  if (target == GL_TEXTURE_3D)
    glTextureSubImage3D(id, 0, 0, 0, 0, size[0], size[1], size[2], pixel_format, GL_FLOAT, values);
  check("upload the display transform's LUT", label);
}

DisplayFunction::DisplayFunction(const OCIO::ConstGPUProcessorRcPtr& processor) {
  OCIO::GpuShaderDescRcPtr desc = OCIO::GpuShaderDesc::CreateShaderDesc();
  desc->setLanguage(OCIO::GPU_LANGUAGE_GLSL_4_0);
  desc->setFunctionName("ocio_display");
  desc->setResourcePrefix("ocio_");
  desc->setTextureMaxWidth(static_cast<unsigned>(limits().max_texture_size));
  processor->extractGpuShaderInfo(desc);
  assert(desc->getNumUniforms() == 0 && "dynamic properties are baked in");

  bool all_smooth = true;
  for (unsigned i = 0; i < desc->getNumTextures(); ++i) {
    const char *name = nullptr, *sampler = nullptr;
    unsigned width = 0, height = 0;
    OCIO::GpuShaderDesc::TextureType channel = OCIO::GpuShaderDesc::TEXTURE_RGB_CHANNEL;
    OCIO::Interpolation interpolation = OCIO::INTERP_LINEAR;
    desc->getTexture(i, name, sampler, width, height, channel, interpolation);
    const float* values = nullptr;
    desc->getTextureValues(i, values);
    const std::array<int, 3> size = {static_cast<int>(width), static_cast<int>(std::max(1U, height)), 1};
    const bool red = channel == OCIO::GpuShaderDesc::TEXTURE_RED_CHANNEL;
    all_smooth = all_smooth && interpolation != OCIO::INTERP_NEAREST;
    // A LUT that fits one row is declared sampler1D, a longer one sampler2D.
    luts_.emplace_back(name, size[1] > 1 ? GL_TEXTURE_2D : GL_TEXTURE_1D, red ? GL_R32F : GL_RGBA32F, size,
                       interpolation != OCIO::INTERP_NEAREST);
    luts_.back().upload(red ? GL_RED : GL_RGB, values, size);
    samplers_.emplace_back(sampler);
  }
  for (unsigned i = 0; i < desc->getNum3DTextures(); ++i) {
    const char *name = nullptr, *sampler = nullptr;
    unsigned edge = 0;
    OCIO::Interpolation interpolation = OCIO::INTERP_LINEAR;
    desc->get3DTexture(i, name, sampler, edge, interpolation);
    const float* values = nullptr;
    desc->get3DTextureValues(i, values);
    const std::array<int, 3> size = {static_cast<int>(edge), static_cast<int>(edge), static_cast<int>(edge)};
    all_smooth = all_smooth && interpolation != OCIO::INTERP_NEAREST;
    luts_.emplace_back(name, GL_TEXTURE_3D, GL_RGBA32F, size, interpolation != OCIO::INTERP_NEAREST);
    luts_.back().upload(GL_RGB, values, size);
    samplers_.emplace_back(sampler);
  }

  // A LUT with nearest look-up needs the texture unit's own filter.
  if (all_smooth) text_ = "#define texture lut_texture\n";
  text_ += desc->getShaderText();
}

Program DisplayFunction::program(const std::string& label, const Stage& vertex, const Stage& fragment,
                                 const Defines& defines) const {
  Program made(label, {vertex, fragment}, defines, text_);
  for (std::size_t i = 0; i < samplers_.size(); ++i)
    made.set(samplers_[i], static_cast<int>(kFirstLutUnit) + static_cast<int>(i));
  return made;
}

void DisplayFunction::bind_luts() const {
  for (std::size_t i = 0; i < luts_.size(); ++i)
    glBindTextureUnit(kFirstLutUnit + static_cast<GLuint>(i), luts_[i].handle.id());
}

void DisplayFunction::draw(const Texture& source, float gain) {
  if (!program_) {
    program_ = program("display transform", "gl/display/display.vert.glsl", "gl/display/display.frag.glsl", {});
    triangle_ = VertexArray("display transform");
  }
  const PlainRaster plain;
  source.bind(0);
  bind_luts();
  program_.use();
  program_.set("gain", gain);
  triangle_.bind();
  glDrawArrays(GL_TRIANGLES, 0, 3);
  check("draw", "display transform");
}

}  // namespace pellucid::gl
