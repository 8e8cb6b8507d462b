// SPDX-License-Identifier: Apache-2.0
// The contract of a material law at a point: one increment, from a state s0 to a state s1.
//
//   Mask<T> update(law, in, const T* s0, T* s1, T (*tangent)[N])
//
//   law       a view: a plain struct of numbers and of pointers to tables (law_data.hpp), the same for all lanes,
//   checked
//             beforehand
//   N         components: 3 plane stress (xx, yy, xy), 4 plane strain and axisymmetry (xx, yy, zz, xy), 6 space (xx,
//   yy,
//             zz, xy, yz, zx); shear strains engineering; x along the rolling direction where a law has one
//   in        increment of strain, in axes that turn with the material; its time; the temperature given from outside
//   s0, s1    state at its start and end, law.state_size() values: Cauchy stress (N) [MPa], equivalent plastic strain,
//             then what the law keeps besides. s0 is not written to; s1 may be s0.
//   tangent   out: d stress/d strain (N x N) [MPa], consistent with the update; null if not wanted
//   returns   the lanes that failed: their s1 is s0, and the caller cuts its step back
//
// A law knows neither frame nor element, allocates nothing and throws nothing. Laws:
//
//   VonMises         4, 6     closed form, isotropic hardening alone; six integrators      von_mises.hpp
//   AdiabaticMises   4        closed form, with strain rate and heat; no tangent           adiabatic_mises.hpp
//   TabulatedMises   3        isotropic hardening from a table; no tangent; in sums and differences,
//   tabulated_mises.hpp ElasticPlastic   3, 4, 6  any yield function, hardening, back stress, strain rate and heat
//   elastic_plastic.hpp Umat             3, 4     a routine from a shared library                              umat.hpp
#pragma once

#include "tensor/pack.hpp"

namespace presswork {

// What the phases of a point make of it, each since the start, as one array of mixture_size values: strain of free
// growth; sum of K phi of transformation plasticity [1/MPa]; factor on the flow stress of the present mixture.
enum MixturePlace { mixture_strain, mixture_trip, mixture_flow, mixture_size };

template <int N, class T>
struct LawInput {
  T strain[N];
  double dt = 0.0;             // [s]; laws with a strain rate flow in no time at all: with 0 they answer elastically
  T temperature = T(0.0);      // [degrees C]; what the law itself heats comes on top
  const T* mixture = nullptr;  // (mixture_size) of the increment's end, for laws with phases; null: as before
};

}  // namespace presswork
