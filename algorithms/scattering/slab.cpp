#include "algorithms/scattering/slab.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <fmt/format.h>

#include "gl/error.hpp"

namespace pellucid::scattering {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kFewest = 32, kMost = 128;
constexpr double kUnresolved = 1e-5;  // share of the forward peak that may be left to the unscattered part

// The ordinates that expand the phase function to g^(2n−1) < kUnresolved, if that many are affordable.
int ordinates_for(double anisotropy) {
  const double g = std::abs(anisotropy);
  if (g < 0.1) return kFewest;
  const double terms = std::log(kUnresolved) / std::log(g);
  return static_cast<int>(std::clamp(8 * std::ceil((terms + 1) / 16), double{kFewest}, double{kMost}));
}

/// Gauss–Radau quadrature on [0, 1] with a node at 1, where the beam is: exact for polynomials of degree 2n − 2.
struct Quadrature {
  VectorXd node, weight;
};

Quadrature radau(int n) {
  Quadrature q{VectorXd(n), VectorXd(n)};
  for (int i = 0; i < n; ++i) {
    // The roots of P(n−1) + P(n) on [−1, 1], by Newton's method from Chebyshev's nodes; −1 is one of them.
    double x = -std::cos(2 * std::numbers::pi * i / (2 * n - 1)), before = 2, p0 = 1, p1 = 1;
    for (int pass = 0; pass < 100 && std::abs(x - before) > 1e-16; ++pass) {
      p0 = 1;
      p1 = x;
      for (int k = 2; k <= n; ++k) {
        const double p2 = ((2 * k - 1) * x * p1 - (k - 1) * p0) / k;
        p0 = p1;
        p1 = p2;
      }
      before = x;
      if (i > 0) x -= (1 - x) / n * (p0 + p1) / (p0 - p1);
    }
    q.node[i] = (1 - x) / 2;
    q.weight[i] = i == 0 ? 1.0 / (n * n) : (1 - x) / (2.0 * n * n * p0 * p0);
  }
  q.weight /= q.weight.sum();
  return q;
}

double tanh_times(double k, double half) {
  return k * std::tanh(k * half);
}
double over_tanh(double k, double half) {
  const double t = k * half;
  return t < 1e-4 ? (1 + t * t / 3) / half : k / std::tanh(t);
}

}  // namespace

double henyey_greenstein(double cosine, double anisotropy) {
  const double g = anisotropy, base = 1 + g * g - 2 * g * cosine;
  return (1 - g * g) / (4 * std::numbers::pi * base * std::sqrt(base));
}

void check_anisotropy(double anisotropy, std::string_view owner) {
  if (!(std::abs(anisotropy) <= kMaxAnisotropy))
    throw InputError(fmt::format("{}: anisotropy = {} is out of range [-{}, {}]: at 1 a medium would not scatter",
                                 owner, anisotropy, kMaxAnisotropy, kMaxAnisotropy));
}

void check_albedo(double albedo, std::string_view owner) {
  if (!(albedo >= 0 && albedo <= 1))
    throw InputError(fmt::format("{}: albedo = {} is out of range [0, 1]", owner, albedo));
}

void check_depth(double depth, std::string_view owner) {
  if (!(depth >= 0) || !std::isfinite(depth))
    throw InputError(fmt::format("{}: depth = {} is not an optical thickness of 0 or more", owner, depth));
}

// With S = I(μ) + I(−μ) and D = I(μ) − I(−μ) the equation of transfer parts into
//   dS/dt = −A D,  dD/dt = −B S,  A = M⁻¹(1 − ω P_odd W),  B = M⁻¹(1 − ω P_even W),
// where M holds the cosines, W the weights and P the phase function's Legendre terms of odd or even degree
// (Chandrasekhar 1960, Ch. III; the parting is that of Stamnes et al. 1988, references.bib: stamnes1988). In the
// variables √(w μ) I both matrices are symmetric: A = L Lᵀ, and with LᵀBL = Y k² Yᵀ the solutions that are even or odd
// about the slab's middle are
//   S = F cosh(kt) a, D = −G k sinh(kt) a  and  S = F sinh(kt)/k b, D = −G cosh(kt) b,  F = L Y, G = L⁻ᵀ Y.
// Nothing in them fails as an eigenvalue goes to 0, where nothing is absorbed.
struct Slab::Modes {
  Quadrature q;
  double peak = 0;  // share of the scattering that counts as none, by delta scaling (references.bib: wiscombe1977)
  double depth_scale = 1;  // of the optical thickness that is left
  MatrixXd F, G, C;        // C = Yᵀ LᵀL Y
  VectorXd k, beam;        // beam = Yᵀ Lᵀ e₀
};

Slab::Slab(const SlabMedium& medium, int ordinates) : medium_(medium) {
  check_anisotropy(medium.anisotropy, "slab");
  check_albedo(medium.albedo, "slab");
  const int n = ordinates > 0 ? ordinates : ordinates_for(medium.anisotropy);
  auto modes = std::make_unique<Modes>();
  Modes& m = *modes;
  m.q = radau(n);
  const int degree = 2 * n - 2;
  const double g = medium.anisotropy;
  // Delta scaling needs a forward peak: a medium that scatters back has none, and its expansion is cut off as it is.
  m.peak = g > 0 ? std::pow(g, degree + 1) : 0;
  m.depth_scale = 1 - medium.albedo * m.peak;
  const double albedo = medium.albedo * (1 - m.peak) / m.depth_scale;

  // Legendre terms of even and odd degree, as symmetric matrices.
  const VectorXd root_weight = m.q.weight.cwiseSqrt();
  MatrixXd even = MatrixXd::Zero(n, n), odd = even;
  VectorXd p0 = VectorXd::Ones(n), p1 = m.q.node;
  double power = 1;
  for (int l = 0; l <= degree; ++l) {
    const double moment = (power - m.peak) / (1 - m.peak);
    const VectorXd term = root_weight.cwiseProduct(p0);
    (l % 2 == 0 ? even : odd).selfadjointView<Eigen::Lower>().rankUpdate(term, (2 * l + 1) * moment);
    const VectorXd p2 = ((2 * l + 3) * m.q.node.cwiseProduct(p1) - (l + 1) * p0) / (l + 2);
    p0 = p1;
    p1 = p2;
    power *= g;
  }
  const VectorXd root_cosine = m.q.node.cwiseSqrt();
  const auto operator_of = [&](const MatrixXd& lower) {
    const MatrixXd full = lower.selfadjointView<Eigen::Lower>();
    const MatrixXd within = MatrixXd::Identity(n, n) - albedo * full;
    return MatrixXd(root_cosine.cwiseInverse().asDiagonal() * within * root_cosine.cwiseInverse().asDiagonal());
  };
  const Eigen::LLT<MatrixXd> factor(operator_of(odd));
  const MatrixXd L = factor.matrixL();
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(L.transpose() * operator_of(even) * L);
  const MatrixXd& Y = eigen.eigenvectors();
  m.k = eigen.eigenvalues().cwiseMax(0).cwiseSqrt();
  m.F = L * Y;
  m.G = factor.matrixU().solve(Y);
  m.C = m.F.transpose() * m.F;
  m.beam = m.F.row(0).transpose();
  modes_ = std::move(modes);
}

Slab::~Slab() = default;
Slab::Slab(Slab&&) noexcept = default;
Slab& Slab::operator=(Slab&&) noexcept = default;

SlabLight Slab::light(double depth) const {
  check_depth(depth, "slab");
  const Modes& m = *modes_;
  const Eigen::Index n = m.q.node.size();
  SlabLight out;
  out.depth = depth;
  out.unscattered = std::exp(-depth);
  out.cosine.assign(m.q.node.data(), m.q.node.data() + n);
  out.weight.assign(m.q.weight.data(), m.q.weight.data() + n);
  out.transmission.assign(static_cast<std::size_t>(n), 0.0);
  out.reflection = out.transmission;
  const double half = 0.5 * m.depth_scale * depth;
  if (half < 1e-12) {
    out.transmittance = out.unscattered;
    return out;
  }
  // The beam as radiance in the first ordinate, halved into an excitation from both sides and one of opposite signs.
  const double incident = std::sqrt(m.q.node[0] * m.q.weight[0]);
  const VectorXd tanh = m.k.unaryExpr([&](double k) { return tanh_times(k, half); });
  const VectorXd coth = m.k.unaryExpr([&](double k) { return over_tanh(k, half); });
  const auto outgoing = [&](const VectorXd& diagonal) -> VectorXd {
    const VectorXd a = (m.C + MatrixXd(diagonal.asDiagonal())).llt().solve(incident * m.beam);
    return m.F * a - m.G * diagonal.cwiseProduct(a);
  };
  const VectorXd even = outgoing(tanh), odd = outgoing(coth);
  // E = R + T and O = R − T; unit flux is a radiance of 1/(2π w μ) in the first ordinate.
  const double unit = 1 / (2 * std::numbers::pi * m.q.node[0] * m.q.weight[0]);
  const double straight = std::exp(-2 * half);
  double transmitted = 0, reflected = 0;
  for (Eigen::Index i = 0; i < n; ++i) {
    const double per = unit / std::sqrt(m.q.node[i] * m.q.weight[i]);
    double back = 0.5 * (even[i] + odd[i]) * per, through = 0.5 * (even[i] - odd[i]) * per;
    if (i == 0) through -= straight * unit;
    const auto at = static_cast<std::size_t>(i);
    out.transmission[at] = through;
    out.reflection[at] = back;
    const double flux = 2 * std::numbers::pi * m.q.node[i] * m.q.weight[i];
    transmitted += flux * through;
    reflected += flux * back;
  }
  out.reflectance = reflected;
  out.near_forward = std::max(0.0, straight - out.unscattered);
  out.transmittance = straight + transmitted;
  return out;
}

}  // namespace pellucid::scattering
