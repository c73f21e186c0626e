#include "core/kernels/transfer.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/kernels/transfer.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace pelorus::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

template <class V>
struct Symmetric {
  V c00, c01, c02, c11, c12, c22;
};

// What the three measured coordinates (u_left, v, u_right) see of something.
template <class V>
struct Seen {
  V l, v, r;
};

// J times the vector (a, b, c).
template <class V>
HWY_INLINE Seen<V> seen(V fz, const Seen<V>& slope, V a, V b, V c) {
  return {hn::Mul(fz, hn::Sub(a, hn::Mul(slope.l, c))), hn::Mul(fz, hn::Sub(b, hn::Mul(slope.v, c))),
          hn::Mul(fz, hn::Sub(a, hn::Mul(slope.r, c)))};
}

// 1 + q q^T + u u^T + v v^T.
template <class V>
HWY_INLINE Symmetric<V> covariance(V one, const Seen<V>& q, const Seen<V>& u, const Seen<V>& v) {
  const auto entry = [](V q0, V q1, V u0, V u1, V v0, V v1)
                         HWY_ATTR { return hn::Add(hn::Add(hn::Mul(q0, q1), hn::Mul(u0, u1)), hn::Mul(v0, v1)); };
  return {hn::Add(one, entry(q.l, q.l, u.l, u.l, v.l, v.l)),
          entry(q.l, q.v, u.l, u.v, v.l, v.v),
          entry(q.l, q.r, u.l, u.r, v.l, v.r),
          hn::Add(one, entry(q.v, q.v, u.v, u.v, v.v, v.v)),
          entry(q.v, q.r, u.v, u.r, v.v, v.r),
          hn::Add(one, entry(q.r, q.r, u.r, u.r, v.r, v.r))};
}

// e^T C^-1 e by cofactors.
template <class V>
HWY_INLINE V solved_square(const Symmetric<V>& c, const Seen<V>& e) {
  const V a00 = hn::Sub(hn::Mul(c.c11, c.c22), hn::Mul(c.c12, c.c12));
  const V a01 = hn::Sub(hn::Mul(c.c02, c.c12), hn::Mul(c.c01, c.c22));
  const V a02 = hn::Sub(hn::Mul(c.c01, c.c12), hn::Mul(c.c02, c.c11));
  const V a11 = hn::Sub(hn::Mul(c.c00, c.c22), hn::Mul(c.c02, c.c02));
  const V a12 = hn::Sub(hn::Mul(c.c01, c.c02), hn::Mul(c.c00, c.c12));
  const V a22 = hn::Sub(hn::Mul(c.c00, c.c11), hn::Mul(c.c01, c.c01));
  const V determinant = hn::Add(hn::Add(hn::Mul(c.c00, a00), hn::Mul(c.c01, a01)), hn::Mul(c.c02, a02));
  const V su = hn::Add(hn::Add(hn::Mul(a00, e.l), hn::Mul(a01, e.v)), hn::Mul(a02, e.r));
  const V sv = hn::Add(hn::Add(hn::Mul(a01, e.l), hn::Mul(a11, e.v)), hn::Mul(a12, e.r));
  const V sr = hn::Add(hn::Add(hn::Mul(a02, e.l), hn::Mul(a12, e.v)), hn::Mul(a22, e.r));
  const V sum = hn::Add(hn::Add(hn::Mul(e.l, su), hn::Mul(e.v, sv)), hn::Mul(e.r, sr));
  return hn::Div(sum, determinant);
}

// With p the point carried over, J = d project / d p and the columns of d triangulate / d z_a
//   g_u = q + m e_x, g_v = m e_y, g_r = -q, q = -p_a / disparity, m = z_a / f,
// the covariance of the residual is sigma^2 C, C = 1 + sum of (J R g)(J R g)^T.
void transfer_chi2(const TransferMotion& motion, const TransferColumns& points, double* chi2) {
  const hn::CappedTag<double, kTransferLanes> d;
  using V = hn::Vec<decltype(d)>;
  const auto set = [&](double value) HWY_ATTR { return hn::Set(d, value); };
  const double* r = motion.r;
  const V one = set(1.0);
  const V f = set(motion.f_px);
  const V baseline = set(motion.baseline_m);
  for (std::size_t i = 0; i < points.size; i += hn::Lanes(d)) {
    const V x = hn::LoadU(d, points.x_m + i);
    const V y = hn::LoadU(d, points.y_m + i);
    const V z = hn::LoadU(d, points.z_m + i);
    const V m = hn::LoadU(d, points.m_per_px + i);
    const V k = hn::LoadU(d, points.per_disparity + i);
    const auto rotated = [&](int row) HWY_ATTR {
      return hn::Add(hn::Add(hn::Mul(set(r[row]), x), hn::Mul(set(r[row + 1]), y)), hn::Mul(set(r[row + 2]), z));
    };
    const V rx = rotated(0);
    const V ry = rotated(3);
    const V rz = rotated(6);
    const V px = hn::Add(rx, set(motion.t[0]));
    const V py = hn::Add(ry, set(motion.t[1]));
    const V pz = hn::Add(rz, set(motion.t[2]));
    const auto in_front = hn::Gt(pz, set(kLeastTransferDepth_m));
    const V iz = hn::Div(one, hn::IfThenElse(in_front, pz, one));
    const V fz = hn::Mul(f, iz);
    const Seen<V> slope{hn::Mul(px, iz), hn::Mul(py, iz), hn::Mul(hn::Sub(px, baseline), iz)};
    const Seen<V> e{hn::Sub(hn::LoadU(d, points.u_left_px + i), hn::Add(hn::Mul(f, slope.l), set(motion.cx_px))),
                    hn::Sub(hn::LoadU(d, points.v_px + i), hn::Add(hn::Mul(f, slope.v), set(motion.cy_px))),
                    hn::Sub(hn::LoadU(d, points.u_right_px + i), hn::Add(hn::Mul(f, slope.r), set(motion.cx_px)))};
    const Seen<V> q = seen(fz, slope, hn::Neg(hn::Mul(rx, k)), hn::Neg(hn::Mul(ry, k)), hn::Neg(hn::Mul(rz, k)));
    const Seen<V> mu = seen(fz, slope, hn::Mul(m, set(r[0])), hn::Mul(m, set(r[3])), hn::Mul(m, set(r[6])));
    const Seen<V> u{hn::Add(q.l, mu.l), hn::Add(q.v, mu.v), hn::Add(q.r, mu.r)};
    const Seen<V> v = seen(fz, slope, hn::Mul(m, set(r[1])), hn::Mul(m, set(r[4])), hn::Mul(m, set(r[7])));
    const Symmetric<V> c = covariance(one, q, u, v);
    const auto told = hn::Le(hn::Add(hn::Add(c.c00, c.c11), c.c22), set(kLargestTransferSpread));
    const V value = hn::Mul(solved_square(c, e), hn::LoadU(d, points.per_variance + i));
    hn::StoreU(hn::IfThenElse(hn::And(in_front, told), value, set(kImpossibleChi2)), d, chi2 + i);
  }
}

}  // namespace pelorus::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pelorus {

HWY_EXPORT(transfer_chi2);

void transfer_chi2(const TransferMotion& motion, const TransferColumns& points, double* chi2) {
  HWY_DYNAMIC_DISPATCH(transfer_chi2)(motion, points, chi2);
}

namespace reference {
namespace {

struct Vec3 {
  double l, v, r;
};

// J times a vector.
Vec3 seen(double fz, const Vec3& slope, double a, double b, double c) {
  return {fz * (a - slope.l * c), fz * (b - slope.v * c), fz * (a - slope.r * c)};
}

double chi2_of(const TransferMotion& motion, const TransferColumns& points, std::size_t i) {
  const double* r = motion.r;
  const double x = points.x_m[i];
  const double y = points.y_m[i];
  const double z = points.z_m[i];
  const double m = points.m_per_px[i];
  const double k = points.per_disparity[i];
  const double rx = r[0] * x + r[1] * y + r[2] * z;
  const double ry = r[3] * x + r[4] * y + r[5] * z;
  const double rz = r[6] * x + r[7] * y + r[8] * z;
  const double pz = rz + motion.t[2];
  if (!(pz > kLeastTransferDepth_m)) return kImpossibleChi2;
  const double iz = 1.0 / pz;
  const double fz = motion.f_px * iz;
  const double px = rx + motion.t[0];
  const Vec3 slope{px * iz, (ry + motion.t[1]) * iz, (px - motion.baseline_m) * iz};
  const Vec3 e{points.u_left_px[i] - (motion.f_px * slope.l + motion.cx_px),
               points.v_px[i] - (motion.f_px * slope.v + motion.cy_px),
               points.u_right_px[i] - (motion.f_px * slope.r + motion.cx_px)};
  const Vec3 q = seen(fz, slope, -(rx * k), -(ry * k), -(rz * k));
  const Vec3 mu = seen(fz, slope, m * r[0], m * r[3], m * r[6]);
  const Vec3 u{q.l + mu.l, q.v + mu.v, q.r + mu.r};
  const Vec3 v = seen(fz, slope, m * r[1], m * r[4], m * r[7]);
  const double c00 = 1.0 + (q.l * q.l + u.l * u.l + v.l * v.l);
  const double c11 = 1.0 + (q.v * q.v + u.v * u.v + v.v * v.v);
  const double c22 = 1.0 + (q.r * q.r + u.r * u.r + v.r * v.r);
  if (!(c00 + c11 + c22 <= kLargestTransferSpread)) return kImpossibleChi2;
  const double c01 = q.l * q.v + u.l * u.v + v.l * v.v;
  const double c02 = q.l * q.r + u.l * u.r + v.l * v.r;
  const double c12 = q.v * q.r + u.v * u.r + v.v * v.r;
  const double a00 = c11 * c22 - c12 * c12;
  const double a01 = c02 * c12 - c01 * c22;
  const double a02 = c01 * c12 - c02 * c11;
  const double a11 = c00 * c22 - c02 * c02;
  const double a12 = c01 * c02 - c00 * c12;
  const double a22 = c00 * c11 - c01 * c01;
  const double determinant = c00 * a00 + c01 * a01 + c02 * a02;
  const Vec3 s{a00 * e.l + a01 * e.v + a02 * e.r, a01 * e.l + a11 * e.v + a12 * e.r, a02 * e.l + a12 * e.v + a22 * e.r};
  return (e.l * s.l + e.v * s.v + e.r * s.r) / determinant * points.per_variance[i];
}

}  // namespace

void transfer_chi2(const TransferMotion& motion, const TransferColumns& points, double* chi2) {
  for (std::size_t i = 0; i < points.size; ++i) chi2[i] = chi2_of(motion, points, i);
}
}  // namespace reference

}  // namespace pelorus
#endif
