#include "algorithms/scattering/transfer_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

namespace pellucid::scattering {
namespace {

using std::numbers::pi;
// From far below what any map resolves to nearly uniform.
constexpr double kNarrowest = 2e-4, kWidest = 4.0;
constexpr int kHalvings = 12;
constexpr double kStep = 0.5 * pi / 180;
constexpr int kWidths = 48;  // of the first look, equally far apart in their logarithm

// The integral of a Gaussian in the angle, between a and b and but for the normalisation. On a step this short the sine
// over its angle hardly varies, and what is left has a closed form, however narrow the Gaussian is.
double step_energy(double width, double a, double b) {
  const double inverse = 0.5 / (width * width);
  const double ring = (std::exp(-a * a * inverse) - std::exp(-b * b * inverse)) / (2 * inverse);
  // Where the mass lies in the step: at its near end for a narrow Gaussian.
  const double middle = std::min(0.5 * (a + b), a + width);
  return ring * (middle > 0 ? std::sin(middle) / middle : 1.0);
}

/// Energy within angles, compared with what is wanted at each; `share` is the step of angle that each stands for.
class Curve {
 public:
  explicit Curve(const SlabLight& light, double apart) {
    // The ordinates' weights part [0, 1] into bins, whose ends are where the flux is known.
    double cosine = 1, within = light.transmittance - apart;
    std::vector<double> flux(light.cosine.size());
    for (std::size_t i = 0; i < flux.size(); ++i) {
      flux[i] = 2 * pi * light.weight[i] * light.cosine[i] * light.transmission[i];
      within -= flux[i];
    }
    angles_.push_back(0);
    wanted_.push_back(within);  // what is not scattered and not apart
    // Near straight on a Gaussian may be far narrower than the first bin, in which the scattered light is uniform.
    const double first = std::acos(1 - light.weight[0]);
    for (int halvings = kHalvings; halvings > 0; --halvings) {
      const double angle = std::ldexp(first, -halvings);
      angles_.push_back(angle);
      wanted_.push_back(within + flux[0] * (1 - std::cos(angle)) / light.weight[0]);
    }
    for (std::size_t i = 0; i < flux.size(); ++i) {
      // Within a bin the radiance is taken for uniform. The steps are so short that the fit sees no stairs.
      const double low = angles_.back(), next = std::max(cosine - light.weight[i], 0.0), high = std::acos(next);
      const int steps = 1 + static_cast<int>((high - low) / kStep);
      for (int k = 1; k <= steps; ++k) {
        const double angle = low + (high - low) * k / steps;
        angles_.push_back(angle);
        wanted_.push_back(within + flux[i] * (cosine - std::cos(angle)) / (cosine - next));
      }
      cosine = next;
      within += flux[i];
    }
    total_ = light.transmittance - apart;
    constexpr int kBehind = 16;  // no light is wanted there, and all models put some
    for (int i = 1; i <= kBehind; ++i) {
      angles_.push_back(pi / 2 * (1 + static_cast<double>(i) / kBehind));
      wanted_.push_back(total_);
    }
    for (std::size_t i = 0; i < angles_.size(); ++i) {
      const double before = i > 0 ? angles_[i - 1] : angles_[i];
      const double after = i + 1 < angles_.size() ? angles_[i + 1] : angles_[i];
      share_.push_back(0.5 * (after - before) / pi);
    }
  }

  double total() const { return total_; }
  const std::vector<double>& wanted() const { return wanted_; }

  std::vector<double> uniform() const {
    std::vector<double> out;
    for (const double angle : angles_)
      out.push_back(0.5 * (1 - std::cos(angle)));
    return out;
  }
  std::vector<double> gaussian(double width) const {
    std::vector<double> out(angles_.size());
    for (std::size_t i = 1; i < angles_.size(); ++i)
      out[i] = out[i - 1] + step_energy(width, angles_[i - 1], angles_[i]);
    for (double& value : out)
      value /= out.back();
    return out;
  }
  double product(const std::vector<double>& a, const std::vector<double>& b) const {
    double sum = 0;
    for (std::size_t i = 0; i < share_.size(); ++i)
      sum += share_[i] * a[i] * b[i];
    return sum;
  }

 private:
  std::vector<double> angles_, wanted_, share_;
  double total_ = 0;
};

/// The part f of the total that the first of two curves takes, the second the rest, and the squared distance left.
struct Parting {
  double f = 0, squares = 0;
};
Parting part(const Curve& curve, const std::vector<double>& first, const std::vector<double>& second) {
  std::vector<double> left(first.size()), between(first.size());
  for (std::size_t i = 0; i < first.size(); ++i) {
    left[i] = curve.wanted()[i] - curve.total() * second[i];
    between[i] = first[i] - second[i];
  }
  const double spread = curve.product(between, between), along = curve.product(left, between);
  Parting out;
  out.f = spread > 0 ? std::clamp(along / spread, 0.0, std::max(curve.total(), 0.0)) : curve.total();
  out.squares = curve.product(left, left) - 2 * out.f * along + out.f * out.f * spread;
  return out;
}

double width_at(double step) {
  return kNarrowest * std::pow(kWidest / kNarrowest, step / (kWidths - 1));
}

// The least of f between a and b, where it has one valley (golden section).
template <class F>
double least(double a, double b, int passes, F f) {
  constexpr double kGolden = 0.6180339887498949;
  double x = b - kGolden * (b - a), y = a + kGolden * (b - a), fx = f(x), fy = f(y);
  for (int i = 0; i < passes; ++i) {
    if (fx < fy) {
      b = y, y = x, fy = fx;
      fx = f(x = b - kGolden * (b - a));
    } else {
      a = x, x = y, fx = fy;
      fy = f(y = a + kGolden * (b - a));
    }
  }
  return 0.5 * (a + b);
}

void fit_one(const Curve& curve, TransferFit& fit) {
  const std::vector<double> uniform = curve.uniform();
  const auto squares = [&](double step) { return part(curve, curve.gaussian(width_at(step)), uniform).squares; };
  int best = 0;
  double lowest = squares(0);
  for (int i = 1; i < kWidths; ++i) {
    if (const double value = squares(i); value < lowest) {
      lowest = value;
      best = i;
    }
  }
  const double step = least(std::max(best - 1, 0), std::min(best + 1, kWidths - 1), 24, squares);
  fit.theta_bar = width_at(step);
  const Parting parting = part(curve, curve.gaussian(fit.theta_bar), uniform);
  fit.f_t = parting.f;
  fit.c_t = curve.total() - parting.f;
  fit.rms = std::sqrt(std::max(0.0, parting.squares));
}

void fit_two(const Curve& curve, TransferFit& fit) {
  std::vector<std::vector<double>> curves;
  for (int i = 0; i < kWidths; ++i)
    curves.push_back(curve.gaussian(width_at(i)));
  double first = 0, second = 1, lowest = part(curve, curves[0], curves[1]).squares;
  for (int i = 0; i < kWidths; ++i) {
    for (int j = i + 1; j < kWidths; ++j) {
      const double value =
          part(curve, curves[static_cast<std::size_t>(i)], curves[static_cast<std::size_t>(j)]).squares;
      if (value < lowest) {
        lowest = value;
        first = i;
        second = j;
      }
    }
  }
  const double end = kWidths - 1;
  for (int round = 0; round < 6; ++round) {
    const double reach = 1.0 / (1 << (round / 2));
    const auto wide = curve.gaussian(width_at(second));
    first = least(std::max(first - reach, 0.0), std::min(first + reach, second), 12,
                  [&](double step) { return part(curve, curve.gaussian(width_at(step)), wide).squares; });
    const auto narrow = curve.gaussian(width_at(first));
    second = least(std::max(second - reach, first), std::min(second + reach, end), 12,
                   [&](double step) { return part(curve, narrow, curve.gaussian(width_at(step))).squares; });
  }
  fit.theta_bar = width_at(first);
  fit.theta_2 = width_at(second);
  const Parting parting = part(curve, curve.gaussian(fit.theta_bar), curve.gaussian(fit.theta_2));
  fit.f_t = parting.f;
  fit.f_2 = curve.total() - parting.f;
  fit.rms = std::sqrt(std::max(0.0, parting.squares));
}

}  // namespace

double gaussian_within(double width, double angle) {
  constexpr int kSteps = 256;
  double within = 0, all = 0;
  for (int i = 0; i < kSteps; ++i) {
    within += step_energy(width, angle * i / kSteps, angle * (i + 1) / kSteps);
    all += step_energy(width, pi * i / kSteps, pi * (i + 1) / kSteps);
  }
  return within / all;
}

TransferFit fit_transfer(const SlabLight& light, TransferModel model) {
  TransferFit fit;
  fit.c_r = light.reflectance;
  fit.sharp = model == TransferModel::unscattered ? light.unscattered : 0.0;
  const Curve curve(light, fit.sharp);
  if (model == TransferModel::two_gaussians)
    fit_two(curve, fit);
  else
    fit_one(curve, fit);
  return fit;
}

}  // namespace pellucid::scattering
