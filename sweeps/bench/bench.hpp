#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "sweeps/measure/stopping.hpp"

namespace pellucid {
struct BareFrameInfo;
struct TechniqueInfo;
namespace gl {
class Context;
}
}  // namespace pellucid

/// The cost of a technique's frame beside the least that its texture fetches and blends could cost: a bare shader over
/// the same pixels, timed on the same device in the same run.
namespace pellucid::sweeps {

struct BenchRequest {
  std::string scene, view;  ///< empty: the technique's own scene, and the first view
  int width = 720;
  int height = 540;
  std::vector<std::pair<std::string, std::string>> settings;  ///< name and value, as RenderSession::assign_text takes
  int frames = 60;                                            ///< timed of each subject, rounded up to whole blocks
  bool reference = true;                                      ///< time the reference's tracing too, where there is one
};

/// The statistics of blocks that alternate between the subjects, so that a drift of the clock rate reaches them all:
/// the median over the blocks of a ratio of the blocks' medians, and its bootstrap interval.
struct BenchRatio {
  double median = 0;
  Interval ci95;
};

/// The ground truth of the same picture by ray tracing on all cores of the processor: one tree of rays through each
/// pixel's centre, which follows as many interfaces as the frame shows. One picture is traced between any two blocks.
struct BenchReference {
  TimingSummary trace;        ///< tracing and shading alone
  double build_ms = 0;        ///< Embree's hierarchy, which `trace` leaves out, as a frame leaves out its preparation
  BenchRatio ratio;           ///< trace / method
  double rays_per_pixel = 0;  ///< with those to the lights
  int depth = 0;              ///< interfaces along a path, at most
  int reflections = 0;        ///< inside a dielectric, at most
};

struct BenchResult {
  static constexpr int kBlockFrames = 4;
  int frames = 0;                 ///< timed of each subject
  TimingSummary method, bare;     ///< whole frames
  TimingSummary opaque;           ///< the passes over opaque objects that both share, alone
  BenchRatio ratio;               ///< method / bare
  std::optional<BenchRatio> own;  ///< (method − opaque) / (bare − opaque); nothing where the noise hides the hulls
  std::string clock;              ///< gl::name(Clock)
  double blends_per_pixel = 0;    ///< front faces that passed the depth test, over all pixels of the image
  double fetches_per_blend = 0;   ///< of the bare shader; an upper bound of the method's where light is shadowed
  double fetches_per_pixel = 0;   ///< their product
  std::optional<BenchReference> reference;  ///< nothing where it is not asked for, or there is none
};

/// Throws InputError for a request that cannot be met (a technique without a bare frame too), RuntimeError when the
/// clock gives no usable time. Needs a current GL context. `recipe` receives what was drawn: scene, view, size and
/// every parameter with its value.
BenchResult bench(const TechniqueInfo&, const BenchRequest&, nlohmann::json& recipe);

/// The bare frame that the technique is timed against. Throws InputError with the names of those that have one.
const BareFrameInfo& bare_frame_of(const TechniqueInfo&);

/// A technique of volumes against VTK's GPU ray caster on the same volume and view, alone in a black world and white
/// where it is opaque, so that nothing but the medium is drawn. VTK's sample distance is the longest at which its error
/// against the reference is no larger than the hulls', or where there is none, that of its least error.
struct BenchVtk {
  TimingSummary method, vtk;  ///< whole frames
  BenchRatio ratio;           ///< method / vtk
  double sample_distance_m = 0;
  double method_rmse = 0, vtk_rmse = 0;  ///< root of the mean squared error where the volume is seen
  bool equal() const { return vtk_rmse <= method_rmse; }
};
/// Throws InputError for a request that cannot be met, RuntimeError with the reason when VTK cannot draw this volume.
/// `context` is current before and, unless it throws, after; VTK draws in one of its own on the same device.
BenchVtk bench_against_vtk(const TechniqueInfo&, const BenchRequest&, gl::Context& context);

/// The ratio that bench() gives: of each `block` samples, median(a) − median(c) over median(b) −
/// median(c); an empty `c` counts as zero. Nothing when so many denominators are not positive that the interval has no
/// end.
std::optional<BenchRatio> block_ratio(const std::vector<double>& a, const std::vector<double>& b,
                                      const std::vector<double>& c, int block);

}  // namespace pellucid::sweeps
