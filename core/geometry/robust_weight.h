#pragma once
// Weight of a residual under the kernel of Geman and McClure (1985): 1 / (1 + s)^2 of its squared length s in units of
// the scale; at a hundred times the scale it counts nothing. Pure.

namespace pelorus {

[[nodiscard]] inline double geman_mcclure_weight(double chi2, double scale) {
  const double s = 1.0 + chi2 / scale;
  return 1.0 / (s * s);
}

}  // namespace pelorus
