#include "sweeps/metrics/metrics.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "algorithms/parameters.hpp"
#include "gl/error.hpp"
#include "sweeps/metrics/pixels.hpp"
#include "sweeps/metrics/ssim.hpp"

namespace pellucid::sweeps {
namespace {

std::size_t size(int n) {
  return static_cast<std::size_t>(n);
}

/// Sums over the R, G and B of a set of pixels.
struct Sums {
  double squared = 0, relative = 0, absolute = 0, symmetric = 0;
  double count = 0;

  void add(double r, double t) {
    constexpr double kRelativeEpsilon = 0.01, kSymmetricEpsilon = 0.01;
    const double d = t - r;
    squared += d * d;
    relative += d * d / (r * r + kRelativeEpsilon);
    absolute += std::abs(d);
    symmetric += std::abs(d) / (std::abs(t) + std::abs(r) + kSymmetricEpsilon);
    ++count;
  }
  void add(const Sums& part) {
    squared += part.squared;
    relative += part.relative;
    absolute += part.absolute;
    symmetric += part.symmetric;
    count += part.count;
  }
};

}  // namespace

std::vector<std::string> metric_names() {
  return {"flip", "mse", "rmse", "relmse", "mae", "smape", "psnr", "ssim"};
}

MetricSet::MetricSet() : names_(metric_names()) {}

MetricSet::MetricSet(std::span<const std::string> names) {
  const std::vector<std::string> known = metric_names();
  for (const std::string& name : names) {
    if (std::ranges::find(known, name) != known.end()) continue;
    const std::string near = nearest_name(name, known);
    throw InputError(near.empty() ? fmt::format("unknown metric '{}'; one of {}", name, fmt::join(known, ", "))
                                  : fmt::format("unknown metric '{}'; did you mean '{}'?", name, near));
  }
  if (names.empty()) throw InputError(fmt::format("no metric given; choose from {}", fmt::join(known, ", ")));
  for (const std::string& name : known)
    if (std::ranges::find(names, name) != names.end()) names_.push_back(name);
}

bool MetricSet::has(std::string_view name) const {
  return std::ranges::find(names_, name) != names_.end();
}

std::vector<std::string> MetricSet::columns(bool masked) const {
  std::vector<std::string> out;
  for (const char* suffix : {"", "_mask"}) {
    if (*suffix != '\0' && !masked) break;
    for (const std::string& name : names_) {
      if (name == "flip") {
        for (const char* statistic : {"mean", "weighted_median", "weighted_q1", "weighted_q3", "min", "max"})
          out.push_back(fmt::format("flip_{}{}", statistic, suffix));
      } else {
        out.push_back(name + suffix);
      }
    }
  }
  return out;
}

double ComparisonResult::at(std::string_view name) const {
  for (const auto& [key, value] : values)
    if (key == name) return value;
  throw std::out_of_range(fmt::format("no metric value '{}'", name));
}

void put_values(nlohmann::json& row, const ComparisonResult& result) {
  for (const auto& [name, value] : result.values)
    row[name] = std::isfinite(value) ? nlohmann::json(value) : nullptr;
}

struct Comparison::State {
  /// A Region as one flag a pixel.
  struct Marked {
    std::string suffix;
    std::vector<char> pixels;
  };
  Image reference;
  ComparisonOptions options;
  std::vector<Marked> regions;
  double peak = 1;  ///< of PSNR
  std::optional<FlipReference> flip;
  std::optional<SsimReference> ssim;

  bool inside(const Marked& region, int x, int y) const {
    return region.pixels[size(y) * size(reference.width) + size(x)] != 0;
  }
  void add_region(const std::string& suffix, const Image& mask);
  std::vector<std::pair<std::string, double>> pixel_values(const Sums&) const;
  double ssim_mean(const std::vector<double>& map, const Marked*) const;
};

void Comparison::State::add_region(const std::string& suffix, const Image& image) {
  check_pixels(image, "mask");
  check_same_size(reference, image, "the mask");
  Marked region{suffix, {}};
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      region.pixels.push_back(image.at(x, y)[0] > 0.5f);
  if (std::ranges::count(region.pixels, 1) == 0) throw InputError("the mask marks no pixel (none is above 0.5)");
  bool in_windows = !ssim;
  for (int y = 0; !in_windows && y < ssim->map_height(); ++y)
    for (int x = 0; !in_windows && x < ssim->map_width(); ++x)
      in_windows = inside(region, x + SsimReference::kRadius, y + SsimReference::kRadius);
  if (!in_windows)
    throw InputError(
        fmt::format("the mask marks no pixel at least {} from the border, where ssim is defined; leave ssim out",
                    SsimReference::kRadius));
  regions.push_back(std::move(region));
}

std::vector<std::pair<std::string, double>> Comparison::State::pixel_values(const Sums& sums) const {
  const double mse = sums.squared / sums.count;
  const double psnr = mse > 0 ? 10 * std::log10(peak * peak / mse) : std::numeric_limits<double>::infinity();
  return {{"mse", mse},
          {"rmse", std::sqrt(mse)},
          {"relmse", sums.relative / sums.count},
          {"mae", sums.absolute / sums.count},
          {"smape", sums.symmetric / sums.count},
          {"psnr", psnr}};
}

double Comparison::State::ssim_mean(const std::vector<double>& map, const Marked* region) const {
  double sum = 0, count = 0;
  for (int y = 0; y < ssim->map_height(); ++y) {
    for (int x = 0; x < ssim->map_width(); ++x) {
      if (region && !inside(*region, x + SsimReference::kRadius, y + SsimReference::kRadius)) continue;
      sum += map[size(y) * size(ssim->map_width()) + size(x)];
      ++count;
    }
  }
  return sum / count;
}

Comparison::Comparison(Image reference, const Image* mask, ComparisonOptions options)
    : Comparison(std::move(reference), mask ? std::vector<Region>{{"_mask", *mask}} : std::vector<Region>{},
                 std::move(options)) {}

Comparison::Comparison(Image reference, const std::vector<Region>& regions, ComparisonOptions options)
    : state_(std::make_unique<State>()) {
  check_pixels(reference, "reference");
  if (options.display_encoded && options.exposures)
    throw InputError("exposures are for scene-linear images; these are display-encoded");
  state_->reference = std::move(reference);
  state_->options = std::move(options);
  const Image& r = state_->reference;
  const ComparisonOptions& o = state_->options;
  if (!o.display_encoded) {
    double brightest = 0;
    for (int y = 0; y < r.height; ++y)
      for (int x = 0; x < r.width; ++x)
        for (int c = 0; c < 3; ++c)
          brightest = std::max(brightest, double{channel(r, r.at(x, y), c)});
    state_->peak = brightest > 0 ? brightest : 1;
  }
  if (o.metrics.has("ssim")) state_->ssim.emplace(r, o.display_encoded);
  for (const Region& region : regions)
    state_->add_region(region.suffix, region.mask);
  if (o.metrics.has("flip") || o.keep_map) {
    if (o.display_encoded)
      state_->flip = FlipReference::display_encoded(r, o.flip);
    else
      state_->flip = FlipReference::scene_linear(r, o.exposures ? *o.exposures : automatic_exposures(r), o.flip);
  }
}

Comparison::Comparison(Comparison&&) noexcept = default;
Comparison& Comparison::operator=(Comparison&&) noexcept = default;
Comparison::~Comparison() = default;

bool Comparison::masked() const {
  return std::ranges::any_of(state_->regions, [](const State::Marked& region) { return region.suffix == "_mask"; });
}

const Exposures* Comparison::exposures() const {
  return state_->flip && !state_->options.display_encoded ? &state_->flip->exposures() : nullptr;
}

ComparisonResult Comparison::compare(const Image& test) const {
  const Image& reference = state_->reference;
  const MetricSet& metrics = state_->options.metrics;
  check_same_size(reference, test, "test");
  check_pixels(test, "test");

  // The frame, then each region.
  std::vector<Sums> totals(1 + state_->regions.size());
  for (int y = 0; y < reference.height; ++y) {
    // Sums of rows first: a frame's worth of small terms then loses nothing to rounding.
    std::vector<Sums> rows(totals.size());
    for (int x = 0; x < reference.width; ++x) {
      for (int c = 0; c < 3; ++c) {
        const double r = channel(reference, reference.at(x, y), c), t = channel(test, test.at(x, y), c);
        rows[0].add(r, t);
        for (std::size_t i = 0; i < state_->regions.size(); ++i)
          if (state_->inside(state_->regions[i], x, y)) rows[i + 1].add(r, t);
      }
    }
    for (std::size_t i = 0; i < totals.size(); ++i)
      totals[i].add(rows[i]);
  }

  ComparisonResult result;
  Image map;
  if (state_->flip) map = state_->flip->map(test);
  std::vector<double> ssim_map;
  if (state_->ssim) ssim_map = state_->ssim->map(test);

  for (std::size_t i = 0; i < totals.size(); ++i) {
    const State::Marked* region = i == 0 ? nullptr : &state_->regions[i - 1];
    const std::string suffix = region ? region->suffix : "";
    if (metrics.has("flip")) {
      std::vector<float> errors;
      for (std::size_t p = 0; region && p < map.pixels.size(); ++p)
        if (region->pixels[p]) errors.push_back(map.pixels[p]);
      const FlipStatistics s = pool(region ? errors : map.pixels);
      for (const auto& [name, value] :
           {std::pair{"mean", s.mean}, std::pair{"weighted_median", s.weighted_median},
            std::pair{"weighted_q1", s.weighted_q1}, std::pair{"weighted_q3", s.weighted_q3}, std::pair{"min", s.min},
            std::pair{"max", s.max}})
        result.values.emplace_back(fmt::format("flip_{}{}", name, suffix), value);
    }
    for (const auto& [name, value] : state_->pixel_values(totals[i]))
      if (metrics.has(name)) result.values.emplace_back(name + suffix, value);
    if (state_->ssim) result.values.emplace_back("ssim" + suffix, state_->ssim_mean(ssim_map, region));
  }
  if (state_->options.keep_map) result.flip_map = std::move(map);
  return result;
}

}  // namespace pellucid::sweeps
