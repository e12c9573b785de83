// VTK's picture of a volume against ours and against the reference.
#include "sweeps/bench/vtk_volume.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "algorithms/reference/reference.hpp"
#include "algorithms/render_session.hpp"
#include "gl/context.hpp"
#include "gl/error.hpp"

namespace pellucid::sweeps {
namespace {

constexpr int kVoxels = 40;

// A homogeneous ball in a turned box that is no cube, white in a black world.
Scene ball() {
  Scene scene;
  scene.name = "ball";
  Volume volume;
  volume.name = "ball";
  volume.size = {kVoxels, kVoxels, kVoxels};
  for (int z = 0; z < kVoxels; ++z) {
    for (int y = 0; y < kVoxels; ++y) {
      for (int x = 0; x < kVoxels; ++x) {
        const glm::vec3 p = (glm::vec3(x, y, z) + 0.5F) / static_cast<float>(kVoxels) - 0.5F;
        volume.density.push_back(glm::length(p) < 0.4F ? 1.0F : 0.0F);
      }
    }
  }
  volume.extinction = 1.5F;
  volume.albedo = glm::vec3(1.0F);
  volume.to_world = glm::rotate(glm::mat4(1.0F), 0.5F, glm::normalize(glm::vec3(0.2F, 1.0F, 0.3F))) *
                    glm::scale(glm::mat4(1.0F), glm::vec3(2.0F, 1.5F, 2.5F)) *
                    glm::translate(glm::mat4(1.0F), glm::vec3(-0.5F));
  scene.volume = volume;
  scene.ambient = glm::vec3(1.0F);
  scene.views.push_back({.name = "front", .eye = {0.4F, 0.5F, 5.0F}, .target = {0.1F, 0.0F, 0.0F}, .fov_y_deg = 32.0F});
  return scene;
}

struct Difference {
  double max = 0, mean = 0;
};
Difference difference(const Image& a, const Image& b) {
  Difference d;
  for (int y = 0; y < a.height; ++y) {
    for (int x = 0; x < a.width; ++x) {
      for (int c = 0; c < 3; ++c) {
        const double e = std::abs(static_cast<double>(a.at(x, y)[c]) - static_cast<double>(b.at(x, y)[c]));
        d.max = std::max(d.max, e);
        d.mean += e / (3.0 * a.width * a.height);
      }
    }
  }
  return d;
}

class VtkPicture : public testing::Test {
 protected:
  VtkPicture() : session(ball(), "sampling_hulls", "", 96, 72) {
    for (const auto& [name, value] :
         {std::pair{"samples", "64"}, {"sample_offset", "0.5"}, {"coordinates", "single"}, {"frame.format", "single"}})
      session.assign_text(name, value);
    gl::PassTimer timer;
    session.render(timer);
    ours = session.read_color();
    reference = render_reference(session.scene(), session.camera(), session.raster_surfaces()).image;
  }
  Image theirs(double sample_distance_m) {
    gl::Context other({.device = {}, .debug = false});
    Image image;
    {
      VtkVolume volume(*session.scene().volume, session.camera());
      volume.set_sample_distance(sample_distance_m);
      volume.render();
      image = volume.read_color();
    }
    return image;
  }

  gl::Context context;
  RenderSession session;
  Image ours, reference;
};

// VTK's ray starts at the box and ends before it, by a part of a step, and its table of opacities has 1,024 entries:
// a step of 4 mm in fog of 1.5 per metre is worth 6e-3.
TEST_F(VtkPicture, AgreesWithOursOnAHomogeneousBall) {
  const Image fine = theirs(0.004);
  context.make_current();
  EXPECT_GT(reference.at(48, 36)[0], 0.8F) << "the ball is seen";
  const Difference to_reference = difference(fine, reference), to_ours = difference(fine, ours);
  EXPECT_LT(to_reference.max, 1e-2);
  EXPECT_LT(to_reference.mean, 1e-3);
  EXPECT_LT(to_ours.max, 1e-2);
  EXPECT_LT(to_ours.mean, 1e-3);
}

TEST_F(VtkPicture, ErrsMoreWithALongerSampleDistance) {
  const double fine = difference(theirs(0.01), reference).mean, coarse = difference(theirs(0.3), reference).mean;
  context.make_current();
  EXPECT_GT(coarse, 3 * fine);
}

TEST_F(VtkPicture, LeavesOurContextAsItWas) {
  theirs(0.1);
  context.make_current();
  gl::PassTimer timer;
  session.render(timer);
  EXPECT_EQ(difference(session.read_color(), ours).max, 0.0);
}

TEST_F(VtkPicture, RefusesAShearedBox) {
  Volume& volume = *session.scene().volume;
  volume.to_world[0] += 0.3F * volume.to_world[1];
  gl::Context other({.device = {}, .debug = false});
  EXPECT_THROW(VtkVolume(volume, session.camera()), RuntimeError);
}

}  // namespace
}  // namespace pellucid::sweeps
