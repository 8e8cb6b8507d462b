// SPDX-License-Identifier: Apache-2.0
// A shell between two tools that leave it less room than it is thick: through-thickness stress s33 = -q.
//
// Plastic flow of a sheet law does not depend on hydrostatic pressure, so a state (s11, s22, s12, s33 = -q) flows as
// the plane stress state with q added to both normal stresses (Hill 1950, chapter II.1). Layers keep that state: the
// law knows nothing of q, and von Mises' stress, back stresses and history are those of it. The stress itself is the
// layers' less q. q is the same in all layers: the mean of what the tools do to both faces.
//
// Elastically a change dq is hydrostatic, with strains -dq (1 - 2 nu)/E. At fixed strain in the plane it raises the
// layers' normal stresses by dq (1 - 2 nu)/(1 - nu), and the sheet thins by dq/M, M the modulus of constrained
// compression.
//
// At each of its n nodes a shell of the area A has a spring on either face,
//   q = sum of spring/A (t - room) over the nodes at which the room between the tools is less than the thickness t,
//   spring = stiffness/(2 n) E A0/t0 of the undeformed shell, at most its mass/(n dt^2): the spring of a node then is
//   at most its own mass/dt^2, and a pushed tool that weighs as much as the sheet is stable on all of them. It is
//   constant, so its energy is spring (t - room)^2/2.
// t depends on q, so q is found by Newton's first step with the elastic modulus, after the layers, which have flown
// under the pressure before. So thickness and pressure belong to the same instant: a pressure of a step before would
// feed vibrations. The springs' energy is contact's (tool_contact.hpp), the work of q on the strains the shell's.
#pragma once

#include "element/layered_section.hpp"

namespace presswork {

namespace squeezed {

inline constexpr double stiffness = 0.5;  // 100 MPa on aluminium: 0.6 % of the thickness
inline constexpr double borne = 0.5;      // of the yield stress, by the faces alone under a pushed tool

// Modulus of constrained compression
PRESSWORK_DEVICE inline double constrained_modulus(double young, double poisson) {
  return young * (1.0 - poisson) / ((1.0 + poisson) * (1.0 - 2.0 * poisson));
}

}  // namespace squeezed

// Bound of a node's spring [N/mm]
inline double stiffest_spring(double young, double area, double thickness, int nodes) {
  return 0.5 * squeezed::stiffness / nodes * young * area / thickness;
}

// room (nodes): between the tools at the nodes [mm], infinite where they do not hold the sheet. spring/A [MPa/mm];
// thickness [mm] and membrane, the increments of strain, at which the section `r` was found. In place: layers, pressure
// q [MPa], and in the section force, thickness strain and work.
template <int nodes, class T, class Law, class Layers>
[[gnu::noinline]] PRESSWORK_DEVICE void squeeze_section(const Law& law, const LayerRule& rule, const T room[nodes],
                                                        T spring_by_area, T thickness, const T membrane[3],
                                                        Layers layers, T& pressure, Resultants<T>& r) {
  const double nu = law.poisson;
  const T over_modulus = T(1.0 / squeezed::constrained_modulus(law.young, nu));
  const T found = thickness * (T(1.0) + r.thickness_strain), zero(0.0), before = pressure;
  T excess = zero, count = zero;
  for (int a = 0; a < nodes; ++a) {
    const T over = found - room[a];
    excess += select(over > zero, over, zero), count += select(over > zero, T(1.0), zero);
  }
  const T change = (spring_by_area * excess - before) / (T(1.0) + spring_by_area * count * found * over_modulus);
  const T lift = T((1.0 - 2.0 * nu) / (1.0 - nu)) * change;  // of the layers' normal stresses
  for (int k = 0; k < rule.points; ++k) {
    T* point = layers.open(k);
    point[0] += T(2.0) * lift;
    layers.close(k, point);
  }
  pressure = before + change;
  r.force[0] += thickness * T(2.0) * (lift - pressure);
  r.thickness_strain -= change * over_modulus;
  const T mean = T(0.5) * (before + pressure);
  r.work += thickness * ((T(0.5) * lift - mean) * membrane[0] - mean * r.thickness_strain);
}

// The same, unless no lane is squeezed or no room is given.
template <int nodes, class T, class Law, class Layers>
PRESSWORK_INLINE void squeeze_between_tools(const Law& law, const LayerRule& rule, const T* room, T spring_by_area,
                                            T thickness, const T membrane[3], Layers layers, T& pressure,
                                            Resultants<T>& r) {
  if (!room) return;
  T least = room[0];
  for (int a = 1; a < nodes; ++a) least = smaller(least, room[a]);
  if (any(least < T(1e30)) || any(pressure > T(0.0)))
    squeeze_section<nodes>(law, rule, room, spring_by_area, thickness, membrane, layers, pressure, r);
}

}  // namespace presswork
