#include "tests/sweeps/metrics/slow_flip.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>

namespace pellucid::sweeps::testing {
namespace {

using Triple = std::array<double, 3>;
constexpr double kPi = 3.141592653589793;
constexpr Triple kD65{0.950428545, 1.0, 1.088900371};

struct Plane {
  int width = 0, height = 0;
  std::vector<double> values;
  double clamped(int x, int y) const {
    const int cx = std::clamp(x, 0, width - 1), cy = std::clamp(y, 0, height - 1);
    return values[static_cast<std::size_t>(cy * width + cx)];
  }
};

/// A square filter, given by its weight at each offset.
struct Kernel {
  int radius = 0;
  std::vector<double> weights;
  Kernel(int r, const std::function<double(int, int)>& f) : radius(r) {
    for (int j = -r; j <= r; ++j)
      for (int i = -r; i <= r; ++i)
        weights.push_back(f(i, j));
  }
  double weight(int i, int j) const {
    return weights[static_cast<std::size_t>((j + radius) * (2 * radius + 1) + i + radius)];
  }
  Kernel transposed() const {
    return Kernel(radius, [this](int i, int j) { return weight(j, i); });
  }
};

Kernel summing_to_one(Kernel k) {
  double sum = 0;
  for (double w : k.weights)
    sum += w;
  for (double& w : k.weights)
    w /= sum;
  return k;
}

Kernel halves_summing_to_one(Kernel k) {
  double positive = 0, negative = 0;
  for (double w : k.weights)
    (w > 0 ? positive : negative) += std::abs(w);
  for (double& w : k.weights)
    w /= w > 0 ? positive : negative;
  return k;
}

Plane filtered(const Plane& in, const Kernel& k) {
  Plane out{in.width, in.height, {}};
  for (int y = 0; y < in.height; ++y) {
    for (int x = 0; x < in.width; ++x) {
      double sum = 0;
      for (int j = -k.radius; j <= k.radius; ++j)
        for (int i = -k.radius; i <= k.radius; ++i)
          sum += k.weight(i, j) * in.clamped(x + i, y + j);
      out.values.push_back(sum);
    }
  }
  return out;
}

Triple to_xyz(const Triple& c) {
  return {(10135552 * c[0] + 8788810 * c[1] + 4435075 * c[2]) / 24577794,
          (2613072 * c[0] + 8788810 * c[1] + 887015 * c[2]) / 12288897,
          (1425312 * c[0] + 8788810 * c[1] + 70074185 * c[2]) / 73733382};
}

/// Solves to_xyz(c) = xyz by Cramer's rule.
Triple from_xyz(const Triple& xyz) {
  const Triple columns[3] = {to_xyz({1, 0, 0}), to_xyz({0, 1, 0}), to_xyz({0, 0, 1})};
  const auto determinant = [](const Triple& a, const Triple& b, const Triple& c) {
    return a[0] * (b[1] * c[2] - b[2] * c[1]) - b[0] * (a[1] * c[2] - a[2] * c[1]) + c[0] * (a[1] * b[2] - a[2] * b[1]);
  };
  const double whole = determinant(columns[0], columns[1], columns[2]);
  return {determinant(xyz, columns[1], columns[2]) / whole, determinant(columns[0], xyz, columns[2]) / whole,
          determinant(columns[0], columns[1], xyz) / whole};
}

Triple to_ycxcz(const Triple& linear) {
  const Triple xyz = to_xyz(linear);
  const double x = xyz[0] / kD65[0], y = xyz[1] / kD65[1], z = xyz[2] / kD65[2];
  return {116 * y - 16, 500 * (x - y), 200 * (y - z)};
}

Triple from_ycxcz(const Triple& c) {
  const double y = (c[0] + 16) / 116;
  return from_xyz({(y + c[1] / 500) * kD65[0], y * kD65[1], (y - c[2] / 200) * kD65[2]});
}

Triple to_hunt_lab(const Triple& linear) {
  const Triple xyz = to_xyz(linear);
  const auto f = [&](std::size_t i) {
    const double t = xyz[i] / kD65[i], delta = 6.0 / 29;
    return t > std::pow(delta, 3) ? std::cbrt(t) : t / (3 * delta * delta) + 4.0 / 29;
  };
  const double lightness = 116 * f(1) - 16;
  return {lightness, 0.01 * lightness * 500 * (f(0) - f(1)), 0.01 * lightness * 200 * (f(1) - f(2))};
}

double hyab(const Triple& a, const Triple& b) {
  return std::abs(a[0] - b[0]) + std::hypot(a[1] - b[1], a[2] - b[2]);
}

struct Seen {
  std::vector<Triple> lab;
  std::vector<double> edge, point;
};

Seen see(const std::vector<Triple>& linear, int width, int height, double ppd) {
  Plane opponent[3];
  Plane achromatic{width, height, {}};
  for (Plane& plane : opponent)
    plane = {width, height, {}};
  for (const Triple& c : linear) {
    const Triple o = to_ycxcz(c);
    for (std::size_t i = 0; i < 3; ++i)
      opponent[i].values.push_back(o[i]);
    achromatic.values.push_back((o[0] + 16) / 116);
  }
  const int radius = static_cast<int>(std::ceil(3 * std::sqrt(0.04 / (2 * kPi * kPi)) * ppd));
  const auto sensitivity = [&](double a1, double b1, double a2, double b2) {
    return summing_to_one(Kernel(radius, [=](int i, int j) {
      const double z = (i * i + j * j) / (ppd * ppd);
      return a1 * std::sqrt(kPi / b1) * std::exp(-kPi * kPi * z / b1) +
             a2 * std::sqrt(kPi / b2) * std::exp(-kPi * kPi * z / b2);
    }));
  };
  opponent[0] = filtered(opponent[0], sensitivity(1, 0.0047, 0, 1));
  opponent[1] = filtered(opponent[1], sensitivity(1, 0.0053, 0, 1));
  opponent[2] = filtered(opponent[2], sensitivity(34.1, 0.04, 13.5, 0.025));

  const double sigma = 0.5 * 0.082 * ppd;
  const int feature_radius = static_cast<int>(std::ceil(3 * sigma));
  const auto gauss = [=](int i, int j) { return std::exp(-(i * i + j * j) / (2 * sigma * sigma)); };
  const Kernel edge = halves_summing_to_one(Kernel(feature_radius, [=](int i, int j) { return -i * gauss(i, j); }));
  const Kernel point = halves_summing_to_one(
      Kernel(feature_radius, [=](int i, int j) { return (i * i / (sigma * sigma) - 1) * gauss(i, j); }));
  const Plane edge_x = filtered(achromatic, edge), edge_y = filtered(achromatic, edge.transposed());
  const Plane point_x = filtered(achromatic, point), point_y = filtered(achromatic, point.transposed());

  Seen out;
  for (std::size_t i = 0; i < linear.size(); ++i) {
    Triple c = from_ycxcz({opponent[0].values[i], opponent[1].values[i], opponent[2].values[i]});
    for (double& v : c)
      v = std::clamp(v, 0.0, 1.0);
    out.lab.push_back(to_hunt_lab(c));
    out.edge.push_back(std::hypot(edge_x.values[i], edge_y.values[i]));
    out.point.push_back(std::hypot(point_x.values[i], point_y.values[i]));
  }
  return out;
}

std::vector<double> error(const Seen& reference, const Seen& test) {
  const double largest = std::pow(hyab(to_hunt_lab({0, 1, 0}), to_hunt_lab({0, 0, 1})), 0.7);
  std::vector<double> out;
  for (std::size_t i = 0; i < reference.lab.size(); ++i) {
    const double d = std::pow(hyab(reference.lab[i], test.lab[i]), 0.7);
    const double knee = 0.4 * largest;
    const double color = d < knee ? 0.95 / knee * d : 0.95 + (d - knee) / (largest - knee) * 0.05;
    const double strength =
        std::max(std::abs(reference.edge[i] - test.edge[i]), std::abs(reference.point[i] - test.point[i]));
    out.push_back(std::pow(color, 1 - std::sqrt(strength / std::sqrt(2.0))));
  }
  return out;
}

std::vector<Triple> linear_of(const Image& image, const std::function<double(double)>& f) {
  std::vector<Triple> out;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      out.push_back({f(image.at(x, y)[0]), f(image.at(x, y)[1]), f(image.at(x, y)[2])});
  return out;
}

}  // namespace

std::vector<double> slow_ldr_flip(const Image& reference, const Image& test, double pixels_per_degree) {
  const auto decode = [](double v) { return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4); };
  const auto seen = [&](const Image& image) {
    return see(linear_of(image, decode), image.width, image.height, pixels_per_degree);
  };
  return error(seen(reference), seen(test));
}

std::vector<double> slow_hdr_flip(const Image& reference, const Image& test, double pixels_per_degree,
                                  const std::vector<double>& exposures) {
  std::vector<double> largest(static_cast<std::size_t>(reference.width) * static_cast<std::size_t>(reference.height));
  for (const double stops : exposures) {
    const auto display = [stops](double v) {
      const double x = 0.6 * v * std::pow(2.0, stops);  // Narkowicz's curve with the pre-exposure of HDR-FLIP
      return std::clamp(x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14), 0.0, 1.0);
    };
    const auto seen = [&](const Image& image) {
      return see(linear_of(image, display), image.width, image.height, pixels_per_degree);
    };
    const std::vector<double> errors = error(seen(reference), seen(test));
    for (std::size_t i = 0; i < errors.size(); ++i)
      largest[i] = std::max(largest[i], errors[i]);
  }
  return largest;
}

}  // namespace pellucid::sweeps::testing
