#include "gl/display/display.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <optional>
#include <sstream>
#include <utility>

#include <OpenColorIO/OpenColorIO.h>
#include <fmt/format.h>

#include "gl/display/display_config.hpp"
#include "gl/display/display_gpu.hpp"
#include "gl/display/tabulated_curves.hpp"
#include "gl/error.hpp"

namespace OCIO = OCIO_NAMESPACE;

namespace pellucid::gl {

namespace {

// Linear Rec. 709 to CIE XYZ with D65 white, from the standard's chromaticities.
constexpr std::array<double, 16> kRec709ToXyz = {0.4123907992659595,
                                                 0.35758433938387796,
                                                 0.1804807884018343,
                                                 0,
                                                 0.21263900587151036,
                                                 0.7151686787677559,
                                                 0.07219231536073371,
                                                 0,
                                                 0.01933081871559185,
                                                 0.11919477979462599,
                                                 0.9505321522496606,
                                                 0,
                                                 0,
                                                 0,
                                                 0,
                                                 1};

// The error's text on one line.
std::string one_line(const std::string& text) {
  std::istringstream words(text);
  std::string out, word;
  while (words >> word)
    out += (out.empty() ? "" : " ") + word;
  return out;
}

struct NamedConfig {
  OCIO::ConstConfigRcPtr config;
  std::string name;  // for messages
};

NamedConfig load_config() {
  const char* path = std::getenv("OCIO");
  const bool embedded = path == nullptr || *path == '\0';
  const std::string name = embedded ? "the embedded display config" : fmt::format("the config '{}' of $OCIO", path);
  try {
    OCIO::ConstConfigRcPtr config;
    if (embedded) {
      std::istringstream text{std::string(kDisplayConfig)};
      config = OCIO::Config::CreateFromStream(text);
    } else {
      config = OCIO::Config::CreateFromFile(path);
    }
    config->validate();
    return {config, name};
  } catch (const OCIO::Exception& error) {
    throw InputError(fmt::format("{}: {}", name, one_line(error.what())));
  }
}

// Names that published configs give to our working space.
constexpr const char* kLinearRec709Names[] = {"lin_rec709", "lin_rec709_scene",           "Linear Rec.709 (sRGB)",
                                              "lin_srgb",   "Utility - Linear - Rec.709", "Utility - Linear - sRGB"};

// The look acts on scene-linear pixels, before the view.
OCIO::TransformRcPtr with_look(const OCIO::DisplayViewTransformRcPtr& to_display, const char* space,
                               const std::string& look) {
  if (look.empty()) return to_display;
  const OCIO::LookTransformRcPtr first = OCIO::LookTransform::Create();
  first->setSrc(space);
  first->setDst(space);
  first->setLooks(look.c_str());
  const OCIO::GroupTransformRcPtr group = OCIO::GroupTransform::Create();
  group->appendTransform(first);
  group->appendTransform(to_display);
  return group;
}

// Scene-linear Rec. 709 → (display, view) of `config`. A config need not know our working space by name: the
// interchange role fixes the way there. A config with neither is taken at its word that `scene_linear` is what
// renderers produce.
OCIO::ConstTransformRcPtr make_transform(const NamedConfig& named, const std::string& display, const std::string& view,
                                         const std::string& look) {
  const OCIO::DisplayViewTransformRcPtr to_display = OCIO::DisplayViewTransform::Create();
  to_display->setDisplay(display.c_str());
  to_display->setView(view.c_str());
  for (const char* name : kLinearRec709Names) {
    if (named.config->getColorSpace(name) != nullptr) {
      to_display->setSrc(name);
      return with_look(to_display, name, look);
    }
  }
  if (named.config->hasRole("aces_interchange")) {
    const OCIO::MatrixTransformRcPtr to_xyz = OCIO::MatrixTransform::Create();
    to_xyz->setMatrix(kRec709ToXyz.data());
    const OCIO::BuiltinTransformRcPtr to_aces = OCIO::BuiltinTransform::Create();
    to_aces->setStyle("UTILITY - ACES-AP0_to_CIE-XYZ-D65_BFD");
    to_aces->setDirection(OCIO::TRANSFORM_DIR_INVERSE);
    to_display->setSrc("aces_interchange");
    const OCIO::GroupTransformRcPtr group = OCIO::GroupTransform::Create();
    group->appendTransform(to_xyz);
    group->appendTransform(to_aces);
    group->appendTransform(with_look(to_display, "aces_interchange", look));
    return group;
  }
  if (!named.config->hasRole(OCIO::ROLE_SCENE_LINEAR))
    throw InputError(
        fmt::format("{} has no colour space '{}' and no role 'aces_interchange' or 'scene_linear' to take "
                    "scene-linear pixels from",
                    named.name, kLinearRec709Names[0]));
  to_display->setSrc(OCIO::ROLE_SCENE_LINEAR);
  return with_look(to_display, OCIO::ROLE_SCENE_LINEAR, look);
}

std::vector<std::string> displays_of(const OCIO::Config& config) {
  std::vector<std::string> names;
  for (int i = 0; i < config.getNumDisplays(); ++i)
    names.emplace_back(config.getDisplay(i));
  return names;
}

std::vector<std::string> views_of(const OCIO::Config& config, const std::string& display) {
  std::vector<std::string> names;
  for (int i = 0; i < config.getNumViews(display.c_str()); ++i)
    names.emplace_back(config.getView(display.c_str(), i));
  return names;
}

std::vector<std::string> looks_of(const OCIO::Config& config) {
  std::vector<std::string> names;
  for (int i = 0; i < config.getNumLooks(); ++i)
    names.emplace_back(config.getLookNameByIndex(i));
  return names;
}

std::string choose(const std::string& wanted, const std::string& standard, const std::vector<std::string>& offered,
                   const std::string& what, const std::string& config) {
  if (offered.empty()) throw InputError(fmt::format("{} offers no {}", config, what));
  const std::string& name = wanted.empty() ? standard : wanted;
  if (std::find(offered.begin(), offered.end(), name) != offered.end()) return name;
  std::string list;
  for (const std::string& other : offered)
    list += (list.empty() ? "'" : ", '") + other + "'";
  throw InputError(fmt::format("{} has no {} '{}'; it offers {}", config, what, name, list));
}

const std::string kNone;  // of a moved-from transform

// Fast approximations of log, exp and pow would set the CPU apart from the GPU.
constexpr auto kOptimization =
    static_cast<OCIO::OptimizationFlags>(OCIO::OPTIMIZATION_VERY_GOOD & ~OCIO::OPTIMIZATION_FAST_LOG_EXP_POW);

}  // namespace

struct DisplayTransform::State {
  NamedConfig named;
  std::string display, view, look;
  OCIO::ConstProcessorRcPtr processor;
  OCIO::ConstCPUProcessorRcPtr cpu;
  std::optional<DisplayFunction> gpu;  // made by the first drawing: writing a PNG needs no GL

  DisplayFunction& function() {
    if (!gpu) gpu.emplace(with_tabulated_curves(named.config, processor)->getOptimizedGPUProcessor(kOptimization));
    return *gpu;
  }
};

DisplayTransform::DisplayTransform(const std::string& display, const std::string& view, const std::string& look)
    : state_(std::make_unique<State>()) {
  State& state = *state_;
  state.named = load_config();
  const OCIO::Config& config = *state.named.config;
  state.display = choose(display, config.getDefaultDisplay(), displays_of(config), "display", state.named.name);
  state.view = choose(view, config.getDefaultView(state.display.c_str()), views_of(config, state.display), "view",
                      fmt::format("display '{}' of {}", state.display, state.named.name));
  if (!look.empty()) state.look = choose(look, "", looks_of(config), "look", state.named.name);
  try {
    const OCIO::ConstTransformRcPtr transform = make_transform(state.named, state.display, state.view, state.look);
    state.processor = config.getProcessor(transform, OCIO::TRANSFORM_DIR_FORWARD);
    state.cpu = state.processor->getOptimizedCPUProcessor(kOptimization);
  } catch (const OCIO::Exception& error) {  // a LUT file that is missing or malformed, for one
    throw InputError(fmt::format("{}: {}", state.named.name, one_line(error.what())));
  }
}

DisplayTransform::~DisplayTransform() = default;
DisplayTransform::DisplayTransform(DisplayTransform&&) noexcept = default;
DisplayTransform& DisplayTransform::operator=(DisplayTransform&&) noexcept = default;

void DisplayTransform::apply(std::span<float> pixels, int channels) const {
  assert(state_ != nullptr && (channels == 3 || channels == 4));
  const auto stride = static_cast<std::size_t>(channels);
  assert(pixels.size() % stride == 0);
  if (pixels.empty()) return;
  // Described as RGB with gaps, RGBA keeps its alpha whatever the config's matrices do to the fourth channel.
  const auto count = static_cast<long>(pixels.size() / stride);
  const auto pixel_bytes = static_cast<std::ptrdiff_t>(stride * sizeof(float));
  OCIO::PackedImageDesc image(pixels.data(), count, 1, OCIO::CHANNEL_ORDERING_RGB, OCIO::BIT_DEPTH_F32, sizeof(float),
                              pixel_bytes, pixel_bytes * count);
  state_->cpu->apply(image);
}

void DisplayTransform::draw(const Texture& source, float exposure_ev) const {
  assert(state_ != nullptr);
  state_->function().draw(source, std::exp2(exposure_ev));
}

Program DisplayTransform::program(const std::string& label, const Stage& vertex, const Stage& fragment,
                                  const Defines& defines) const {
  assert(state_ != nullptr);
  return state_->function().program(label, vertex, fragment, defines);
}

void DisplayTransform::bind_luts() const {
  assert(state_ != nullptr);
  state_->function().bind_luts();
}

const std::string& DisplayTransform::display() const {
  return state_ ? state_->display : kNone;
}

const std::string& DisplayTransform::view() const {
  return state_ ? state_->view : kNone;
}

const std::string& DisplayTransform::look() const {
  return state_ ? state_->look : kNone;
}

std::vector<std::string> DisplayTransform::looks() const {
  return state_ ? looks_of(*state_->named.config) : std::vector<std::string>{};
}

std::vector<std::pair<std::string, std::string>> DisplayTransform::views() const {
  std::vector<std::pair<std::string, std::string>> pairs;
  if (!state_) return pairs;
  for (const std::string& display : displays_of(*state_->named.config))
    for (const std::string& view : views_of(*state_->named.config, display))
      pairs.emplace_back(display, view);
  return pairs;
}

void on_display_warning(std::function<void(const std::string&)> tell) {
  OCIO::SetLoggingFunction([tell = std::move(tell)](const char* message) {
    const std::string line = one_line(message);  // "[OpenColorIO Warning]: …"
    const auto head = line.find("]: ");
    tell("OpenColorIO: " + (head == std::string::npos ? line : line.substr(head + 3)));
  });
}

}  // namespace pellucid::gl
