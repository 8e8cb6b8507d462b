// SPDX-License-Identifier: Apache-2.0
#include "device/host.hpp"

namespace presswork::device {

template <class Real>
void advance_on_host(const Problem<Real>& p, const Cycles& cycles) {
  constexpr int serial_shells = 1000;  // fewer are left to one thread
#pragma omp parallel if (p.quadrilaterals.n + p.triangles.n >= serial_shells)
  for (int cycle = 0; cycle < cycles.n; ++cycle) {
    const Step step = cycles.step(cycle);
#pragma omp for schedule(static)
    for (int node = 0; node < p.nodes.n; ++node) move_node(p.nodes, step, node);
#pragma omp for schedule(static)
    for (int shell = 0; shell < p.quadrilaterals.n; ++shell)
      advance_shell<4>(p.nodes, p.quadrilaterals, cycles.dt, shell);
#pragma omp for schedule(static)
    for (int shell = 0; shell < p.triangles.n; ++shell) advance_shell<3>(p.nodes, p.triangles, cycles.dt, shell);
#pragma omp for schedule(static)
    for (int node = 0; node < p.nodes.n; ++node) gather_forces(p.nodes, node);
  }
}

template void advance_on_host(const Problem<double>&, const Cycles&);
template void advance_on_host(const Problem<float>&, const Cycles&);

}  // namespace presswork::device
