#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "sandbox/viewer/live/render_client.hpp"
#include "sweeps/workers/worker_process.hpp"

namespace pellucid::sandbox {

/// The text of a spec that runs one parameter over its range at `state`, everything else as it is there.
std::string sweep_spec(const ViewState& state, const std::string& parameter, const std::vector<Value>& values,
                       const std::string& sweep);
/// A value as a spec writes it.
std::string toml_value(const Value&);
/// At most `count` values over the parameter's range: doubled where that spans it well, else evenly; each choice of a
/// choice.
std::vector<Value> sweep_values(const ParameterInfo&, int count);

/// A sweep started from the window: `pellucid sweep run` in a process of its own, whose rows are read as they arrive,
/// and a small picture for each value.
class SweepHere {
 public:
  struct Row {
    Value value;
    double frame_ms = 0, low_ms = 0, high_ms = 0;
    std::optional<double> error;  ///< FLIP's mean
    std::string failed;
  };
  /// Writes FOLDER/NAME_001.toml and starts. Throws InputError or RuntimeError with the reason (full disk).
  SweepHere(const ViewState&, const std::string& parameter, const ParameterInfo&, const std::filesystem::path& folder,
            std::optional<int> device, std::function<void()> wake);
  ~SweepHere();

  /// Reads what has arrived; true when anything did.
  bool poll();
  bool running() const { return process_ != nullptr; }
  void stop() { process_.reset(); }
  /// Draws time and error over the parameter with VTK; the picture of the chart. Nothing before the first row.
  std::optional<Image> chart() const;

  const std::string& parameter() const { return parameter_; }
  const std::vector<Value>& values() const { return values_; }
  const std::vector<Row>& rows() const { return rows_; }
  const std::vector<std::shared_ptr<const Picture>>& thumbnails() const { return thumbnails_; }
  const std::filesystem::path& spec() const { return spec_; }
  const std::filesystem::path& store() const { return store_; }
  const std::string& trouble() const { return trouble_; }
  const ViewState& state() const { return state_; }
  void keep(bool kept) { kept_ = kept; }
  bool kept() const { return kept_; }

 private:
  void read_rows();
  void ask_thumbnail();
  ViewState state_;
  std::string parameter_, label_, trouble_;
  std::vector<Value> values_;
  std::filesystem::path spec_, store_;
  std::vector<Row> rows_;
  std::vector<std::shared_ptr<const Picture>> thumbnails_;
  std::unique_ptr<sweeps::WorkerProcess> process_;
  std::unique_ptr<RenderClient> renderer_;
  std::size_t asked_ = 0;
  double polled_s_ = 0;
  bool kept_ = true;
};

}  // namespace pellucid::sandbox
