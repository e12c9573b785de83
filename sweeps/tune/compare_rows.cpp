#include "sweeps/tune/compare_rows.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "algorithms/technique.hpp"
#include "sweeps/measure/stopping.hpp"
#include "sweeps/metrics/metrics.hpp"
#include "sweeps/quantities/quantities.hpp"
#include "sweeps/store/rows.hpp"
#include "sweeps/tune/median_interval.hpp"

namespace pellucid::sweeps {
namespace {

using nlohmann::json;

/// Points from which their own scatter is taken as a measure of what changes between runs.
constexpr std::size_t kManyPoints = 20;
/// Re-measurements of the baseline below which their scatter says nothing.
constexpr std::size_t kManyBaselines = 3;
/// Relative difference of metrics that rounding may make.
constexpr double kRounding = 1e-9;

using Rows = std::map<std::string, const json*>;

/// The conditions of a measurement, as against its outcome.
std::string identity(const json& row, const std::vector<std::string>& parameters) {
  std::string text = fmt::format("{} {} {} {}x{}", field_text(row, "technique"), field_text(row, "scene"),
                                 field_text(row, "view"), field_text(row, "width"), field_text(row, "height"));
  for (const std::string& name : parameters) {
    if (row.contains(name)) text += fmt::format(" {}={}", name, field_text(row, name));
  }
  return text;
}

Rows by_identity(const std::vector<json>& rows, const std::vector<std::string>& parameters, bool by_machine) {
  Rows result;
  for (const json& row : rows) {
    if (row.value("status", "") != "ok") continue;
    result.emplace(
        by_machine ? fmt::format("{}\n{}", identity(row, parameters), machine(row)) : identity(row, parameters), &row);
  }
  return result;
}

std::size_t machines(const std::vector<json>& rows) {
  std::set<std::string> names;
  for (const json& row : rows) {
    if (row.value("status", "") == "ok") names.insert(machine(row));
  }
  return names.size();
}

/// The parameters in which some of the rows differ, for a name that people can tell points by.
std::vector<std::string> varying(const Rows& rows, const std::vector<std::string>& parameters) {
  std::vector<std::string> result;
  for (const std::string& name : parameters) {
    std::set<std::string> values;
    for (const auto& [key, row] : rows)
      values.insert(field_text(*row, name));
    if (values.size() > 1) result.push_back(name);
  }
  return result;
}

/// Standard deviation by the median absolute deviation, which a minority of changed points does not move.
double robust_deviation(const std::vector<double>& values) {
  const double center = median_of(values);
  std::vector<double> distances;
  for (const double value : values)
    distances.push_back(std::abs(value - center));
  return 1.4826 * median_of(distances);
}

double variance_of_logs(const std::vector<double>& medians) {
  double mean = 0;
  for (const double ms : medians)
    mean += std::log(ms) / static_cast<double>(medians.size());
  double sum = 0;
  for (const double ms : medians)
    sum += (std::log(ms) - mean) * (std::log(ms) - mean);
  return sum / static_cast<double>(medians.size() - 1);
}

/// How many standard deviations a normal variable exceeds, either way, with the probability `miss`.
double normal_reach(double miss) {
  double low = 0;
  double high = 40;
  for (int i = 0; i < 100; ++i) {
    const double middle = (low + high) / 2;
    (std::erfc(middle / std::sqrt(2.0)) > miss ? low : high) = middle;
  }
  return high;
}

std::vector<double> samples_of(const json& row) {
  const auto found = row.find("frame_ms_samples");
  return found != row.end() && found->is_array() ? found->get<std::vector<double>>() : std::vector<double>{};
}

double median_ms(const json& row) {
  return row.contains("frame_ms_median") && row.at("frame_ms_median").is_number()
             ? row.at("frame_ms_median").get<double>()
             : 0;
}

bool more_is_better(const std::string& metric) {
  const Quantity* declared = find_quantity(metric);
  return declared != nullptr && declared->better == Better::more;
}

void compare_quality(ComparedPoint& point, const json& a, const json& b, const CompareOptions& options) {
  const std::vector<std::string> names = options.metrics.empty() ? MetricSet().columns(true) : options.metrics;
  bool better = false;
  bool worse = false;
  for (const std::string& metric : names) {
    if (!a.contains(metric) || !b.contains(metric) || !a.at(metric).is_number() || !b.at(metric).is_number()) continue;
    if (point.quality == QualityChange::unknown) point.quality = QualityChange::same;
    const double in_a = a.at(metric).get<double>();
    const double in_b = b.at(metric).get<double>();
    if (std::abs(in_a - in_b) <= kRounding * std::max(std::abs(in_a), std::abs(in_b))) continue;
    point.metrics[metric] = {in_a, in_b};
    const bool up = (in_b > in_a) == more_is_better(metric);
    (up ? better : worse) = true;
    const double scale = std::max(std::abs(in_a), 1e-12);
    if (!up && std::abs(in_b - in_a) > options.tolerance * scale) point.regression = true;
  }
  if (worse) point.quality = QualityChange::worse;
  if (better && !worse) point.quality = QualityChange::better;
}

}  // namespace

const char* name(TimeChange change) {
  switch (change) {
    case TimeChange::untimed:
      return "untimed";
    case TimeChange::same:
      return "same";
    case TimeChange::undecided:
      return "undecided";
    case TimeChange::faster:
      return "faster";
    case TimeChange::slower:
      break;
  }
  return "slower";
}

const char* name(QualityChange change) {
  switch (change) {
    case QualityChange::unknown:
      return "unknown";
    case QualityChange::same:
      return "same";
    case QualityChange::better:
      return "better";
    case QualityChange::worse:
      break;
  }
  return "worse";
}

std::size_t RowComparison::count(TimeChange change) const {
  return static_cast<std::size_t>(
      std::count_if(points.begin(), points.end(), [&](const auto& p) { return p.time == change; }));
}
std::size_t RowComparison::count(QualityChange change) const {
  return static_cast<std::size_t>(
      std::count_if(points.begin(), points.end(), [&](const auto& p) { return p.quality == change; }));
}
std::size_t RowComparison::regressions() const {
  return static_cast<std::size_t>(
      std::count_if(points.begin(), points.end(), [](const auto& p) { return p.regression; }));
}

RowComparison compare_rows(const std::vector<json>& a, const std::vector<json>& b,
                           const std::vector<std::string>& parameters, const std::vector<double>& baselines_a,
                           const std::vector<double>& baselines_b, const CompareOptions& options) {
  const bool by_machine = machines(a) > 1 || machines(b) > 1;
  const Rows in_a = by_identity(a, parameters, by_machine);
  const Rows in_b = by_identity(b, parameters, by_machine);
  RowComparison result;
  std::vector<std::pair<const json*, const json*>> pairs;
  for (const auto& [key, row] : in_a) {
    const auto partner = in_b.find(key);
    if (partner == in_b.end()) {
      ++result.only_in_a;
    } else {
      pairs.emplace_back(row, partner->second);
    }
  }
  result.only_in_b = in_b.size() - pairs.size();

  std::vector<double> logs;
  for (const auto& [row_a, row_b] : pairs) {
    if (median_ms(*row_a) > 0 && median_ms(*row_b) > 0) logs.push_back(std::log(median_ms(*row_b) / median_ms(*row_a)));
  }
  const std::size_t timed = std::max<std::size_t>(1, logs.size());
  // Šidák: n intervals at this confidence hold together with 1 − alpha. Each median takes half of what may go wrong.
  const double miss = -std::expm1(std::log1p(-options.alpha) / static_cast<double>(timed));
  result.confidence = 1 - miss;
  if (options.between_runs && baselines_a.size() >= kManyBaselines && baselines_b.size() >= kManyBaselines)
    result.between_runs = std::sqrt(variance_of_logs(baselines_a) + variance_of_logs(baselines_b));
  if (options.between_runs && logs.size() >= kManyPoints)
    result.between_runs = std::max(result.between_runs, robust_deviation(logs));
  const double reach = normal_reach(miss);

  const std::vector<std::string> shown = varying(in_a, parameters);
  for (const auto& [row_a, row_b] : pairs) {
    ComparedPoint point;
    point.point = identity(*row_a, shown);
    point.device = machine(*row_b);
    compare_quality(point, *row_a, *row_b, options);
    const double ms_a = median_ms(*row_a);
    const double ms_b = median_ms(*row_b);
    if (ms_a > 0 && ms_b > 0) {
      point.ratio = ms_b / ms_a;
      point.time = TimeChange::undecided;
      const auto range_a = median_interval(samples_of(*row_a), 1 - miss / 2);
      const auto range_b = median_interval(samples_of(*row_b), 1 - miss / 2);
      if (range_a && range_b && range_a->low > 0) {
        const double log_ratio = std::log(point.ratio);
        const double spread = reach * result.between_runs;
        const double below = log_ratio - std::log(range_b->low / range_a->high);
        const double above = std::log(range_b->high / range_a->low) - log_ratio;
        point.range =
            Interval{std::exp(log_ratio - std::hypot(below, spread)), std::exp(log_ratio + std::hypot(above, spread))};
        if (point.range->low > 1) {
          point.time = TimeChange::slower;
        } else if (point.range->high < 1) {
          point.time = TimeChange::faster;
        } else if (point.range->low >= 1 / (1 + options.tolerance) && point.range->high <= 1 + options.tolerance) {
          point.time = TimeChange::same;
        }
      }
      if (point.time == TimeChange::slower && point.ratio > 1 + options.tolerance) point.regression = true;
    }
    result.points.push_back(std::move(point));
  }
  return result;
}

std::vector<std::string> guess_parameters(const std::vector<json>& rows) {
  std::set<std::string> names;
  for (const TechniqueInfo& technique : techniques()) {
    for (const ParameterInfo& info : technique.table().infos())
      names.insert(info.name);
  }
  for (const json& row : rows) {
    for (const auto& [field, value] : row.items()) {
      const bool prefixed = field.starts_with("scene.") || field.starts_with("frame.") || field.starts_with("shadow.");
      if (prefixed) names.insert(field);
    }
  }
  return {names.begin(), names.end()};
}

}  // namespace pellucid::sweeps
