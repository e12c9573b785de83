#include "sweeps/metrics/flip_perception.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace pellucid::sweeps::flip {
namespace {

constexpr int kBlock = 16;  // floats that a convolution keeps in registers

int whole_blocks(int n) {
  return (n + kBlock - 1) / kBlock * kBlock;
}

// ---- colour ----

// Linear Rec. 709 to XYZ and the D65 white of the published tool (its rows sum to the white).
constexpr double kToXyz[3][3] = {{10135552.0 / 24577794, 8788810.0 / 24577794, 4435075.0 / 24577794},
                                 {2613072.0 / 12288897, 8788810.0 / 12288897, 887015.0 / 12288897},
                                 {1425312.0 / 73733382, 8788810.0 / 73733382, 70074185.0 / 73733382}};
constexpr double kWhite[3] = {0.950428545, 1.0, 1.088900371};
constexpr double kFromXyz[3][3] = {{3.241003275, -1.537398934, -0.498615861},
                                   {-0.969224334, 1.875930071, 0.041554224},
                                   {0.055639423, -0.204011202, 1.057148933}};

struct Vector {
  float v[3];
};

/// X/Xn, Y/Yn, Z/Zn.
inline Vector relative_xyz(float r, float g, float b) {
  Vector out{};
  for (int i = 0; i < 3; ++i)
    out.v[i] = static_cast<float>(kToXyz[i][0] / kWhite[i]) * r + static_cast<float>(kToXyz[i][1] / kWhite[i]) * g +
               static_cast<float>(kToXyz[i][2] / kWhite[i]) * b;
  return out;
}

/// The cube root of t > 0: a third of the exponent and two Halley steps, exact to float. The library's takes four times
/// as long and was a third of FLIP's whole time.
inline float cube_root(float t) {
  float y = std::bit_cast<float>(std::bit_cast<std::uint32_t>(t) / 3 + 709921077u);
  for (int i = 0; i < 2; ++i) {
    const float cube = y * y * y;
    y *= (cube + 2 * t) / (2 * cube + t);
  }
  return y;
}

inline float lab_curve(float t) {
  constexpr float kDelta = 6.0f / 29.0f;
  constexpr float kLimit = kDelta * kDelta * kDelta;
  const float root = cube_root(std::max(t, kLimit));
  return t > kLimit ? root : t / (3 * kDelta * kDelta) + 4.0f / 29.0f;
}

/// L*, and a* and b* scaled by 0.01 L* (the Hunt effect: colours look less colourful in the dark).
inline Vector hunt_lab(float r, float g, float b) {
  const Vector xyz = relative_xyz(r, g, b);
  const float fx = lab_curve(xyz.v[0]), fy = lab_curve(xyz.v[1]), fz = lab_curve(xyz.v[2]);
  const float lightness = 116 * fy - 16;
  return {{lightness, 0.01f * lightness * 500 * (fx - fy), 0.01f * lightness * 200 * (fy - fz)}};
}

inline float hyab(const Vector& p, const Vector& q) {
  const float da = p.v[1] - q.v[1], db = p.v[2] - q.v[2];
  return std::abs(p.v[0] - q.v[0]) + std::sqrt(da * da + db * db);
}

// q_c, p_c and p_t of the paper; its q_f = 0.5 is a square root.
constexpr float kColorExponent = 0.7f, kKnee = 0.4f, kKneeError = 0.95f;

/// c_max: the largest distance in the Rec. 709 gamut is from green to blue.
float largest_color_distance() {
  static const float distance = std::pow(hyab(hunt_lab(0, 1, 0), hunt_lab(0, 0, 1)), kColorExponent);
  return distance;
}

// ---- convolution ----

enum class Parity { even, odd, zero_sum };

/// out[x] = sum over k of w[k] (taps[k][x] ± taps[-k][x]) for x in [0, width), or out += the same. A zero-sum filter is
/// applied to the differences from the centre, an odd one to those of the sides: both are then exactly 0 on a flat
/// region, where the square root in FLIP's features would turn rounding of 1e-8 into an error of 1e-4.
/// Whole blocks are read and written, up to whole_blocks(width).
template <Parity parity, bool add = false>
void convolve(const float* const* taps, const std::vector<float>& w, int width, float* out) {
  const int radius = static_cast<int>(w.size()) - 1;
  for (int x = 0; x < width; x += kBlock) {
    const float* centre = taps[0] + x;
    float sum[kBlock];
    for (int i = 0; i < kBlock; ++i) {
      sum[i] = add ? out[x + i] : 0.0f;
      if (parity == Parity::even) sum[i] += w[0] * centre[i];
    }
    for (int k = 1; k <= radius; ++k) {
      const float* plus = taps[k] + x;
      const float* minus = taps[-k] + x;
      const float weight = w[static_cast<std::size_t>(k)];
      for (int i = 0; i < kBlock; ++i) {
        if (parity == Parity::even) sum[i] += weight * (plus[i] + minus[i]);
        if (parity == Parity::odd) sum[i] += weight * (plus[i] - minus[i]);
        if (parity == Parity::zero_sum) sum[i] += weight * ((plus[i] - centre[i]) + (minus[i] - centre[i]));
      }
    }
    for (int i = 0; i < kBlock; ++i)
      out[x + i] = sum[i];
  }
}

std::vector<float> scaled(const std::vector<double>& w, double scale) {
  std::vector<float> out;
  for (double v : w)
    out.push_back(static_cast<float>(v * scale));
  return out;
}

double both_sides(const std::vector<double>& half) {
  double sum = half[0];
  for (std::size_t k = 1; k < half.size(); ++k)
    sum += 2 * half[k];
  return sum;
}

}  // namespace

Filters::Filters(double pixels_per_degree) {
  using std::numbers::pi;
  // Contrast sensitivity: sums of a sqrt(pi/b) exp(-pi^2 z / b), z the squared distance in
  // degrees.
  constexpr double kAchromaticB = 0.0047, kRedGreenB = 0.0053;
  constexpr double kBlueYellowA[2] = {34.1, 13.5}, kBlueYellowB[2] = {0.04, 0.025};
  // All channels share the radius of the widest Gaussian: three of its standard deviations sqrt(b / 2 pi^2).
  const int radius = static_cast<int>(std::ceil(3 * std::sqrt(kBlueYellowB[0] / (2 * pi * pi)) * pixels_per_degree));
  const auto gaussian = [&](double b, double height) {
    std::vector<double> w;
    for (int k = 0; k <= radius; ++k)
      w.push_back(height * std::exp(-pi * pi * std::pow(k / pixels_per_degree, 2) / b));
    return w;
  };
  const std::vector<double> y = gaussian(kAchromaticB, 1), cx = gaussian(kRedGreenB, 1);
  achromatic = scaled(y, 1 / both_sides(y));
  red_green = scaled(cx, 1 / both_sides(cx));
  // A 2D Gaussian of height h is the product of two 1D ones of height sqrt(h); the sum of both is normalised as one
  // filter.
  std::vector<double> cz[2];
  for (int i = 0; i < 2; ++i)
    cz[i] = gaussian(kBlueYellowB[i], std::sqrt(kBlueYellowA[i] * std::sqrt(pi / kBlueYellowB[i])));
  const double norm = 1 / std::hypot(both_sides(cz[0]), both_sides(cz[1]));
  for (std::size_t i = 0; i < 2; ++i)
    blue_yellow[i] = scaled(cz[i], norm);

  // Features: first and second derivatives of a Gaussian whose peak-to-trough width is w = 0.082 degrees.
  const double sigma = 0.5 * 0.082 * pixels_per_degree;
  const int feature_radius = static_cast<int>(std::ceil(3 * sigma));
  std::vector<double> g, dg, ddg;
  double positive_first = 0, positive_second = 0, negative_second = 0;
  for (int k = 0; k <= feature_radius; ++k) {
    g.push_back(std::exp(-k * k / (2 * sigma * sigma)));
    dg.push_back(k * g.back());
    ddg.push_back((k * k / (sigma * sigma) - 1) * g.back());
    positive_first += dg.back();
    (ddg.back() > 0 ? positive_second : negative_second) += (k == 0 ? 1 : 2) * std::abs(ddg.back());
  }
  gauss = scaled(g, 1 / both_sides(g));
  first = scaled(dg, 1 / positive_first);
  for (double v : ddg)
    second.push_back(static_cast<float>(v / (v > 0 ? positive_second : negative_second)));
}

Perception::Perception(int width, int height, const Filters& filters)
    : width_(width), height_(height), filters_(filters), stride_(static_cast<std::size_t>(whole_blocks(width))) {
  planes_.resize(kPlanes * stride_ * static_cast<std::size_t>(height));
}

float* Perception::row(Plane plane, int y) {
  const auto rows_before =
      static_cast<std::size_t>(plane) * static_cast<std::size_t>(height_) + static_cast<std::size_t>(y);
  return planes_.data() + rows_before * stride_;
}

void Perception::filter_along_x(const LinearSource& linear) {
  const int radius = static_cast<int>(std::max(filters_.achromatic.size(), filters_.gauss.size())) - 1;
  const std::size_t padded = static_cast<std::size_t>(2 * radius) + stride_;
  tbb::parallel_for(tbb::blocked_range<int>(0, height_, 8), [&](const tbb::blocked_range<int>& rows) {
    std::vector<float> buffer(3 * padded);
    float* opponent[3];
    for (std::size_t c = 0; c < 3; ++c)
      opponent[c] = buffer.data() + c * padded + radius;
    std::vector<const float*> shifted[3];
    for (int c = 0; c < 3; ++c)
      for (int k = -radius; k <= radius; ++k)
        shifted[c].push_back(opponent[c] + k);
    const float* const* y_taps = shifted[0].data() + radius;
    const float* const* cx_taps = shifted[1].data() + radius;
    const float* const* cz_taps = shifted[2].data() + radius;
    for (int y = rows.begin(); y < rows.end(); ++y) {
      linear(y, opponent[0], opponent[1], opponent[2]);
      // YCxCz without its scales and offset: Y, X - Y, Y - Z relative to white. The colour filters sum to 1 and the
      // feature filters to 0, so the scales commute with them and cancel in the way back to linear RGB.
      for (int x = 0; x < width_; ++x) {
        const Vector xyz = relative_xyz(opponent[0][x], opponent[1][x], opponent[2][x]);
        opponent[0][x] = xyz.v[1];
        opponent[1][x] = xyz.v[0] - xyz.v[1];
        opponent[2][x] = xyz.v[1] - xyz.v[2];
      }
      // The frame goes on beyond its border as the border's pixels.
      for (float* channel : opponent) {
        std::fill(channel - radius, channel, channel[0]);
        std::fill(channel + width_, channel + width_ + radius, channel[width_ - 1]);
      }
      convolve<Parity::even>(y_taps, filters_.achromatic, width_, row(kY, y));
      convolve<Parity::even>(cx_taps, filters_.red_green, width_, row(kCx, y));
      convolve<Parity::even>(cz_taps, filters_.blue_yellow[0], width_, row(kCz0, y));
      convolve<Parity::even>(cz_taps, filters_.blue_yellow[1], width_, row(kCz1, y));
      convolve<Parity::odd>(y_taps, filters_.first, width_, row(kDx, y));
      convolve<Parity::zero_sum>(y_taps, filters_.second, width_, row(kDdx, y));
      convolve<Parity::even>(y_taps, filters_.gauss, width_, row(kGauss, y));
    }
  });
}

void Perception::run(const LinearSource& linear, const std::function<void(int y, const Row&)>& sink) {
  filter_along_x(linear);
  const int radius = static_cast<int>(std::max(filters_.achromatic.size(), filters_.gauss.size())) - 1;
  tbb::parallel_for(tbb::blocked_range<int>(0, height_, 8), [&](const tbb::blocked_range<int>& rows) {
    enum Result { kFy, kFcx, kFcz, kEx, kEy, kPx, kPy, kResults };
    std::vector<float> buffer(kResults * stride_);
    const auto result = [&](Result r) { return buffer.data() + static_cast<std::size_t>(r) * stride_; };
    std::vector<const float*> taps_of[kPlanes];
    for (auto& taps : taps_of)
      taps.resize(static_cast<std::size_t>(2 * radius) + 1);
    for (int y = rows.begin(); y < rows.end(); ++y) {
      for (int p = 0; p < kPlanes; ++p)
        for (int k = -radius; k <= radius; ++k)
          taps_of[p][static_cast<std::size_t>(k + radius)] =
              row(static_cast<Plane>(p), std::clamp(y + k, 0, height_ - 1));
      const auto taps = [&](Plane p) { return taps_of[p].data() + radius; };
      convolve<Parity::even>(taps(kY), filters_.achromatic, width_, result(kFy));
      convolve<Parity::even>(taps(kCx), filters_.red_green, width_, result(kFcx));
      convolve<Parity::even>(taps(kCz0), filters_.blue_yellow[0], width_, result(kFcz));
      convolve<Parity::even, true>(taps(kCz1), filters_.blue_yellow[1], width_, result(kFcz));
      convolve<Parity::even>(taps(kDx), filters_.gauss, width_, result(kEx));
      convolve<Parity::odd>(taps(kGauss), filters_.first, width_, result(kEy));
      convolve<Parity::even>(taps(kDdx), filters_.gauss, width_, result(kPx));
      convolve<Parity::zero_sum>(taps(kGauss), filters_.second, width_, result(kPy));

      for (int x = 0; x < width_; ++x) {
        // Back to linear RGB, into the unit cube, and on to L*a*b*.
        const float yn = result(kFy)[x];
        const float xyz[3] = {(yn + result(kFcx)[x]) * static_cast<float>(kWhite[0]), yn,
                              (yn - result(kFcz)[x]) * static_cast<float>(kWhite[2])};
        float rgb[3];
        for (int i = 0; i < 3; ++i)
          rgb[i] =
              std::clamp(static_cast<float>(kFromXyz[i][0]) * xyz[0] + static_cast<float>(kFromXyz[i][1]) * xyz[1] +
                             static_cast<float>(kFromXyz[i][2]) * xyz[2],
                         0.0f, 1.0f);
        const Vector lab = hunt_lab(rgb[0], rgb[1], rgb[2]);
        const float edge = std::sqrt(result(kEx)[x] * result(kEx)[x] + result(kEy)[x] * result(kEy)[x]);
        const float point = std::sqrt(result(kPx)[x] * result(kPx)[x] + result(kPy)[x] * result(kPy)[x]);
        result(kFy)[x] = lab.v[0];
        result(kFcx)[x] = lab.v[1];
        result(kFcz)[x] = lab.v[2];
        result(kEx)[x] = edge;
        result(kPx)[x] = point;
      }
      sink(y, {result(kFy), result(kFcx), result(kFcz), result(kEx), result(kPx)});
    }
  });
}

void combine(const Row& reference, const Row& test, int width, float* error) {
  const float largest = largest_color_distance();
  const float knee = kKnee * largest;
  const auto color = [](const Row& row, int x) {
    return Vector{{row[kLightness][x], row[kRedGreen][x], row[kBlueYellow][x]}};
  };
  for (int x = 0; x < width; ++x) {
    // Delta E_c: HyAB raised to q_c; distances up to p_c c_max get the errors up to p_t, larger ones the little that is
    // left.
    const float distance = std::pow(hyab(color(reference, x), color(test, x)), kColorExponent);
    const float color_error = distance < knee ? kKneeError / knee * distance
                                              : kKneeError + (distance - knee) / (largest - knee) * (1 - kKneeError);
    // Delta E_f: the larger difference of the features' strengths, each at most sqrt(2).
    const float edge = std::abs(reference[kEdge][x] - test[kEdge][x]);
    const float point = std::abs(reference[kPoint][x] - test[kPoint][x]);
    const float strength = std::min(std::max(edge, point) * std::numbers::sqrt2_v<float> / 2, 1.0f);
    const float feature_error = std::sqrt(strength);
    // Delta E = Delta E_c ^ (1 - Delta E_f)
    error[x] = std::min(std::pow(color_error, 1 - feature_error), 1.0f);
  }
}

}  // namespace pellucid::sweeps::flip
