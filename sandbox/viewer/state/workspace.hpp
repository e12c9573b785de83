#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "sandbox/viewer/live/render_client.hpp"

namespace pellucid::sandbox {

/// A and B are two techniques on the same scene, view and size; B is there while it is compared.
enum class Side { a = 0, b = 1 };

/// The state of the window without the window: what is asked of the renderers, what came of it, and what carries over
/// when scene, technique or view are switched.
class Workspace {
 public:
  Workspace(const ViewState& initial, std::optional<int> device, std::function<void()> wake);

  /// A table of parameters, as the panel shows it.
  struct Group {
    std::string title, prefix;
    std::vector<ParameterInfo> infos;
  };
  std::vector<Group> groups(Side) const;
  /// Raised when the groups are others than before, or the views are.
  std::uint64_t structure() const { return structure_; }
  /// Throws InputError for a name that no table has, or a value that its declaration refuses.
  void set(Side, const std::string& name, const Value&);
  /// Several at once, as the channels of a colour: they are drawn together.
  void set(Side, const std::vector<std::pair<std::string, Value>>&);
  Value get(Side, const std::string& name) const;
  const ParameterInfo* info(Side, const std::string& name) const;

  ViewState state(Side) const;
  void set_state(const ViewState&);  ///< of side A
  const std::string& scene() const { return scene_; }
  const std::string& technique(Side side) const { return technique_[index(side)]; }
  void set_scene(const std::string&);
  void set_technique(Side, const std::string&);
  void set_view(const std::string& name);
  void set_camera(const View&);
  void set_size(int width, int height);
  int width() const { return width_; }
  int height() const { return height_; }
  const std::string& view_name() const { return view_; }
  const std::vector<View>& views() const { return loaded_.views; }
  /// The camera as numbers, once the scene is known.
  std::optional<View> camera() const;

  /// Side B is drawn while this is on.
  void show_b(bool on);
  bool shows_b() const { return b_on_; }
  void want_maps(bool on);
  /// The renderers count their GL objects from now on (Picture::objects).
  void want_counts() { counts_ = true; }
  /// Draws both sides again; with a restart of a renderer that has ended.
  void ask();
  /// Draws both sides again in renderers that have just started.
  void renew();
  /// Kills what runs, and goes back to the state of the last picture.
  void cancel();
  void reload_shaders();

  /// Takes what the renderers have to tell; true when anything did.
  bool poll();
  /// Keeps a line that a renderer told, unless one has told it before.
  void note(const std::string& words);
  /// The lines that are new since the last call.
  std::vector<std::string> take_notes() { return std::exchange(notes_, {}); }
  const std::shared_ptr<const Picture>& picture(Side side) const { return picture_[index(side)]; }
  /// The picture is of an earlier state than the panel's.
  bool stale(Side side) const;
  bool busy() const;
  /// The name of the job that runs: "precomputing", with the seconds that it takes already; empty when nothing does.
  std::string phase() const;
  /// Why a side's state cannot be drawn; empty when it can.
  const std::string& trouble(Side side) const { return trouble_[index(side)]; }
  /// The same of either side, A first.
  std::string trouble() const;
  const std::string& shader_error() const { return shader_error_; }
  std::vector<int> pids() const;
  std::uint64_t pictures_seen() const { return pictures_seen_; }
  /// Renderers that failed or ended unasked so far, and the last one's reason.
  std::size_t failures() const { return failures_; }
  const std::string& last_failure() const { return last_failure_; }

 private:
  static std::size_t index(Side side) { return static_cast<std::size_t>(side); }
  bool take(Side, const std::string& name, const Value&);  // true: it has changed
  void hear(Side, const RenderEvent&);
  void scene_loaded(const LoadedScene&);
  const ParameterInfo* shared_info(const std::string& name) const;
  std::map<std::string, Value>& values_of(Side, const std::string& name);
  const std::map<std::string, Value>& values_of(Side, const std::string& name) const;

  std::string scene_, view_;
  std::array<std::string, 2> technique_;
  int width_ = 720, height_ = 540;
  std::map<std::string, Value> shared_;  // scene.…, frame.…, shadow.…
  // The settings of each side and technique, kept while another is shown.
  std::array<std::map<std::string, std::map<std::string, Value>>, 2> own_;
  std::map<std::string, Value> carried_;  // the former scene's parameters, until the new one's are known
  LoadedScene loaded_;
  bool b_on_ = false, maps_ = false, counts_ = false;

  std::array<std::unique_ptr<RenderClient>, 2> client_;
  std::optional<int> device_;
  std::function<void()> wake_;
  std::array<std::uint64_t, 2> asked_{};
  std::array<std::shared_ptr<const Picture>, 2> picture_;
  std::uint64_t generation_ = 0, structure_ = 1, pictures_seen_ = 0;
  std::array<std::string, 2> trouble_;
  std::string phase_, shader_error_, last_failure_;
  std::size_t failures_ = 0;
  double phase_began_s_ = 0, phase_share_ = -1;
  std::set<std::string> told_;
  std::vector<std::string> notes_;
};

}  // namespace pellucid::sandbox
