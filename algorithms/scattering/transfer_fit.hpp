#pragma once

#include <string_view>

#include "algorithms/scattering/slab.hpp"

/// Transfer functions as few numbers, so that a blurred environment can stand for them: Chan and Wang 2005, Sec. 3.3.
namespace pellucid::scattering {

/// The family of functions that a transmission function is fitted by.
enum class TransferModel {
  gaussian,       ///< the paper's: f_t G(θ̄) + c_t, in which G holds the unscattered part too
  unscattered,    ///< e^(−τ) apart and sharp, and f_t G(θ̄) + c_t for the scattered part
  two_gaussians,  ///< f_t G(θ̄) + f_2 G(θ̄_2), c_t = 0
};
inline constexpr std::string_view kTransferModels = "gaussian|unscattered|two_gaussians";

/// A camera that looks straight through the slab sees the mean of the environment, weighted by the transmitted
/// radiance times the cosine (reciprocity). Here that weight, over the sphere, is a sum of kernels that each have
/// integral 1: a Gaussian in the angle from straight on, exp(−θ²/(2θ̄²)), one over 4π for c_t and c_r (the paper's mean
/// colour of the whole environment), and what is not scattered at all.
struct TransferFit {
  double sharp = 1;               ///< unscattered part kept apart; 0 for the other models
  double f_t = 0, theta_bar = 0;  ///< share, and standard deviation [rad]
  double f_2 = 0, theta_2 = 0;    ///< of the second Gaussian, the wider one
  double c_t = 0;                 ///< share spread over the sphere
  double c_r = 0;                 ///< the reflectance, spread over the sphere
  /// Root mean square over the angle, from 0 to 180°, of the difference in transmitted flux within that angle: a share
  /// of the incident flux. The fit minimises it; sharp + f_t + f_2 + c_t is the transmittance, none of them negative.
  double rms = 0;
};

TransferFit fit_transfer(const SlabLight&, TransferModel);

/// The share within `angle` of straight on of a Gaussian exp(−θ²/(2·width²)) on the sphere; both in radians.
double gaussian_within(double width, double angle);

}  // namespace pellucid::scattering
