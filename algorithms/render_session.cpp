#include "algorithms/render_session.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <limits>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "algorithms/parameter_names.hpp"
#include "algorithms/raster/forward_pass.hpp"
#include "algorithms/scene/view_text.hpp"
#include "gl/context.hpp"

namespace pellucid {
namespace {

nlohmann::json to_json(const Value& value) {
  return std::visit([](const auto& v) { return nlohmann::json(v); }, value);
}

// GL's rows start at the bottom, an image's at the top.
Image flipped(const std::vector<float>& texels, int width, int height, int stride, int channels) {
  Image image(width, height, channels);
  for (int y = 0; y < height; ++y) {
    const float* in =
        texels.data() + static_cast<std::size_t>(height - 1 - y) * static_cast<std::size_t>(width * stride);
    float* out = image.at(0, y);
    if (stride == channels) {
      std::copy_n(in, width * channels, out);
      continue;
    }
    for (int x = 0; x < width; ++x, in += stride, out += channels)
      std::copy_n(in, channels, out);
  }
  return image;
}

std::string techniques_that(bool TechniqueInfo::*draw) {
  std::string able;
  for (const TechniqueInfo& other : techniques()) {
    if (other.*draw) able += (able.empty() ? "" : ", ") + std::string(other.name);
  }
  return able.empty() ? "none" : able;
}

// A frame that silently lacks an object is worse than none.
void check_drawable(const Scene& scene, const TechniqueInfo& info) {
  for (const Instance& instance : scene.instances) {
    if (instance.relief >= 0 && !info.reliefs) {
      throw InputError(
          fmt::format("technique '{}' draws no reliefs, and '{}' of scene '{}' carries one; those that do: {}",
                      info.name, instance.name, scene.name, techniques_that(&TechniqueInfo::reliefs)));
    }
    if (material_of(scene, instance).optical() && !info.interfaces) {
      throw InputError(fmt::format(
          "technique '{}' draws no mirrors, metals or dielectrics, and '{}' of scene '{}' is one; those that do: {}",
          info.name, instance.name, scene.name, techniques_that(&TechniqueInfo::interfaces)));
    }
  }
}

}  // namespace

std::span<const CommonSettings> common_settings() {
  static const std::array<CommonSettings, 2> all{CommonSettings{"frame", &parameter_table<FrameSettings>()},
                                                 CommonSettings{"shadow", &parameter_table<ShadowSettings>()}};
  return all;
}

struct RenderSession::State {
  Scene scene;
  const TechniqueInfo* info;
  std::unique_ptr<Technique> technique;
  FrameSettings frame;
  ShadowSettings shadow;
  Camera camera;
  ForwardPass forward;
  gl::Texture color, depth;
  gl::Framebuffer framebuffer;
  // With supersampling: the pixels, the means of the samples above.
  gl::Texture pixels;
  gl::Framebuffer pixel_framebuffer;
  gl::Program mean;
  gl::VertexArray fullscreen{"fullscreen"};
  bool prepared = false;
  bool meshes_changed = false;

  State(Scene loaded, std::string_view technique_name)
      : scene(std::move(loaded)), info(&find_technique(technique_name)), technique(info->make()), forward(scene) {}

  /// An owner's table, and its name in messages.
  std::pair<ParameterRef, std::string> table_of(ParameterOwner owner) {
    switch (owner) {
      case ParameterOwner::scene:
        return {scene.parameters(), "scene " + scene.name};
      case ParameterOwner::frame:
        return {bind_parameters(frame), "frame"};
      case ParameterOwner::shadow:
        return {bind_parameters(shadow), "shadow"};
      case ParameterOwner::technique:
        break;
    }
    return {technique->parameters(), std::string(info->name)};
  }

  void update_forward() {
    forward.update(scene, meshes_changed);
    meshes_changed = false;
  }

  // The camera of the samples: as many times larger as there are samples along a pixel's side.
  Camera sample_camera() const {
    Camera larger = camera;
    larger.width *= frame.supersampling;
    larger.height *= frame.supersampling;
    return larger;
  }

  void check_size() const {
    const Camera samples = sample_camera();
    const int limit = gl::limits().max_texture_size;
    if (samples.width <= limit && samples.height <= limit) return;
    throw InputError(fmt::format("image size {}x{}{} exceeds this device's limit of {}", samples.width, samples.height,
                                 frame.supersampling > 1 ? fmt::format(" ({}x{} at frame.supersampling = {})",
                                                                       camera.width, camera.height, frame.supersampling)
                                                         : "",
                                 limit));
  }

  void fit_target() {
    check_size();
    const gl::Format format = frame.format == FrameFormat::half ? gl::Format::rgba16f : gl::Format::rgba32f;
    const auto fits = [&](const gl::Texture& texture, const Camera& size) {
      return texture && texture.width() == size.width && texture.height() == size.height && texture.format() == format;
    };
    const Camera samples = sample_camera();
    if (!fits(color, samples)) {
      color = gl::Texture::make_2d("frame colour", format, samples.width, samples.height);
      color.set_sampling(gl::Filter::nearest, gl::Wrap::clamp);
      depth = gl::Texture::make_2d("frame depth", gl::Format::depth32f, samples.width, samples.height);
      framebuffer = gl::Framebuffer("frame", {&color}, &depth);
    }
    if (frame.supersampling == 1 && pixels) {
      pixels = {};
      pixel_framebuffer = {};
      mean = {};
    }
    if (frame.supersampling > 1 && !fits(pixels, camera)) {
      pixels = gl::Texture::make_2d("frame pixels", format, camera.width, camera.height);
      pixels.set_sampling(gl::Filter::nearest, gl::Wrap::clamp);
      pixel_framebuffer = gl::Framebuffer("frame pixels", {&pixels}, nullptr);
    }
  }

  void average_samples() {
    if (!mean) {
      mean = gl::Program("mean of samples",
                         {"algorithms/shaders/fullscreen.vert.glsl", "algorithms/shaders/mean_of_samples.frag.glsl"});
    }
    pixel_framebuffer.bind();
    glDisable(GL_BLEND);
    glDisable(GL_DEPTH_TEST);
    mean.use();
    mean.set("samples", frame.supersampling);
    color.bind(0);
    fullscreen.bind();
    glDrawArrays(GL_TRIANGLES, 0, 3);
  }

  const gl::Texture& shown() const { return frame.supersampling > 1 ? pixels : color; }
};

RenderSession::RenderSession(Scene scene, std::string_view technique, std::string_view view, int width, int height)
    : state_(std::make_unique<State>(std::move(scene), technique)) {
  check_drawable(state_->scene, *state_->info);
  state_->camera.view = view_of(state_->scene, view);
  resize(width, height);
}
RenderSession::~RenderSession() = default;
RenderSession::RenderSession(RenderSession&&) noexcept = default;
RenderSession& RenderSession::operator=(RenderSession&&) noexcept = default;

Change RenderSession::assign(std::string_view name, const Value& value) {
  const ParameterName routed = route(name);
  const auto [table, owner] = state_->table_of(routed.owner);
  const bool of_scene = routed.owner == ParameterOwner::scene;
  const Change change = table.assign(routed.local, value, owner);
  if (change == Change::precompute) {
    state_->prepared = false;
    state_->meshes_changed = state_->meshes_changed || of_scene;
  }
  // A view may be animated by the scene's parameters.
  state_->camera.view = view_of(state_->scene, state_->camera.view.name);
  return change;
}

Change RenderSession::assign_text(std::string_view name, std::string_view text) {
  const ParameterName routed = route(name);
  const auto [table, owner] = state_->table_of(routed.owner);
  const ParameterInfo* info = table.table->find(routed.local);
  if (info == nullptr) throw unknown_parameter(routed.local, owner, table.infos());
  return assign(name, parse_value(*info, text, owner));
}

nlohmann::json RenderSession::parameters() const {
  nlohmann::json all = nlohmann::json::object();
  for (const ParameterOwner owner :
       {ParameterOwner::technique, ParameterOwner::scene, ParameterOwner::frame, ParameterOwner::shadow}) {
    const ParameterRef table = state_->table_of(owner).first;
    for (const ParameterInfo& info : table.infos())
      all[full_name(owner, info.name)] = to_json(table.get(info.name));
  }
  return all;
}

void RenderSession::set_view(const View& view) {
  state_->camera.view = view;
}

void RenderSession::resize(int width, int height) {
  check_image_size(width, height, "image");
  state_->camera.width = width;
  state_->camera.height = height;
  state_->check_size();
}

double RenderSession::prepare() {
  State& s = *state_;
  s.update_forward();
  if (s.prepared) return 0;
  const auto start = std::chrono::steady_clock::now();
  s.technique->prepare(s.scene);
  glFinish();
  s.prepared = true;
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void RenderSession::render(gl::PassTimer& timer) {
  prepare();
  State& s = *state_;
  s.fit_target();
  timer.begin_frame();
  if (s.forward.shadowed()) {
    auto pass = timer.pass("shadow maps");
    s.forward.update_shadows(s.scene, s.shadow);
  }
  s.technique->render(s.scene, s.sample_camera(), s.forward, Target{s.color, s.depth, s.framebuffer}, timer);
  if (s.frame.supersampling > 1) {
    auto pass = timer.pass("mean of samples");
    s.average_samples();
  }
  timer.end_frame();
  s.forward.end_frame();
  gl::check("render", s.info->name);
}

Image RenderSession::read_color() const {
  const gl::Texture& color = state_->shown();
  return flipped(color.read(), color.width(), color.height(), 4, 4);
}

SurfaceLayer RenderSession::raster_surfaces(bool shadow_maps) {
  State& s = *state_;
  s.update_forward();
  if (shadow_maps) s.forward.update_shadows(s.scene, s.shadow);
  const int width = s.camera.width, height = s.camera.height;
  const gl::Texture color = gl::Texture::make_2d("surface colour", gl::Format::rgba32f, width, height);
  const gl::Texture distance = gl::Texture::make_2d("surface distance", gl::Format::r32f, width, height);
  const gl::Texture depth = gl::Texture::make_2d("surface depth", gl::Format::depth32f, width, height);
  auto read_distance = [&] {
    const Image metres = flipped(distance.read(), width, height, 1, 1);
    return std::vector<double>(metres.pixels.begin(), metres.pixels.end());
  };
  if (shadow_maps || !s.forward.shadowed()) {
    const gl::Framebuffer framebuffer("surfaces", {&color, &distance}, &depth);
    framebuffer.bind();
    s.forward.draw_shaded(s.camera, false);
    gl::check("raster_surfaces", s.info->name);
    SurfaceLayer layer;
    layer.radiance = flipped(color.read(), width, height, 4, 3);
    layer.distance_m = read_distance();
    return layer;
  }
  // Shadow maps err, and the reference must not: it shades the points itself.
  const gl::Texture normal = gl::Texture::make_2d("surface normal", gl::Format::rgba32f, width, height);
  const gl::Texture emission = gl::Texture::make_2d("surface emission", gl::Format::rgba32f, width, height);
  const gl::Framebuffer framebuffer("surface points", {&color, &distance, &normal, &emission}, &depth);
  framebuffer.bind();
  for (int attachment : {0, 2, 3})
    framebuffer.clear_color(attachment, {0, 0, 0, 0});
  framebuffer.clear_color(1, {std::numeric_limits<float>::infinity(), 0, 0, 0});
  s.forward.draw_surface_points(s.camera);
  gl::check("raster_surfaces", s.info->name);
  return shade_surfaces(s.scene, s.camera,
                        {flipped(color.read(), width, height, 4, 3), flipped(normal.read(), width, height, 4, 3),
                         flipped(emission.read(), width, height, 4, 3), read_distance()});
}

Scene& RenderSession::scene() {
  return state_->scene;
}
const Camera& RenderSession::camera() const {
  return state_->camera;
}
Technique& RenderSession::technique() {
  return *state_->technique;
}
const TechniqueInfo& RenderSession::technique_info() const {
  return *state_->info;
}
const gl::Texture& RenderSession::color() const {
  return state_->shown();
}

std::string RenderSession::reload_shaders() {
  return state_->forward.reload_shaders() + state_->technique->reload_shaders();
}

}  // namespace pellucid
