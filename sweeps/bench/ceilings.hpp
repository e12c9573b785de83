#pragma once

#include <string>
#include <vector>

/// The device's best rates, by the plainest programs: the ceilings under which every technique stays.
namespace pellucid::sweeps {

struct Ceiling {
  std::string what;    ///< "fetches", "fill", "blends", "dispatches", "uploads"
  std::string detail;  ///< format, and how a fetch filters
  double rate = 0;     ///< per second
  std::string unit;    ///< of the rate, as people read it: "Gfetch/s"
  double scale = 1;    ///< rate / scale is in that unit
};

/// Texture fetches by format and filter; pixels filled and blended by format; dispatches of one group; uploads of
/// texels. Each is the median over a few frames that take 2 ms or more. Needs a current GL context. Throws RuntimeError
/// when the clock gives no usable time.
std::vector<Ceiling> measure_ceilings();

}  // namespace pellucid::sweeps
