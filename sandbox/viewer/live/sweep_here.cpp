#include "sandbox/viewer/live/sweep_here.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <utility>
#include <variant>

#include <fmt/format.h>
#include <unistd.h>

#include "algorithms/scene/files/atomic_file.hpp"
#include "gl/error.hpp"
#include "plots/charts/chart.hpp"
#include "sandbox/viewer/app/save.hpp"
#include "sweeps/spec/point_json.hpp"
#include "sweeps/store/store.hpp"

namespace pellucid::sandbox {

namespace {

constexpr int kValues = 9;
constexpr int kThumbnailWidth = 128;

double now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + '"';
}

double number(const Value& value) {
  if (const auto* whole = std::get_if<std::int64_t>(&value)) return static_cast<double>(*whole);
  if (const auto* real = std::get_if<double>(&value)) return *real;
  if (const auto* on = std::get_if<bool>(&value)) return *on ? 1 : 0;
  return 0;
}

}  // namespace

std::string toml_value(const Value& value) {
  if (const auto* word = std::get_if<std::string>(&value)) return '"' + *word + '"';
  if (const auto* real = std::get_if<double>(&value)) {
    const std::string text = fmt::format("{}", *real);
    return text.find_first_of(".e") == std::string::npos ? text + ".0" : text;
  }
  return to_text(value);
}

std::vector<Value> sweep_values(const ParameterInfo& info, int count) {
  std::vector<Value> out;
  if (info.type == ValueType::boolean) return {false, true};
  if (info.type == ValueType::choice) {
    for (const std::string& choice : info.choices)
      out.emplace_back(choice);
    return out;
  }
  if (info.type == ValueType::integer) {
    const auto min = static_cast<std::int64_t>(info.min), max = static_cast<std::int64_t>(info.max);
    if (max - min < count) {
      for (std::int64_t v = min; v <= max; ++v)
        out.emplace_back(v);
    } else if (min >= 0 && max <= (std::int64_t{1} << 20)) {
      // 0 has no place on a scale of doublings, and is tried as well.
      if (min == 0) out.emplace_back(std::int64_t{0});
      std::vector<std::int64_t> doubled;
      for (std::int64_t v = std::max<std::int64_t>(1, min); v <= max; v *= 2)
        doubled.push_back(v);
      const std::size_t stride = std::max<std::size_t>(
          1, (doubled.size() + static_cast<std::size_t>(count) - 1) / static_cast<std::size_t>(count));
      for (std::size_t i = 0; i < doubled.size(); i += stride)
        out.emplace_back(doubled[i]);
    } else {
      for (int i = 0; i < count; ++i)
        out.emplace_back(min + (max - min) * i / (count - 1));
    }
    return out;
  }
  for (int i = 0; i < count; ++i)
    out.emplace_back(std::stod(fmt::format("{:.6g}", info.min + (info.max - info.min) * i / (count - 1))));
  return out;
}

std::string sweep_spec(const ViewState& state, const std::string& parameter, const std::vector<Value>& values,
                       const std::string& sweep) {
  std::string list;
  for (const Value& value : values)
    list += (list.empty() ? "" : ", ") + toml_value(value);
  std::string text = fmt::format(
      "name = {}\ntitle = {}\ndescription = \"Started from the window.\"\ntimeout_s = 600\nmetrics = [\"flip\", "
      "\"rmse\"]\n\n[timing]\nmax_seconds = 3\n\n[[run]]\nname = \"here\"\ntechniques = [{}]\nscenes = [{}]\n",
      quoted(sweep), quoted(fmt::format("{} of {}", parameter, state.technique)), quoted(state.technique),
      quoted(std::filesystem::path(state.scene).has_extension() ? std::filesystem::absolute(state.scene).string()
                                                                : state.scene));
  if (!state.view.empty()) text += fmt::format("views = [{}]\n", quoted(state.view));
  text += fmt::format("sizes = [\"{}x{}\"]\n\n[run.axes]\n{} = [{}]\n", state.width, state.height, parameter, list);
  std::string fixed;
  for (const auto& [name, value] : state.parameters)
    if (name != parameter) fixed += fmt::format("{} = {}\n", name, toml_value(value));
  if (!fixed.empty()) text += "\n[run.fixed]\n" + fixed;
  return text;
}

SweepHere::SweepHere(const ViewState& state, const std::string& parameter, const ParameterInfo& info,
                     const std::filesystem::path& folder, std::optional<int> device, std::function<void()> wake)
    : state_(state), parameter_(parameter), values_(sweep_values(info, kValues)) {
  label_ = info.unit.empty() ? parameter : fmt::format("{} [{}]", parameter, info.unit);
  std::string name = state.technique + "_" + parameter;
  std::replace(name.begin(), name.end(), '.', '_');
  spec_ = free_name(folder, name, ".toml");
  store_ = std::filesystem::path(spec_).replace_extension(".db");
  write_text_file(spec_, sweep_spec(state_, parameter_, values_, name));
  std::vector<std::string> command{"/proc/self/exe", "sweep",         "run",    spec_.string(),
                                   "--store",        store_.string(), "--quiet"};
  if (device) command.push_back(fmt::format("--device={}", *device));
  process_ = std::make_unique<sweeps::WorkerProcess>(command);
  thumbnails_.resize(values_.size());
  renderer_ = std::make_unique<RenderClient>(device, std::move(wake));
  ask_thumbnail();
}

SweepHere::~SweepHere() {
  process_.reset();
  if (kept_) return;
  std::error_code ignored;
  for (const char* ending : {"", "-wal", "-shm"})
    std::filesystem::remove(store_.string() + ending, ignored);
  std::filesystem::remove_all(store_.string() + ".references", ignored);
  std::filesystem::remove(spec_, ignored);
}

void SweepHere::ask_thumbnail() {
  if (asked_ >= values_.size()) {
    renderer_.reset();
    return;
  }
  ViewState small = state_;
  small.height = std::max(1, kThumbnailWidth * state_.height / state_.width);
  small.width = kThumbnailWidth;
  small.parameters[parameter_] = values_[asked_];
  renderer_->ask(
      {.generation = asked_++, .state = small, .maps = false, .counts = false, .scene = false, .reference = {}});
}

bool SweepHere::poll() {
  bool any = false;
  if (renderer_) {
    for (const RenderEvent& event : renderer_->take()) {
      if (const auto* picture = std::get_if<PictureEvent>(&event)) {
        thumbnails_[picture->picture->generation] = picture->picture;
        any = true;
        ask_thumbnail();
      } else if (std::holds_alternative<RefusedEvent>(event) || std::holds_alternative<EndedEvent>(event)) {
        ask_thumbnail();  // that value has no picture
      }
      if (!renderer_) break;
    }
  }
  if (!process_ || now_s() - polled_s_ < 0.3) return any;
  polled_s_ = now_s();
  // Its pipes are emptied, or it would wait for us.
  while (process_->receive(std::chrono::steady_clock::now(), [] { return true; }).event ==
         sweeps::WorkerProcess::Event::line) {
  }
  const std::size_t before = rows_.size();
  const bool ended = !process_->alive();
  read_rows();
  if (ended) {
    const std::string how = process_->end();
    if (rows_.empty()) trouble_ = fmt::format("the sweep {}: {}", how, process_->last_words());
    process_.reset();
  }
  return any || ended || rows_.size() != before;
}

void SweepHere::read_rows() {
  if (!std::filesystem::exists(store_)) return;
  std::vector<nlohmann::json> stored;
  try {
    stored = sweeps::read_rows(store_);
  } catch (const std::exception&) {
    return;  // it is being made
  }
  rows_.clear();
  for (const nlohmann::json& in : stored) {
    Row row;
    for (const Value& value : values_)
      if (in.contains(parameter_) && to_text(sweeps::value_from_json(in.at(parameter_))) == to_text(value))
        row.value = value;
    const auto real = [&](const char* name) {
      return in.contains(name) && in.at(name).is_number() ? in.at(name).get<double>() : std::nan("");
    };
    if (in.value("status", "ok") != "ok") row.failed = in.value("reason", "failed");
    row.frame_ms = real("frame_ms_median");
    row.low_ms = real("frame_ms_ci95_low");
    row.high_ms = real("frame_ms_ci95_high");
    if (const double error = real("flip_mean"); std::isfinite(error)) row.error = error;
    rows_.push_back(std::move(row));
  }
}

std::optional<Image> SweepHere::chart() const {
  plots::Chart chart;
  chart.title = fmt::format("{} of {}", parameter_, state_.technique);
  chart.x.label = label_;
  chart.y.label = "frame time [ms] · FLIP × 1000";
  plots::Series time{.label = "frame time [ms]", .points = {}, .style = {.color = {0, 114, 178}}};
  plots::Series error{
      .label = "FLIP × 1000", .points = {}, .style = {.color = {213, 94, 0}, .marker = plots::Marker::square}};
  const bool words = std::holds_alternative<std::string>(values_.front());
  for (const Row& row : rows_) {
    double x = number(row.value);
    if (words) {
      const auto it = std::find(values_.begin(), values_.end(), row.value);
      x = static_cast<double>(it - values_.begin());
    }
    if (std::isfinite(row.frame_ms)) time.points.push_back({x, row.frame_ms, row.low_ms, row.high_ms});
    if (row.error) error.points.push_back({x, *row.error * 1000, {}, {}});
  }
  const auto by_x = [](const plots::Point& a, const plots::Point& b) { return a.x < b.x; };
  std::sort(time.points.begin(), time.points.end(), by_x);
  std::sort(error.points.begin(), error.points.end(), by_x);
  for (plots::Series* series : {&time, &error})
    if (!series->points.empty()) chart.series.push_back(*series);
  if (chart.series.empty()) return std::nullopt;
  // Milliseconds and errors differ by orders of magnitude, so do values that double.
  const auto all_points = [&](auto&& holds) {
    return std::all_of(chart.series.begin(), chart.series.end(), [&](const plots::Series& series) {
      return std::all_of(series.points.begin(), series.points.end(), holds);
    });
  };
  if (all_points([](const plots::Point& p) { return p.y > 0; })) chart.y.scale = plots::Scale::log10;
  const bool doubles = !words && number(values_.back()) >= 16 * number(values_.front());
  if (doubles && all_points([](const plots::Point& p) { return p.x > 0; })) chart.x.scale = plots::Scale::log2;
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / fmt::format("pellucid_sweep_{}.png", ::getpid());
  plots::write_chart(chart, file);
  Image image = read_image(file).image;
  std::error_code ignored;
  std::filesystem::remove(file, ignored);
  return image;
}

}  // namespace pellucid::sandbox
