// SPDX-License-Identifier: Apache-2.0
// A law from a shared library in a cycle of the explicit loop in space: what space_cycle.hpp asks, and what the blocks
// of cells do for it. Its values are the same but for what it keeps behind the equivalent plastic strain, which lies in
// its lanes until the cycle is taken over.
#pragma once

#include <cmath>
#include <vector>

#include "element/solid_space.hpp"
#include "element/space_cycle.hpp"
#include "element/umat_cycle.hpp"
#include "element/umat_space.hpp"

namespace presswork {

// At one point of a pack's cells.
struct PointUmat {
  const CycleUmat<6>& law;
  const UmatLanes& lanes;
  int first_cell;
  LawFault& fault;

  double shear_modulus() const { return law.shear_modulus(); }
  // Whether the calls since the pack began have gone well, as lanes tell it.
  Pack::Mask failed() const {
    Pack bad(0.0);
    if (fault.status != LawStatus::done) bad.set(fault.cell - first_cell, 1.0);
    return bad > Pack(0.5);
  }
};

// It takes the effective stress for a flow stress once there is plastic strain.
inline void find_flow(const PointUmat&, Pack, const Pack* s0, Pack& flow, Pack& slope) {
  flow = von_mises::effective_of<6>(s0), slope = Pack(0.0);
}

inline Pack::Mask advance_point(const PointUmat& law, const LawInput<6, Pack>& in, const Pack (&H)[3][3],
                                const Pack (&R)[3][3], const Pack* s0, Pack* s1, Pack (&unturned)[6]) {
  Pack F[9], back[3][3];
  for (int i = 0; i < 9; ++i) {
    F[i] = H[i / 3][i % 3] + Pack(i % 4 == 0 ? 1.0 : 0.0);
    back[i / 3][i % 3] = R[i % 3][i / 3];
  }
  umat::call_lanes(*law.law.umat, law.lanes, law.first_cell, F, in.strain, R, s0, s1, nullptr, law.fault);
  stretch::turn_tensor(back, s1, unturned);
  return law.failed();
}

inline Pack::Mask respond(const PointSettings& settings, const PointUmat& law, const Pack F[9], double, Pack,
                          const Pack* s0, Pack* s1, SpaceResponse<Pack>& response) {
  respond(settings, *law.law.umat, law.lanes, law.first_cell, F, s0, s1, response, law.fault);
  return law.failed();
}

inline void keep_point(const PointUmat& law, const Pack* s1, Pack* s0) {
  for (int i = 0; i < 7; ++i) s0[i] = s1[i];
  umat::keep_rows(law.lanes, kept_values(law.law), s0 + 7);
}

// Which cells a pack has, when, and how warm.
struct PackPlace {
  int first, used;          // lanes beyond repeat the last
  const int* number;        // of the block's cells, from 0; null: as they come
  double time, dt;          // at the start of the cycle; its length [s]
  const Pack* temperature;  // given to the points [degrees C], or null
  const Pack* points;       // first row of the first point
  int point_rows;
};

// The law of a block as its kernels see it at the points of a pack: one of our own is the same at all.
template <class Law, int n_points>
class LawOfPack {
 public:
  explicit LawOfPack(const Law& law) : law_(law) {}
  template <class Cell>
  void begin(const PackPlace&, const Pack[][3]) {}
  const Law& at(int) const { return law_; }
  LawStatus told() const { return LawStatus::no_stress; }

 private:
  const Law& law_;
};

template <int n_points>
class LawOfPack<CycleUmat<6>, n_points> {
 public:
  explicit LawOfPack(const CycleUmat<6>& law) : law_(law) {}

  // x: of the corners at the end of the cycle.
  template <class Cell>
  void begin(const PackPlace& place, const Pack x[][3]) {
    using Body = SolidSpace<Cell, n_points, Pack>;
    first_ = place.first, fault_ = {};
    Pack volume(0.0);
    for (int q = 0; q < n_points; ++q) {
      typename Body::Point g;
      Body::measure_reference({}, x, q, g);
      volume += g.volume_t;
    }
    for (int q = 0; q < n_points; ++q) {
      rows_[q].take(place.points + q * place.point_rows + 7, kept_values(law_), place.used);
      Pack at[3] = {Pack(0.0), Pack(0.0), Pack(0.0)};
      for (int a = 0; a < Cell::nodes; ++a)
        for (int i = 0; i < 3; ++i) at[i] += Pack(Body::table().N[q][a]) * x[a][i];
      for (int lane = 0; lane < place.used; ++lane) {
        UmatPlace& told = rows_[q].lanes.place[lane];
        for (int i = 0; i < 3; ++i) told.coordinates[i] = at[i][lane];
        told.length = std::cbrt(volume[lane]);
        told.cell = (place.number ? place.number[place.first + lane] : place.first + lane) + 1;
        told.point = q + 1;
        told.time[0] = told.time[1] = place.time, told.dt = place.dt;
        told.temperature[0] = place.temperature ? place.temperature[q][lane] : 0.0;
      }
    }
  }
  PointUmat at(int q) { return {law_, rows_[q].lanes, first_, fault_}; }
  // Why the last pack's law has failed.
  LawStatus told() const { return fault_.status; }

 private:
  const CycleUmat<6>& law_;
  UmatRows rows_[n_points];
  LawFault fault_;
  int first_ = 0;
};

}  // namespace presswork
