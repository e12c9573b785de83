#include "sweeps/bench/vtk_volume.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include <vtkAutoInit.h>
#include <vtkCamera.h>
#include <vtkCellData.h>
#include <vtkColorTransferFunction.h>
#include <vtkFloatArray.h>
#include <vtkGenericOpenGLRenderWindow.h>
#include <vtkImageData.h>
#include <vtkMatrix4x4.h>
#include <vtkNew.h>
#include <vtkOpenGLFramebufferObject.h>
#include <vtkOpenGLGPUVolumeRayCastMapper.h>
#include <vtkPiecewiseFunction.h>
#include <vtkPixelBufferObject.h>
#include <vtkRenderer.h>
#include <vtkTextureObject.h>
#include <vtkVolume.h>
#include <vtkVolumeProperty.h>

#include "gl/error.hpp"

VTK_MODULE_INIT(vtkRenderingOpenGL2)
VTK_MODULE_INIT(vtkRenderingVolumeOpenGL2)

// GLEW, which VTK loads OpenGL through, asks for a GLX display at the end and fails without one although its functions
// for OpenGL itself are then loaded. The executables export this in its place.
extern "C" unsigned glxewInit();
extern "C" unsigned glxewInit() {
  return 0;
}

namespace pellucid::sweeps {
namespace {

constexpr int kOpacityPoints = 1025;

float extinction(const Volume& volume, float density) {
  const auto& transfer = volume.transfer;
  if (transfer.empty()) return volume.extinction * density;
  if (density <= transfer.front().density) return volume.extinction * transfer.front().extinction;
  for (std::size_t i = 1; i < transfer.size(); ++i) {
    const TransferPoint &a = transfer[i - 1], &b = transfer[i];
    if (density > b.density) continue;
    return volume.extinction * glm::mix(a.extinction, b.extinction, (density - a.density) / (b.density - a.density));
  }
  return volume.extinction * transfer.back().extinction;
}

// VTK takes distances before the volume's matrix, so the image carries the box's size and the matrix only turns it.
struct Placement {
  std::array<double, 3> size_m{};
  vtkNew<vtkMatrix4x4> turn;

  explicit Placement(const glm::mat4& to_world) {
    const glm::dmat4 m(to_world);
    for (int i = 0; i < 3; ++i) {
      size_m[static_cast<std::size_t>(i)] = glm::length(glm::dvec3(m[i]));
      for (int j = 0; j < i; ++j) {
        const double cosine = glm::dot(glm::normalize(glm::dvec3(m[i])), glm::normalize(glm::dvec3(m[j])));
        if (std::abs(cosine) > 1e-4) throw RuntimeError("the box's edges are not perpendicular, as VTK needs them");
      }
    }
    for (int column = 0; column < 4; ++column) {
      const double scale = column < 3 ? 1 / size_m[static_cast<std::size_t>(column)] : 1.0;
      for (int row = 0; row < 3; ++row)
        turn->SetElement(row, column, m[column][row] * scale);
    }
  }
};

}  // namespace

struct VtkVolume::State {
  vtkNew<vtkGenericOpenGLRenderWindow> window;
  vtkNew<vtkRenderer> renderer;
  vtkNew<vtkOpenGLGPUVolumeRayCastMapper> mapper;
  vtkNew<vtkVolume> actor;
  int width = 0, height = 0;

  void open_window(const Camera& camera) {
    width = camera.width;
    height = camera.height;
    window->SetOwnContext(0);
    window->SetReadyForRendering(true);
    window->SetSupportsOpenGL(1);
    window->SetIsDirect(1);
    window->SetIsCurrent(true);
    window->SetFrameBlitModeToNoBlit();
    window->SetMultiSamples(0);
    window->SetSize(width, height);
    window->OpenGLInit();
    window->AddRenderer(renderer);
  }

  // VTK makes its frame with 8 bits a channel at the first rendering, and keeps another.
  void widen_frame() {
    window->Render();
    constexpr int kDepthBits = 24;
    if (!window->GetRenderFramebuffer()->PopulateFramebuffer(width, height, true, 1, VTK_FLOAT, true, kDepthBits, 0)) {
      throw RuntimeError("VTK cannot draw into 32-bit floats on this device");
    }
  }

  void look(const Camera& camera, double reach_m) {
    const View& view = camera.view;
    vtkCamera* eye = renderer->GetActiveCamera();
    eye->SetPosition(static_cast<double>(view.eye.x), static_cast<double>(view.eye.y), static_cast<double>(view.eye.z));
    eye->SetFocalPoint(static_cast<double>(view.target.x), static_cast<double>(view.target.y),
                       static_cast<double>(view.target.z));
    eye->SetViewUp(static_cast<double>(view.up.x), static_cast<double>(view.up.y), static_cast<double>(view.up.z));
    eye->SetViewAngle(static_cast<double>(view.fov_y_deg));
    // The far plane cuts objects, not our media.
    eye->SetClippingRange(static_cast<double>(view.near_m), std::max(static_cast<double>(view.far_m), reach_m));
  }

  void fill(const Volume& volume, const Placement& placement) {
    vtkNew<vtkImageData> image;
    image->SetDimensions(volume.size.x + 1, volume.size.y + 1, volume.size.z + 1);
    image->SetSpacing(placement.size_m[0] / volume.size.x, placement.size_m[1] / volume.size.y,
                      placement.size_m[2] / volume.size.z);
    vtkNew<vtkFloatArray> density;
    density->SetName("density");
    density->SetNumberOfValues(static_cast<vtkIdType>(volume.density.size()));
    std::copy(volume.density.begin(), volume.density.end(), density->GetPointer(0));
    image->GetCellData()->SetScalars(density);

    mapper->SetInputData(image);
    mapper->SetScalarModeToUseCellData();
    mapper->SetBlendModeToComposite();
    mapper->SetAutoAdjustSampleDistances(0);
    mapper->SetLockSampleDistanceToInputSpacing(0);
    mapper->SetUseJittering(0);

    const float greatest =
        std::max(*std::max_element(volume.density.begin(), volume.density.end()), std::numeric_limits<float>::min());
    float most = 0;
    for (int i = 0; i < kOpacityPoints; ++i)
      most = std::max(most, extinction(volume, greatest * static_cast<float>(i) / (kOpacityPoints - 1)));
    // At this distance no opacity is so near to 1 that VTK's table could not tell it from 1.
    const double unit_m = most > 0 ? 1 / static_cast<double>(most) : 1.0;
    vtkNew<vtkPiecewiseFunction> opacity;
    for (int i = 0; i < kOpacityPoints; ++i) {
      const float at = greatest * static_cast<float>(i) / (kOpacityPoints - 1);
      opacity->AddPoint(static_cast<double>(at), -std::expm1(-static_cast<double>(extinction(volume, at)) * unit_m));
    }
    vtkNew<vtkColorTransferFunction> white;
    white->AddRGBPoint(0, 1, 1, 1);
    white->AddRGBPoint(static_cast<double>(greatest), 1, 1, 1);
    vtkNew<vtkVolumeProperty> property;
    property->SetScalarOpacity(opacity);
    property->SetScalarOpacityUnitDistance(unit_m);
    property->SetColor(white);
    property->SetInterpolationTypeToLinear();
    property->ShadeOff();
    actor->SetMapper(mapper);
    actor->SetProperty(property);
    actor->SetUserMatrix(placement.turn);
    renderer->AddVolume(actor);
  }
};

VtkVolume::VtkVolume(const Volume& volume, const Camera& camera) : state_(std::make_unique<State>()) {
  const Placement placement(volume.to_world);
  State& s = *state_;
  s.renderer->SetBackground(0, 0, 0);
  s.fill(volume, placement);
  const glm::vec3 middle = volume.to_world * glm::vec4(0.5F, 0.5F, 0.5F, 1.0F);
  const double diagonal = std::hypot(placement.size_m[0], placement.size_m[1], placement.size_m[2]);
  s.look(camera, static_cast<double>(glm::distance(camera.view.eye, middle)) + diagonal);
  s.mapper->SetSampleDistance(static_cast<float>(diagonal / 2));
  s.open_window(camera);
  s.widen_frame();
}

VtkVolume::~VtkVolume() {
  state_->window->Finalize();
}

void VtkVolume::set_sample_distance(double metres) {
  state_->mapper->SetSampleDistance(static_cast<float>(metres));
}

void VtkVolume::render() {
  state_->window->Render();
}

Image VtkVolume::read_color() const {
  vtkTextureObject* frame = state_->window->GetRenderFramebuffer()->GetColorAttachmentAsTextureObject(0);
  std::array<unsigned int, 2> size{static_cast<unsigned int>(state_->width), static_cast<unsigned int>(state_->height)};
  const std::size_t row = static_cast<std::size_t>(size[0]) * 4;
  std::vector<float> texels(row * size[1]);
  vtkPixelBufferObject* transfer = frame->Download();
  std::array<vtkIdType, 2> gaps{0, 0};
  const bool done = transfer->Download2D(VTK_FLOAT, texels.data(), size.data(), 4, gaps.data());
  transfer->Delete();
  if (!done) throw RuntimeError("VTK does not give its frame back");
  Image image(state_->width, state_->height, 3);
  for (int y = 0; y < state_->height; ++y) {
    const float* in = texels.data() + static_cast<std::size_t>(state_->height - 1 - y) * row;
    for (int x = 0; x < state_->width; ++x, in += 4)
      std::copy_n(in, 3, image.at(x, y));
  }
  return image;
}

}  // namespace pellucid::sweeps
