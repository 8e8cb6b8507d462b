// SPDX-License-Identifier: Apache-2.0
// Solids in space in the device's cycle: hexahedra of one point (element/hex_one_point.hpp), and tetrahedra with the
// nodal mean of J (element/tet_nodal.hpp), which ask for two passes more. They are computed in double precision, as by
// the CPU's loop.
#pragma once

#include "device/elements.hpp"
#include "device/law_tables.hpp"
#include "element/hex_one_point.hpp"
#include "element/tet_nodal.hpp"
#include "material/elastic_plastic_update.hpp"

namespace presswork::device {

// What solids add to Elements. The status of a cell that is turned inside out is `done`.
template <class OfLaw>
struct SolidElements : Elements<double> {
  using Law = OfLaw;
  Law law;
  double fraction;           // of the shear modulus, of what holds motions that the points do not see
  const double* nodal_mass;  // (corners, n) [t]

  PRESSWORK_INLINE void fail(const Nodes<double>& nodes, int cell, bool inside_out) const {
    Elements<double>::fail(nodes, cell, inside_out ? LawStatus::done : LawStatus::no_stress);
  }
  PRESSWORK_INLINE double given_temperature(int cell) const {
    return this->temperature ? this->temperature[cell] : start_temperature(law);
  }
  template <class F>
  void for_each_table(const F& f) {
    device::for_each_table(law, f);
  }
};

using explicit_dynamics::point_measures;

// Values of a point at most.
template <class Law>
inline constexpr int most_values = most_point_values<6>;
template <>
inline constexpr int most_values<VonMises> = 7;

template <class OfLaw>
struct OnePointHexahedra : SolidElements<OfLaw> {
  using Kernel = HexOnePoint<double>;
  static constexpr int n_corners = 8, most_rows = Kernel::point + most_values<OfLaw>;
  static constexpr int first_measure = Kernel::point, n_measures = point_measures;

  PRESSWORK_INLINE void advance(const Nodes<double>& nodes, const double*, double dt, int cell) const {
    if (this->is_over(nodes, cell)) return;
    const std::size_t n = this->n;
    double x[n_corners][3], du[n_corners][3], spin[n_corners][3], state[most_rows], force[3 * n_corners];
    gather_corners<n_corners>(nodes, *this, cell, x, du, spin);
    for (auto& of : du)
      for (double& component : of) component *= dt;
    double* rows = this->state + cell;
    const int n_rows = Kernel::point + 7 + kept_values(this->law);
    for (int r = 0; r < n_rows; ++r) state[r] = rows[r * n];
    bool no_stress = false;
    const bool bad = Kernel::advance(this->law, this->fraction, dt, this->given_temperature(cell), x, du, state, force,
                                     3, no_stress);
    if (bad || no_stress) {
      this->fail(nodes, cell, bad);
      for (double& component : force) component = 0.0;
    }
    for (int r = 0; r < n_rows; ++r) rows[r * n] = state[r];
    leave_solid_forces<n_corners>(nodes, *this, cell, force);
  }
  PRESSWORK_INLINE double bound(const Nodes<double>& nodes, int cell) const {
    double x[n_corners][3], v[n_corners][3], spin[n_corners][3], mass[n_corners];
    gather_corners<n_corners>(nodes, *this, cell, x, v, spin);
    for (int a = 0; a < n_corners; ++a) mass[a] = this->nodal_mass[a * std::size_t(this->n) + cell];
    return Kernel::bound_frequency(this->law.bulk_modulus(), this->law.shear_modulus(), this->fraction, x, mass);
  }
};

// Volumes of cells and of nodes over a move, for one block of tetrahedra: two passes before the cells advance.
struct NodalVolumes {
  const int *first, *cell;          // (n_nodes + 1) into cell: those round each node
  double *volume, *nodal, *change;  // (n) six times those of cells; (n_nodes) sums of these, and ln of their ratio
};

// Tetrahedra with the nodal mean of J.
template <class OfLaw>
struct NodalTetrahedra : SolidElements<OfLaw> {
  using Kernel = NodalTetrahedron<double>;
  static constexpr int n_corners = 4, most_rows = Kernel::point + most_values<OfLaw>;
  static constexpr int first_measure = Kernel::point, n_measures = point_measures;
  NodalVolumes volumes;

  PRESSWORK_INLINE void measure_cell(const Nodes<double>& nodes, int cell) const {
    double x[n_corners][3];
    for (int a = 0; a < n_corners; ++a)
      for (int i = 0; i < 3; ++i)
        x[a][i] = nodes.position[4 * std::size_t(this->node[a * std::size_t(this->n) + cell]) + i];
    volumes.volume[cell] = six_volumes(x);
  }
  PRESSWORK_INLINE void measure_node(int node) const {
    double sum = 0.0;
    for (int i = volumes.first[node]; i < volumes.first[node + 1]; ++i) sum += volumes.volume[volumes.cell[i]];
    const double before = volumes.nodal[node];
    volumes.change[node] = sum > 0.0 && before > 0.0 ? std::log(sum / before) : 0.0;
    volumes.nodal[node] = sum;
  }
  PRESSWORK_INLINE void advance(const Nodes<double>& nodes, const double*, double dt, int cell) const {
    if (this->is_over(nodes, cell)) return;
    const std::size_t n = this->n;
    double x[n_corners][3], du[n_corners][3], spin[n_corners][3], state[most_rows], force[3 * n_corners], mean = 0.0;
    gather_corners<n_corners>(nodes, *this, cell, x, du, spin);
    for (int a = 0; a < n_corners; ++a) {
      mean += 0.25 * volumes.change[this->node[a * n + cell]];
      for (int i = 0; i < 3; ++i) du[a][i] *= dt, x[a][i] -= du[a][i];
    }
    double* rows = this->state + cell;
    const int n_rows = Kernel::point + 7 + kept_values(this->law);
    for (int r = 0; r < n_rows; ++r) state[r] = rows[r * n];
    bool no_stress = false;
    const bool bad =
        Kernel::advance(this->law, this->fraction, dt, this->given_temperature(cell), x, du, mean, state, no_stress);
    if (bad || no_stress) this->fail(nodes, cell, bad);
    for (int i = 0; i < 3 * n_corners; ++i) force[i] = bad || no_stress ? 0.0 : state[Kernel::force_row + i];
    for (int r = 0; r < n_rows; ++r) rows[r * n] = state[r];
    leave_solid_forces<n_corners>(nodes, *this, cell, force);
  }
  PRESSWORK_INLINE double bound(const Nodes<double>& nodes, int cell) const {
    double x[n_corners][3], v[n_corners][3], spin[n_corners][3], mass[n_corners];
    gather_corners<n_corners>(nodes, *this, cell, x, v, spin);
    for (int a = 0; a < n_corners; ++a) mass[a] = this->nodal_mass[a * std::size_t(this->n) + cell];
    return Kernel::bound_frequency(this->law.bulk_modulus(), this->law.shear_modulus(), x, mass);
  }
};

}  // namespace presswork::device
