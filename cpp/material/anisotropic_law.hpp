// SPDX-License-Identifier: Apache-2.0
// Anisotropic elastic-plastic laws at a point: SheetLaw in plane stress (what a shell or membrane calls), SolidLaw in
// three dimensions (von Mises and Hill 1948).
//
// Contract. update_sheet(law, strain, dt, softening, stress, history, thickness, tangent) advances the points of T's
// lanes by one increment:
//   strain[3]    in   increment xx, yy, xy (shear engineering) in a frame that turns with the material, x along the
//                     rolling direction; a shell adds elastic transverse shear of its own
//   dt           in   time of the increment [s], used by rate laws alone
//   softening    in   factor on the flow stress, 1 without temperature
//   stress[3]    both Cauchy stress xx, yy, xy [MPa]
//   history      both law.history_size() values: equivalent plastic strain, then those of kinematic.hpp
//   thickness    out  increment of thickness strain, elastic and plastic (volume kept by the plastic part)
//   tangent      out  d stress/d strain 3x3, consistent with the update; null if not wanted
// It returns the mask of lanes that failed: their stress and history are those of the start, and the caller cuts its
// step back. Nothing is allocated or thrown. The law is the same for all lanes and must have been checked.
// update_law does the same for N = 3 and, in the order xx, yy, zz, xy, yz, zx, for N = 6, without the thickness.
#pragma once

#include "material/return_mapping.hpp"

namespace presswork {

using KinematicLaw = std::variant<NoKinematic, Chaboche, YoshidaUemori>;

template <int N>
struct YieldChoice;
template <>
struct YieldChoice<3> {
  using type = PlaneStressYield;
};
template <>
struct YieldChoice<6> {
  using type = std::variant<QuadraticYield<6>>;
};

template <int N>
struct AnisotropicLaw {
  double young = 0.0;  // [MPa]
  double poisson = 0.0;
  typename YieldChoice<N>::type yield;
  Flow flow;
  KinematicLaw kinematic;
  double young_saturated = 0.0;  // Young's modulus after large plastic strain [MPa]
  double young_rate = 0.0;       // E = Ea + (E0 - Ea) exp(-rate p), p of the start of the increment; 0 keeps E0

  int history_size() const {
    return 1 + std::visit([](const auto& k) { return k.template history_size<N>(); }, kinematic);
  }
  template <class T>
  T young_at(T eqps) const {
    if (young_rate == 0.0) return T(young);
    return T(young_saturated) + T(young - young_saturated) * exponential(T(-young_rate) * eqps);
  }
};

using SheetLaw = AnisotropicLaw<3>;
using SolidLaw = AnisotropicLaw<6>;

template <int N, class T>
Mask<T> update_law(const AnisotropicLaw<N>& law, const T strain[N], double dt, T softening, T stress[N], T* history,
                   T (*tangent)[N]) {
  return std::visit(
      [&](const auto& yield, const auto& kinematic) {
        return return_to_yield(yield, kinematic, law.flow, law.young_at(history[0]), law.poisson, strain, dt, softening,
                               stress, history[0], history + 1, tangent);
      },
      law.yield, law.kinematic);
}

template <class T>
Mask<T> update_sheet(const SheetLaw& law, const T strain[3], double dt, T softening, T stress[3], T* history,
                     T& thickness, T (*tangent)[3]) {
  const Elasticity<3, T> elastic{law.young_at(history[0]), law.poisson};
  T change[3] = {-stress[0], -stress[1], -stress[2]}, elastic_strain[3];
  auto failed = update_law(law, strain, dt, softening, stress, history, tangent);
  for (int i = 0; i < 3; ++i) change[i] += stress[i];
  elastic.compliance(change, elastic_strain);
  T across = elastic_strain[0] + elastic_strain[1];
  thickness = across * T(-law.poisson / (1.0 - law.poisson)) - (strain[0] + strain[1] - across);
  return failed;
}

// Arrays over n points, in place: strain, stress (n, N), history (n, history_size), softening (n), tangent (n, N, N) or
// null, failed (n); thickness (n) for N = 3, else null. By packs, or a point at a time.
template <int N>
void update_points(const AnisotropicLaw<N>& law, std::size_t n, const double* strain, double dt,
                   const double* softening, double* stress, double* history, double* thickness, double* tangent,
                   std::uint8_t* failed, bool packed);

extern template void update_points(const SheetLaw&, std::size_t, const double*, double, const double*, double*, double*,
                                   double*, double*, std::uint8_t*, bool);
extern template void update_points(const SolidLaw&, std::size_t, const double*, double, const double*, double*, double*,
                                   double*, double*, std::uint8_t*, bool);

}  // namespace presswork
