#include <algorithm>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

#include "algorithms/scene/scene.hpp"
#include "tests/algorithms/scene/folder_test.hpp"

namespace pellucid {
namespace {

class SceneErrors : public test::FolderTest {
 protected:
  /// The message of load_scene() on the text, without the file's name.
  std::string error_of(std::string_view text) {
    const std::string path = write("s.toml", text).string();
    const std::string message = test::message_of([&] { load_scene(path); });
    EXPECT_TRUE(message.starts_with(path + ":")) << message;
    return message.substr(std::min(message.size(), path.size() + 1));
  }
};

struct Case {
  std::string_view text;     ///< follows four lines that are sound; or the whole file, when it begins with '!'
  std::string_view message;  ///< line:column: …
};

constexpr std::string_view kSound = "title = \"t\"\n[views.front]\neye = [0, 0, 5]\ntarget = [0, 0, 0]\n";

TEST_F(SceneErrors, NamePlaceAndReason) {
  const Case cases[] = {
      // the file as a whole
      {"!title = \"t\"\n[views\n", "2:7: Error while parsing table header: expected ']', saw '\\n'"},
      {"!title = 3\n", "1:9: title must be a string, not an integer"},
      {"!description = \"d\"\n", "1:1: 'title' is missing"},
      {"!title = \"t\"\n", "1:1: 'views' is missing"},
      {"!title = \"t\"\n[views]\n", "2:1: views: a scene has at least one view"},
      {"!title = \"t\"\nviews = 3\n", "2:9: views must be a table, not an integer"},
      {"!title = \"t\"\nambeint = 1\n[views.a]\neye = [0, 0, 1]\ntarget = [0, 0, 0]\n",
       "2:1: unknown key 'ambeint'; did you mean 'ambient'?"},
      {"[views.front]\n", "5:1: Error while parsing table header: cannot redefine existing table 'views.front'"},
      {"[views.Front]\n", "5:8: 'Front' is not a name: use lower-case letters, digits and underscores, a letter first"},
      // types, ranges, names
      {"fov_y_deg = \"wide\"\n", "5:13: views.front.fov_y_deg must be a number, not a string"},
      {"fov_y_deg = 0\n", "5:13: views.front.fov_y_deg = 0 is out of range (0, 179]"},
      {"fov_y_deg = 180.0\n", "5:13: views.front.fov_y_deg = 180 is out of range (0, 179]"},
      {"near_m = nan\n", "5:10: views.front.near_m = nan is out of range [1e-06, 1000000]"},
      {"near_m = inf\n", "5:10: views.front.near_m = inf is out of range [1e-06, 1000000]"},
      {"neer_m = 1\n", "5:1: unknown key 'neer_m' in views.front; did you mean 'near_m'?"},
      {"up = [0, 1]\n", "5:6: views.front.up must have 3 numbers [x, y, z], not 2"},
      {"up = [0, \"1\", 0]\n", "5:10: views.front.up.y must be a number, not a string"},
      {"up = 1\n", "5:6: views.front.up must be [x, y, z], not an integer"},
      // numbers that contradict each other
      {"near_m = 5\nfar_m = 2\n", "2:1: views.front: near_m 5 must be below far_m 2"},
      {"up = [0, 0, 0]\n", "2:1: views.front: up must not be zero"},
      {"up = [0, 0, -3]\n", "2:1: views.front: up is parallel to the line of sight"},
      {"[views.b]\neye = [1, 1, 1]\ntarget = [1, 1, 1]\n", "5:1: views.b: eye and target are the same point"},
      {"[views.b]\neye = [1, 1, 1]\n", "5:1: 'target' is missing in views.b"},
      {"[views.b]\neye = [1, 1, 1]\ntraget = [0, 0, 0]\n", "7:1: 'target' is missing in views.b; is it 'traget'?"},
      // motion
      {"eye_path = { keyframes = [] }\n", "5:12: views.front.eye_path and views.front.eye exclude each other"},
      {"[views.b]\ntarget = [0, 0, 0]\neye_path = { keyframes = [{ time_s = 0, value = [1, 1, 1] }] }\n",
       "7:26: views.b.eye_path.keyframes: a path has at least two keyframes"},
      {"[views.b]\ntarget = [0, 0, 0]\n[[views.b.eye_path.keyframes]]\ntime_s = 1\nvalue = [1, 1, "
       "1]\n[[views.b.eye_path.keyframes]]\ntime_s = 1\nvalue = [1, 1, 2]\n",
       "11:10: views.b.eye_path.keyframes[1].time_s: 1 does not follow 1; times must rise"},
      {"[views.b]\ntarget = [0, 0, 0]\neye_path = { loop = true, keyframes = [{ time_s = 0, value = [1, 1, 1] }, { "
       "time_s = 1, value = [1, 1, 2] }] }\n",
       "7:39: views.b.eye_path.keyframes: a path that loops must end at the value where it begins"},
      {"spin = { axis = [0, 0, 0], deg_per_s = 1 }\n", "5:17: views.front.spin.axis: an axis must not be zero"},
      // objects
      {"[meshes.a]\n", "5:1: 'shape' is missing in meshes.a"},
      {"[meshes.a]\nshape = \"sfere\"\n",
       "6:9: meshes.a.shape = 'sfere' is not one of sphere, box, plane, cylinder, cone, torus, star, teapot, relief, "
       "tiles; did you mean 'sphere'?"},
      {"[meshes.a]\nshape = \"sphere\"\nsegments = 2\n", "7:12: meshes.a.segments = 2 is out of range [3, 2048]"},
      {"[meshes.a]\nshape = \"sphere\"\nsegments = 8.5\n", "7:12: meshes.a.segments must be an integer, not a number"},
      {"[meshes.a]\nshape = \"box\"\nradius = 2\n", "7:1: unknown key 'radius' in meshes.a; known are shape, size"},
      {"[meshes.a]\nshape = \"torus\"\nminor_radius = 2\n", "5:1: meshes.a: minor_radius 2 must be below radius 1"},
      {"[meshes.a]\nshape = \"box\"\nfile = \"a.obj\"\n", "6:9: meshes.a.shape and meshes.a.file exclude each other"},
      {"[materials.m]\nalbedo = [0.5, 1.5, 0]\n", "6:16: materials.m.albedo.g = 1.5 is out of range [0, 1]"},
      {"[instances.i]\nmesh = \"a\"\n", "6:8: instances.i.mesh: there is no mesh 'a'"},
      {"[meshes.ball]\nshape = \"sphere\"\n[instances.i]\nmesh = \"bal\"\nmaterial = \"m\"\n",
       "8:8: instances.i.mesh: there is no mesh 'bal'; did you mean 'ball'?"},
      {"[meshes.ball]\nshape = \"sphere\"\n[materials.red]\n[instances.i]\nmesh = \"ball\"\nmaterial = \"metal\"\n",
       "10:12: instances.i.material: there is no material 'metal'; there are red"},
      {"[meshes.ball]\nshape = \"sphere\"\n[materials.red]\n[instances.i]\nmesh = \"ball\"\nmaterial = "
       "\"red\"\nscale = 0\n",
       "11:9: instances.i.scale = 0 is out of range [1e-06, 1000000]"},
      {"[meshes.ball]\nshape = \"sphere\"\n[materials.red]\n[instances.i]\nmesh = \"ball\"\nmaterial = "
       "\"red\"\nrotation_axis = [0, 0, 0]\n",
       "8:1: rotation_axis must not be zero"},
      {"[meshes.a]\nshape = \"star\"\namplitude = 1\n", "7:13: meshes.a.amplitude = 1 is out of range [0, 0.9]"},
      {"[meshes.a]\nshape = \"star\"\nlobes = 2.5\n", "7:9: meshes.a.lobes must be an integer, not a number"},
      {"[forest]\ntrees = -1\n", "6:9: forest.trees = -1 is out of range [0, 100000]"},
      // lights
      {"[lights.a]\nintensity = 1\n", "5:1: 'kind' is missing in lights.a"},
      {"[lights.a]\nkind = \"point\"\nintensity = 1\n", "5:1: 'position' is missing in lights.a"},
      {"[lights.a]\nkind = \"directional\"\nintensity = 1\n", "5:1: 'direction' is missing in lights.a"},
      {"[lights.a]\nkind = \"directional\"\nintensity = -1\ndirection = [0, 1, 0]\n",
       "7:13: lights.a.intensity = -1 is out of range [0, 1000000000]"},
      {"[lights.a]\nkind = \"directional\"\nintensity = 1\ndirection = [0, 0, 0]\n",
       "5:1: lights.a: direction must not be zero"},
      {"[lights.a]\nkind = \"spot\"\nintensity = 1\nposition = [0, 1, 0]\ndirection = [0, -1, 0]\ninner_angle_deg = "
       "40\n",
       "5:1: lights.a: inner_angle_deg 40 must be below outer_angle_deg 30"},
      {"[lights]\na = { kind = \"point\", position = [0, 0, 0], intensity = 1 }\nb = { kind = \"point\", position = "
       "[0, "
       "0, 0], intensity = 1 }\nc = { kind = \"point\", position = [0, 0, 0], intensity = 1 }\nd = { kind = \"point\", "
       "position = [0, 0, 0], intensity = 1 }\ne = { kind = \"point\", position = [0, 0, 0], intensity = 1 }\n",
       "10:5: lights.e: a scene has at most 4 lights"},
      // the volume
      {"[volume]\nkind = \"fog\"\n", "5:1: 'center' is missing in volume"},
      {"[volume]\nkind = \"fog\"\nmin = [0, 0, 0]\nmax = [1, 0, 1]\nextinction = 1\n",
       "5:1: volume: min must be below max along every axis"},
      {"[volume]\nkind = \"fog\"\nmin = [0, 0, 0]\nmax = [1, 1, 1]\nsize = 2\nextinction = 1\n",
       "9:8: volume.size and volume.min exclude each other"},
      {"[volume]\nkind = \"fog\"\nmin = [0, 0, 0]\nmax = [1, 1, 1]\n", "5:1: 'extinction' is missing in volume"},
      {"[volume]\nkind = \"fog\"\nvoxels = [2048, 2048, 2048]\nmin = [0, 0, 0]\nmax = [1, 1, 1]\nextinction = 1\n",
       "5:1: volume: 2048 x 2048 x 2048 voxels; at most 2^30 are allowed"},
      {"[volume]\nkind = \"fog\"\nvoxels = 4096\n", "7:10: volume.voxels = 4096 is out of range [1, 2048]"},
      {"[volume]\nkind = \"ball\"\nseed = 3\nmin = [0, 0, 0]\nmax = [1, 1, 1]\nextinction = 1\n",
       "7:1: unknown key 'seed' in volume; known are kind, voxels, density, min, max, extinction, albedo, emission, "
       "transfer"},
      // shadows, transfer functions, volumes in a light's space
      {"[lights.a]\nkind = \"point\"\nposition = [0, 0, 0]\nintensity = 1\nshadow = 1\n",
       "9:10: lights.a.shadow must be true or false, not an integer"},
      {"[lights.a]\nkind = \"point\"\nposition = [0, 0, 0]\nintensity = 1\nshadows = true\n",
       "9:1: unknown key 'shadows' in lights.a; did you mean 'shadow'?"},
      {"[volume]\nkind = \"fog\"\nmin = [0, 0, 0]\nmax = [1, 1, 1]\nextinction = 1\n[[volume.transfer]]\ndensity = "
       "1\nextinction = 1\n",
       "10:1: volume.transfer: a transfer function has at least two points"},
      {"[volume]\nkind = \"fog\"\nmin = [0, 0, 0]\nmax = [1, 1, 1]\nextinction = 1\n[[volume.transfer]]\ndensity = "
       "1\nextinction = 1\n[[volume.transfer]]\ndensity = 1\nextinction = 2\n",
       "13:1: volume.transfer[1]: density 1 does not follow 1; densities must rise"},
      {"[volume]\nkind = \"fog\"\nmin = [0, 0, 0]\nmax = [1, 1, 1]\nextinction = 1\n[[volume.transfer]]\ndensty = "
       "1\nextinction = 1\n",
       "11:1: 'density' is missing in volume.transfer[0]; is it 'densty'?"},
      {"[volume]\nkind = \"fog\"\nmin = [0, 0, 0]\nmax = [1, 1, 1]\nextinction = 1\ntransfer = 3\n",
       "10:12: volume.transfer must be a list of tables, not an integer"},
      {"[lights.sun]\nkind = \"directional\"\nintensity = 1\nazimuth_deg = 1\n[volume]\nkind = \"fog\"\nlight = "
       "\"sun\"\nrange_m = 2\nextinction = 1\n",
       "11:9: volume.light: 'sun' is no spot light; a volume lies in the space of a spot"},
      {"[lights.lamp]\nkind = \"spot\"\nintensity = 1\nposition = [0, 0, 0]\ndirection = [0, 0, 1]\n[volume]\nkind = "
       "\"fog\"\nlight = \"lam\"\nrange_m = 2\nextinction = 1\n",
       "12:9: volume.light: there is no light 'lam'; did you mean 'lamp'?"},
      {"[lights.lamp]\nkind = \"spot\"\nintensity = 1\nposition = [0, 0, 0]\ndirection = [0, 0, 1]\n[volume]\nkind = "
       "\"fog\"\nlight = \"lamp\"\nrange_m = 2\nsize = 1\nextinction = 1\n",
       "14:8: volume.size and volume.light exclude each other"},
      {"[lights.lamp]\nkind = \"spot\"\nintensity = 1\nposition = [0, 0, 0]\ndirection = [0, 0, 1]\n[volume]\nkind = "
       "\"fog\"\nlight = \"lamp\"\nextinction = 1\n",
       "10:1: 'range_m' is missing in volume"},
      {"[lights.lamp]\nkind = \"spot\"\nintensity = 1\nposition = [0, 0, 0]\ndirection = [0, 0, 1]\n[volume]\nkind = "
       "\"fog\"\nlight = \"lamp\"\nnear_m = 2\nrange_m = 2\nextinction = 1\n",
       "10:1: volume: near_m 2 must be below range_m 2"},
      {"[lights.lamp]\nkind = \"spot\"\nintensity = 1\nposition = [0, 0, 0]\ndirection = [0, 0, 1]\n[volume]\nkind = "
       "\"fog\"\nlight = \"lamp\"\nnear_m = 0\nrange_m = 2\nextinction = 1\n",
       "13:10: volume.near_m = 0 is out of range [0.01, 1000000]"},
      {"[lights.lamp]\nkind = \"spot\"\nintensity = 1\nposition = [0, 0, 0]\ndirection = [0, 0, 1]\nouter_angle_deg = "
       "85\n[volume]\nkind = \"fog\"\nlight = \"lamp\"\nrange_m = 2\nextinction = 1\n",
       "5:1: lights.lamp: outer_angle_deg 85 is above 80, the widest for a volume in a light's space"},
      {"[lights.lamp]\nkind = \"spot\"\nintensity = 1\nposition = [0, 0, 0]\ndirection = [0, 0, "
       "1]\ndirection_path = { keyframes = [] }\n",
       "10:18: lights.lamp.direction_path and lights.lamp.direction exclude each other"},
      {"[volume]\nkind = \"smok\"\n",
       "6:8: volume.kind = 'smok' is not one of constant, fog, ball, smoke, water, file; did you mean 'smoke'?"},
      {"[volume]\nkind = \"water\"\nlevel = 1.5\n", "7:9: volume.level = 1.5 is out of range [0, 1]"},
      {"[volume]\nkind = \"file\"\n", "5:1: 'file' is missing in volume"},
      // the environment
      {"[environment]\nimage = \"a.exr\"\nzenith = 1\n",
       "6:9: environment.image and environment.zenith exclude each other"},
      // parameters
      {"[parameters.p]\n", "5:1: 'drives' is missing in parameters.p"},
      {"[parameters]\np = { default = 1, range = [0, 2], doc = \"d\", drives = [] }\n",
       "6:56: parameters.p.drives: a parameter drives at least one target"},
      {"[parameters]\np = { default = 1, range = [0, 2], drives = [\"ambient\"] }\n",
       "6:5: 'doc' is missing in parameters.p"},
      {"[parameters]\np = { default = 3, range = [0, 2], doc = \"d\", drives = [\"ambient\"] }\n",
       "6:17: parameters.p.default: 3 is out of its range [0, 2]"},
      {"[parameters]\np = { default = [0, 1, 3], range = [0, 2], doc = \"d\", drives = [\"ambient\"] }\n",
       "6:17: parameters.p.default: 3 is out of its range [0, 2]"},
      {"[parameters]\np = { default = [0, 1], range = [0, 2], doc = \"d\", drives = [\"ambient\"] }\n",
       "6:17: parameters.p.default must have 3 numbers [r, g, b], not 2"},
      {"[parameters]\np = { default = [45, 45, 45], range = [30, 60], doc = \"d\", drives = "
       "[\"views.front.fov_y_deg\"] }\n",
       "6:70: parameters.p.drives: views.front.fov_y_deg is no colour, and the default is one"},
      {"[parameters]\np = { default = [1, 1, 1], range = [0, 2], doc = \"d\", drives = [\"ambient\"] }\n"
       "p_green = { default = 1, range = [0, 2], doc = \"d\", drives = [\"ambient.b\"] }\n",
       "7:11: parameters.p_green: there are two parameters 'p_green'"},
      {"[parameters]\np = { default = nan, range = [0, 2], doc = \"d\", drives = [\"ambient\"] }\n",
       "6:17: parameters.p.default = nan is out of range [-1000000000000, 1000000000000]"},
      {"[parameters]\np = { default = 2, range = [2, 2], doc = \"d\", drives = [\"ambient\"] }\n",
       "6:28: parameters.p.range: [2, 2] is empty"},
      {"[parameters]\np = { default = 2, range = 2, doc = \"d\", drives = [\"ambient\"] }\n",
       "6:28: parameters.p.range must be two numbers [min, max]"},
      {"[parameters]\np = { default = 0, range = [0, 2], doc = \"d\", drives = [\"views.front.fov_deg\"] }\n",
       "6:57: parameters.p.drives: 'views.front.fov_deg' is nothing that can be driven; did you mean "
       "'views.front.fov_y_deg'?"},
      {"[parameters]\np = { default = 0, range = [-1, 2], doc = \"d\", drives = [\"ambient\"] }\n",
       "6:58: parameters.p.drives: within its range it makes ambient = -1, which is out of [0, 1000000000]"},
      {"[parameters]\np = { default = 0, range = [0, 2], doc = \"d\", mode = \"mul\", drives = [\"ambient\"] }\n",
       "6:54: parameters.p.mode = 'mul' is not one of set, scale, add"},
      {"far_m = 50\n[parameters]\np = { default = 60, range = [40, 70], doc = \"d\", drives = "
       "[\"views.front.far_m\"] }\n",
       "5:9: views.front.far_m = 50, but parameter 'p' sets it and has the default 60; make them equal"},
      {"[parameters]\np = { default = 0, range = [0, 2], doc = \"d\", drives = [\"ambient\"] }\nq = { default = 0, "
       "range "
       "= [0, 2], doc = \"d\", drives = [\"ambient.r\"] }\n",
       "7:57: parameters.q.drives: ambient.r is already set by 'p'"},
      {"[forest]\n[parameters]\np = { default = 1, range = [0, 2], doc = \"d\", mode = \"scale\", drives = "
       "[\"forest.trees\"] }\n",
       "7:73: parameters.p.drives: forest.trees is an integer, which a parameter can only set"},
      {"[forest]\n[parameters]\np = { default = 1.5, range = [0, 2], doc = \"d\", drives = [\"forest.trees\"] }\n",
       "7:17: parameters.p.default must be an integer, not a number"},
      {"[parameters]\ntime_s = { default = 0, range = [0, 1], drives = [\"ambient\"] }\n",
       "6:41: unknown key 'drives' in parameters.time_s; known are doc, range, default"},
  };
  for (const Case& wrong : cases) {
    const std::string text =
        wrong.text.starts_with('!') ? std::string(wrong.text.substr(1)) : std::string(kSound) + std::string(wrong.text);
    EXPECT_EQ(error_of(text), wrong.message) << text;
  }
}

TEST_F(SceneErrors, FilesThatCannotBeReadAreNamedWhereTheyAreUsed) {
  const std::string mesh = std::string(kSound) + "[meshes.m]\nfile = \"m.off\"\n";
  EXPECT_EQ(error_of(mesh), "6:8: '" + file("m.off").string() + "' does not exist");
  write("m.off", "");
  EXPECT_EQ(error_of(mesh), "6:8: cannot read mesh '" + file("m.off").string() + "': the file is empty");
  const std::string volume = std::string(kSound) + "[volume]\nkind = \"file\"\nfile = \"v.inr\"\ncenter = [0, 0, 0]\n";
  EXPECT_EQ(error_of(volume), "7:8: '" + file("v.inr").string() + "' does not exist");
  write("v.inr", "x");
  EXPECT_EQ(error_of(volume),
            "7:8: cannot read volume '" + file("v.inr").string() + "': it does not begin with '#INRIMAGE-4#{'");
  EXPECT_EQ(error_of(volume + "range = [2, 1]\n"), "9:9: volume.range: [2, 1] is empty");
  EXPECT_EQ(error_of(volume + "voxels = 8\n"),
            "7:8: cannot read volume '" + file("v.inr").string() + "': it does not begin with '#INRIMAGE-4#{'");
  const std::string nrrd = "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 1 1\nspacings: 1e9 1 1\nencoding: raw\n\n";
  std::string flat = volume;
  flat.replace(flat.find("v.inr"), 5, "v.nrrd");
  write("v.nrrd", nrrd + "33");
  EXPECT_EQ(error_of(flat), "7:8: its values are all 51; state what shall be 0 and 1: range = [low, high]");
  write("v.nrrd", nrrd + "34");
  EXPECT_EQ(
      error_of(flat + "extinction = 1\n"),
      "7:8: volume.file: its spacing makes the box 2000000000 x 1 x 1 m, out of [1e-06, 1000000]; give size or fit_m");
  EXPECT_EQ(error_of(flat + "fit_m = 2\nsize = 1\nextinction = 1\n"),
            "9:9: volume.fit_m and volume.size exclude each other");
  const std::string sky = std::string(kSound) + "[environment]\nimage = \"sky.exr\"\n";
  write("sky.exr", "no picture");
  EXPECT_EQ(error_of(sky), "6:9: cannot read image '" + file("sky.exr").string() + "': neither OpenEXR nor PNG");
  write_png(file("sky.exr"), Image(2, 2, 3));
  EXPECT_EQ(error_of(sky), "6:9: environment.image: an environment is scene-linear: an EXR file, not PNG");
  EXPECT_EQ(error_of(std::string(kSound) + "[meshes.m]\nfile = \"asset:none/m.off\"\n").substr(0, 38),
            "6:8: asset 'none/m.off' is missing (lo");
}

TEST_F(SceneErrors, CubesPlacedByHand) {
  constexpr std::string_view kBall =
      "[meshes.ball]\nshape = \"sphere\"\n[materials.red]\n[instances.i]\nmesh = \"ball\"\nmaterial = \"red\"\n";
  const Case cases[] = {
      {"cubes = [0, 0, 0]\n", "11:10: instances.i.cubes[0] must be [x, y, z], not an integer"},
      {"cubes = 3\n", "11:9: instances.i.cubes must be a list of points [[x, y, z], …], not an integer"},
      {"cubes = []\n", "11:9: instances.i.cubes must have 1 to 16 points, not 0"},
      {"cubes = [[0, 0, 0], [0, 1]]\n", "11:21: instances.i.cubes[1] must have 3 numbers [x, y, z], not 2"},
      {"cubes = [[0, 0, 0], [0, nan, 0]]\n", "11:25: instances.i.cubes[1].y = nan is out of range [-1000000, 1000000]"},
      {"cube = [[0, 0, 0]]\n", "11:1: unknown key 'cube' in instances.i; did you mean 'cubes'?"},
  };
  for (const auto& [text, message] : cases) {
    EXPECT_EQ(error_of(std::string(kSound) + std::string(kBall) + std::string(text)), message) << text;
  }
  std::string many = "cubes = [";
  for (int i = 0; i < 17; ++i)
    many += "[0, 0, 0], ";
  EXPECT_EQ(error_of(std::string(kSound) + std::string(kBall) + many + "]\n"),
            "11:9: instances.i.cubes must have 1 to 16 points, not 17");
}

}  // namespace
}  // namespace pellucid
