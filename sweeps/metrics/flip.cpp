#include "sweeps/metrics/flip.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "gl/error.hpp"
#include "sweeps/metrics/flip_perception.hpp"
#include "sweeps/metrics/pixels.hpp"

namespace pellucid::sweeps {

Exposures automatic_exposures(const Image& reference) {
  check_pixels(reference, "reference");
  std::vector<double> luminance;
  luminance.reserve(static_cast<std::size_t>(reference.width) * static_cast<std::size_t>(reference.height));
  for (int y = 0; y < reference.height; ++y) {
    for (int x = 0; x < reference.width; ++x) {
      const auto value = [&](int c) { return std::max(0.0, double{channel(reference, reference.at(x, y), c)}); };
      luminance.push_back(rec709(value(0), value(1), value(2)));
    }
  }
  const double brightest = *std::max_element(luminance.begin(), luminance.end());
  if (brightest <= 0) return {0, 0, 2};
  const auto median = [](std::vector<double>& values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
  };
  double typical = median(luminance);
  if (typical <= 0) {
    std::erase_if(luminance, [](double v) { return v <= 0; });
    typical = median(luminance);
  }
  // The x that the curve takes to t = 0.85: (k0 - t k3) x^2 + (k1 - t k4) x + (k2 - t k5) = 0, its positive root.
  constexpr double t = 0.85;
  const auto& k = flip::kAces;
  const double a = k[0] - t * k[3], b = k[1] - t * k[4], c = k[2] - t * k[5];
  const double x_t = (-b + std::sqrt(b * b - 4 * a * c)) / (2 * a);
  Exposures out{std::log2(x_t / brightest), std::log2(x_t / typical), 0};
  // One exposure a stop; the quotient's logarithm, as the difference of the two may round above a whole number.
  out.count = std::max(2, static_cast<int>(std::ceil(std::log2(brightest / typical))));
  return out;
}

struct FlipReference::State {
  State(const Image& image, bool hdr, const Exposures& used, const FlipOptions& given)
      : reference(image), scene_linear(hdr), exposures(used), options(given), filters(given.pixels_per_degree) {}

  const Image reference;
  const bool scene_linear;
  const Exposures exposures;
  const FlipOptions options;
  const flip::Filters filters;
  /// One for each exposure, or empty when they would be too large: kChannels planes of width x height.
  std::vector<std::vector<float>> perceived;

  int passes() const { return scene_linear ? exposures.count : 1; }
  std::size_t area() const {
    return static_cast<std::size_t>(reference.width) * static_cast<std::size_t>(reference.height);
  }

  /// The displayed image at an exposure, as linear components in [0, 1].
  flip::LinearSource displayed(const Image& image, int pass) const {
    // In double: the gain of a reference of tiny radiances is beyond float, and 0 times infinity would be NaN.
    const double gain = scene_linear ? std::exp2(exposures.at(pass)) : 1.0;
    return [&image, gain, hdr = scene_linear](int y, float* r, float* g, float* b) {
      float* out[3] = {r, g, b};
      for (int x = 0; x < image.width; ++x) {
        for (int c = 0; c < 3; ++c) {
          const float v = channel(image, image.at(x, y), c);
          out[c][x] = hdr ? flip::aces(gain * double{std::max(v, 0.0f)}) : srgb_to_linear(std::clamp(v, 0.0f, 1.0f));
        }
      }
    };
  }

  std::vector<float> perceive_reference(flip::Perception& perception, int pass) const {
    std::vector<float> planes(flip::kChannels * area());
    perception.run(displayed(reference, pass), [&](int y, const flip::Row& row) {
      for (std::size_t c = 0; c < flip::kChannels; ++c)
        std::copy_n(row[c], reference.width, planes.data() + c * area() + reference_offset(y));
    });
    return planes;
  }

  std::size_t reference_offset(int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(reference.width);
  }
};

FlipReference::FlipReference(std::unique_ptr<State> state) : state_(std::move(state)) {
  const std::size_t bytes =
      static_cast<std::size_t>(state_->passes()) * flip::kChannels * state_->area() * sizeof(float);
  if (bytes > state_->options.largest_cache_bytes) return;
  flip::Perception perception(state_->reference.width, state_->reference.height, state_->filters);
  for (int i = 0; i < state_->passes(); ++i)
    state_->perceived.push_back(state_->perceive_reference(perception, i));
}

FlipReference::FlipReference(FlipReference&&) noexcept = default;
FlipReference& FlipReference::operator=(FlipReference&&) noexcept = default;
FlipReference::~FlipReference() = default;

namespace {

void check_options(const FlipOptions& options) {
  if (!(options.pixels_per_degree >= 1 && options.pixels_per_degree <= 1000))
    throw InputError(fmt::format("pixels per degree = {} is out of range [1, 1000]", options.pixels_per_degree));
}

}  // namespace

FlipReference FlipReference::display_encoded(const Image& reference, const FlipOptions& options) {
  check_pixels(reference, "reference");
  check_options(options);
  return FlipReference(std::make_unique<State>(reference, false, Exposures{}, options));
}

FlipReference FlipReference::scene_linear(const Image& reference, const Exposures& exposures,
                                          const FlipOptions& options) {
  check_pixels(reference, "reference");
  check_options(options);
  constexpr double kMostStops = 200;  // floats span 277
  constexpr int kMostExposures = 1000;
  if (!(std::abs(exposures.start) <= kMostStops && std::abs(exposures.stop) <= kMostStops))
    throw InputError(fmt::format("exposures from {} to {} stops are out of range [-{}, {}]", exposures.start,
                                 exposures.stop, kMostStops, kMostStops));
  if (exposures.start > exposures.stop)
    throw InputError(fmt::format("the first exposure, {}, is above the last, {}", exposures.start, exposures.stop));
  if (exposures.count < 1 || exposures.count > kMostExposures)
    throw InputError(fmt::format("{} exposures are out of range [1, {}]", exposures.count, kMostExposures));
  return FlipReference(std::make_unique<State>(reference, true, exposures, options));
}

const Exposures& FlipReference::exposures() const {
  return state_->exposures;
}

Image FlipReference::map(const Image& test) const {
  const State& state = *state_;
  check_same_size(state.reference, test, "test");
  check_pixels(test, "test");
  const int width = test.width;
  Image map(width, test.height, 1);
  flip::Perception perception(width, test.height, state.filters);
  for (int i = 0; i < state.passes(); ++i) {
    std::vector<float> computed;
    if (state.perceived.empty()) computed = state.perceive_reference(perception, i);
    const std::vector<float>& planes =
        state.perceived.empty() ? computed : state.perceived[static_cast<std::size_t>(i)];
    perception.run(state.displayed(test, i), [&](int y, const flip::Row& seen) {
      flip::Row wanted;
      for (std::size_t c = 0; c < flip::kChannels; ++c)
        wanted[c] = planes.data() + c * state.area() + state.reference_offset(y);
      std::vector<float> error(static_cast<std::size_t>(width));
      flip::combine(wanted, seen, width, error.data());
      float* out = map.at(0, y);
      for (int x = 0; x < width; ++x)
        out[x] = std::max(out[x], error[static_cast<std::size_t>(x)]);
    });
  }
  return map;
}

}  // namespace pellucid::sweeps
