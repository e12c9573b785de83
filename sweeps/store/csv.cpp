#include "sweeps/store/csv.hpp"

#include <algorithm>
#include <iterator>
#include <set>
#include <string_view>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "sweeps/metrics/metrics.hpp"
#include "sweeps/store/select.hpp"

namespace pellucid::sweeps {
namespace {

using nlohmann::json;
using ColumnNames = std::vector<std::string>;

const ColumnNames kIdentity{"sweep", "block", "point",  "technique", "scene",
                            "view",  "width", "height", "status",    "failure"};
const ColumnNames kTimes{"frame_ms_median",
                         "frame_ms_ci95_low",
                         "frame_ms_ci95_high",
                         "frame_ms_mean",
                         "frame_ms_q25",
                         "frame_ms_q75",
                         "fps",
                         "frames",
                         "warmup_frames",
                         "timing",
                         "clock",
                         "baseline_drift",
                         "prepare_s"};
const ColumnNames kReference{"reference_method",
                             "reference_step_error_max",
                             "reference_step_error_mean",
                             "reference_unconverged_share",
                             "shadow_pixels_share",
                             "reference_to_exact_flip_mean",
                             "reference_to_exact_rmse",
                             "reference_samples",
                             "reference_standard_error_max",
                             "reference_standard_error_mean",
                             "reference_caustic_error_max",
                             "reference_caustic_error_mean",
                             "reference_cut_weight_max",
                             "reference_cut_weight_mean",
                             "reference_lost_weight_mean",
                             "reference_trace_s"};
constexpr std::string_view kShadow = "_shadow";
const ColumnNames kProvenance{"gpu_bytes",   "peak_rss_bytes",  "device",      "driver",    "host",
                              "commit",      "dirty",           "scene_hash",  "code_hash", "shader_hash",
                              "started_utc", "timed_unix_s",    "done_unix_s", "wall_s",    "argv",
                              "repeat",      "frame_ms_samples"};
constexpr std::string_view kPasses = "pass_ms.";

std::string field(const json& row, const std::string& name) {
  const auto found = row.find(name);
  if (found == row.end() || found->is_null()) return "";
  if (found->is_string()) return found->get<std::string>();
  return found->dump(-1, ' ', false, json::error_handler_t::replace);
}

/// The columns of `rows`, which are opened.
ColumnNames columns(const std::vector<json>& rows) {
  std::set<std::string> present;
  for (const json& row : rows) {
    for (const auto& [name, value] : row.items())
      present.insert(name);
  }
  ColumnNames result = kIdentity;
  for (const std::string& name : kIdentity)
    present.erase(name);
  ColumnNames measured;
  const auto take = [&](const ColumnNames& names) {
    for (const std::string& name : names) {
      if (present.erase(name) > 0) measured.push_back(name);
    }
  };
  take(kTimes);
  ColumnNames passes;
  std::copy_if(present.begin(), present.end(), std::back_inserter(passes),
               [](const std::string& name) { return name.starts_with(kPasses); });
  take(passes);
  take(MetricSet().columns(true));
  ColumnNames in_shadow;
  for (const std::string& name : MetricSet().columns(false))
    in_shadow.push_back(fmt::format("{}{}", name, kShadow));
  take(in_shadow);
  take(kReference);
  take(kProvenance);
  result.insert(result.end(), present.begin(), present.end());
  result.insert(result.end(), measured.begin(), measured.end());
  return result;
}

}  // namespace

std::string csv_record(const ColumnNames& fields) {
  std::string out;
  for (const std::string& text : fields) {
    if (&text != &fields.front()) out += ',';
    if (text.find_first_of(",\"\r\n") == std::string::npos) {
      out += text;
      continue;
    }
    out += '"';
    for (const char c : text) {
      if (c == '"') out += '"';
      out += c;
    }
    out += '"';
  }
  return out + "\r\n";
}

namespace {

std::string table(const std::vector<json>& flat, const ColumnNames& names) {
  std::string out = csv_record(names);
  ColumnNames fields(names.size());
  for (const json& row : flat) {
    std::transform(names.begin(), names.end(), fields.begin(), [&](const std::string& n) { return field(row, n); });
    out += csv_record(fields);
  }
  return out;
}

std::vector<json> all_opened(const std::vector<json>& rows) {
  std::vector<json> flat;
  flat.reserve(rows.size());
  for (const json& row : rows)
    flat.push_back(opened(row));
  return flat;
}

}  // namespace

std::string rows_to_csv(const std::vector<json>& rows) {
  const std::vector<json> flat = all_opened(rows);
  return table(flat, columns(flat));
}

std::string rows_to_csv(const std::vector<json>& rows, const ColumnNames& names) {
  return table(all_opened(rows), names);
}

}  // namespace pellucid::sweeps
