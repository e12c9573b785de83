#include "sweeps/workers/point_row.hpp"

#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "sweeps/spec/clock.hpp"
#include "sweeps/spec/point_json.hpp"
#include "sweeps/spec/provenance.hpp"

namespace pellucid::sweeps {

using nlohmann::json;

std::string summary_of(const Point& point) {
  std::string text = fmt::format("{} {}", point.technique, point.scene);
  for (const std::string& name : point.assigned)
    text += fmt::format(" {}={}", name, to_text(point.parameters.at(name)));
  return text + fmt::format(" {}x{}", point.size.width, point.size.height);
}

std::string outcome_of(const json& row) {
  std::string text;
  if (row.contains("frame_ms_median")) {
    text = fmt::format("{:.3g} ms", row.at("frame_ms_median").get<double>());
    if (row.value("timing", "") == "unconverged") text += " (unconverged)";
    if (const auto saturated = row.value("saturated_pixels", 0); saturated > 0)
      text += fmt::format(" ({} pixels saturate 16-bit floats)", saturated);
  }
  for (const char* metric : {"flip_mean", "rmse"}) {
    if (row.contains(metric))
      text += fmt::format("{}{} {:.3g}", text.empty() ? "" : ", ", metric, row.at(metric).get<double>());
  }
  return text.empty() ? "done" : text;
}

std::string flaw_of(const json& row, const Point& point) {
  if (point.timing.enabled && !row.contains("frame_ms_median")) return "the worker gave no frame time";
  for (const auto& [name, value] : row.items()) {
    // JSON has no NaN: it arrives as null. Equal images have an infinite PSNR.
    if (value.is_null() && !name.starts_with("psnr")) return fmt::format("{} is not a finite number", name);
  }
  return "";
}

void put_point(json& row, const Point& point) {
  for (const auto& [name, value] : point.parameters)
    row[name] = value_to_json(value);
  row["technique"] = point.technique;
  row["scene"] = point.scene;
  row["view"] = point.view;
  row["width"] = point.size.width;
  row["height"] = point.size.height;
  row["repeat"] = repeat_command(point);
  if (!row.contains("scene_hash")) row["scene_hash"] = point.scene_hash;
  row["code_hash"] = point.code_hash;
  row["commit"] = kCommit;
  row["dirty"] = kDirty;
}

void put_machine(json& row, const WorkerClient::Hello& hello, const std::string& host) {
  row["device"] = hello.device;
  row["driver"] = hello.driver;
  row["host"] = host;
  if (!row.contains("clock")) row["clock"] = hello.clock;
}

void put_outcome(json& row, const std::string& failure, double started_unix_s, double wall_s) {
  row["status"] = failure.empty() ? "ok" : "failed";
  row["failure"] = failure;
  row["started_utc"] = utc_text(started_unix_s);
  row["done_unix_s"] = unix_now_s();
  row["wall_s"] = wall_s;
}

}  // namespace pellucid::sweeps
