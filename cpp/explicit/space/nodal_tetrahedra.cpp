// SPDX-License-Identifier: Apache-2.0
#include "explicit/space/nodal_tetrahedra.hpp"

#include <cmath>

#include "element/solid.hpp"

namespace presswork::explicit_dynamics {

NodalVolumes::NodalVolumes(int n_nodes, const std::vector<int>& cells)
    : cells_(cells),
      start_(n_nodes + 1),
      entry_(cells.size()),
      volume_(cells.size() / 4),
      nodal_(n_nodes),
      change_(n_nodes) {
  for (int node : cells_) ++start_[node + 1];
  for (int node = 0; node < n_nodes; ++node) start_[node + 1] += start_[node];
  std::vector<int> next(start_.begin(), start_.end() - 1);
  for (std::size_t i = 0; i < cells_.size(); ++i) entry_[next[cells_[i]]++] = static_cast<int>(i / 4);
}

void NodalVolumes::begin(const Nodes& nodes, int n_cycles) {
  measure_cells(nodes, n_cycles == 0 ? 1.0 : 0.0, 0, n_cells());
  measure_nodes(0, n_nodes());
  if (n_cycles > 0) return;
  measure_cells(nodes, 0.0, 0, n_cells());
  measure_nodes(0, n_nodes());
}

void NodalVolumes::measure_cells(const Nodes& nodes, double ago, int first, int last) {
  for (int e = first; e < last; ++e) {
    double at[4][3], edge[3][3];
    for (int a = 0; a < 4; ++a) {
      const std::size_t node = cells_[4 * std::size_t(e) + a];
      for (int i = 0; i < 3; ++i)
        at[a][i] = nodes.position.data()[Nodes::position_stride * node + i] -
                   ago * nodes.motion.data()[Nodes::motion_stride * node + i];
    }
    for (int a = 0; a < 3; ++a)
      for (int i = 0; i < 3; ++i) edge[a][i] = at[a + 1][i] - at[0][i];
    volume_[e] = edge[0][0] * (edge[1][1] * edge[2][2] - edge[1][2] * edge[2][1]) +
                 edge[0][1] * (edge[1][2] * edge[2][0] - edge[1][0] * edge[2][2]) +
                 edge[0][2] * (edge[1][0] * edge[2][1] - edge[1][1] * edge[2][0]);
  }
}

void NodalVolumes::measure_nodes(int first, int last) {
  for (int node = first; node < last; ++node) {
    double sum = 0.0;
    for (int i = start_[node]; i < start_[node + 1]; ++i) sum += volume_[entry_[i]];
    change_[node] = sum > 0.0 && nodal_[node] > 0.0 ? std::log(sum / nodal_[node]) : 0.0;
    nodal_[node] = sum;
  }
}

namespace {

template <class Law>
class NodalBlock final : public SpaceSolids {
  static constexpr int count = Tet4::nodes, record = Nodes::record(count);
  using Body = SolidSpace<Tet4, 1, Pack>;
  enum Row : int { work, held_work, pressure, force_row, point = force_row + 3 * count };

 public:
  NodalBlock(std::vector<int> cells, const Nodes& nodes, Owned<Law> law, double density, double fraction,
             const NodalVolumes& volumes)
      : SpaceSolids(count, std::move(cells), point, 1, kept_values(law.view), work, held_work),
        law_(std::move(law)),
        fraction_(fraction),
        volumes_(volumes) {
    if constexpr (std::is_same_v<Law, SolidLaw>) set_axes();
    set_masses<Tet4, 1>(nodes, density);
  }

  int advance(const Nodes& nodes, double dt, double, int first, int last, double* force) override {
    int failed = -1;
    for (int pack = first; pack < last; ++pack, force += record * lanes) {
      Pack x[count][3], du[count][3], spin[count][3], nodal[record];
      gather_positions<count>(nodes, pack_nodes(pack), x);
      gather_motion<count>(nodes, pack_nodes(pack), du, spin);
      for (int a = 0; a < count; ++a)
        for (int i = 0; i < 3; ++i) du[a][i] *= Pack(dt), x[a][i] -= du[a][i];
      typename Body::Point g;
      Pack::Mask bad = Body::measure_reference({}, x, 0, g);
      bad = either(bad, Body::deform(du, false, g));
      Pack::Mask no_stress = Pack(1.0) < Pack(0.0);
      if (!any(bad)) no_stress = respond_and_push(pack, dt, g, du, nodal);
      if (any(bad) || any(no_stress)) {
        if (failed < 0) failed = name_failed(pack, any(bad) ? bad : no_stress, any(bad));
        continue;
      }
      double* to[lanes];
      for (int lane = 0; lane < lanes; ++lane) to[lane] = force + record * lane;
      store_records<record>(nodal, to);
    }
    return failed;
  }

  // As of fully integrated cells: the nodal mean of the dilatation has less energy than the cells' own.
  void bound_frequencies(const Nodes& nodes, double* squared) const override {
    const double modulus = law_.view.bulk_modulus() + 2.0 * law_.view.shear_modulus();
#pragma omp parallel for schedule(static) if (n_ >= Nodes::serial_elements)
    for (int pack = 0; pack < n_packs(); ++pack) {
      Pack x[count][3], mass[count], bound(0.0);
      load_masses(pack, mass);
      gather_positions<count>(nodes, pack_nodes(pack), x);
      typename Body::Point g;
      Body::measure_reference({}, x, 0, g);
      for (int a = 0; a < count; ++a)
        for (int i = 0; i < 3; ++i) bound += g.volume_t * g.grad[a][i] * g.grad[a][i] / mass[a];
      for (int lane = 0; lane < std::min(lanes, n_ - pack * lanes); ++lane)
        squared[pack * lanes + lane] = modulus * bound[lane];
    }
  }

  void list_state(const std::string& owner, std::vector<StateField>& fields) override {
    SpaceSolids::list_state(owner, fields);
    fields.push_back(rows_field(owner, "work", work, 2));
    fields.push_back(rows_field(owner, "pressure", pressure, 1));
    fields.push_back(rows_field(owner, "force", force_row, 3 * count));
  }

 private:
  // Gives the lanes where the law finds no stress; then nothing is written.
  Pack::Mask respond_and_push(int pack, double dt, const typename Body::Point& g, const Pack du[count][3],
                              Pack nodal[record]) {
    // 1. stress with the nodes' dilatation
    Pack own = logarithm(g.jacobian), mean(0.0), F[9];
    const int* node = pack_nodes(pack);
    for (int a = 0; a < count; ++a, node += lanes)
      for (int lane = 0; lane < lanes; ++lane) mean.set(lane, mean[lane] + 0.25 * volumes_.change(node[lane]));
    std::copy_n(g.F, 9, F);
    Body::use_mean_dilatation({}, exponential(mean), g, false, F);
    Pack* state = pack_state(pack);
    Pack *s0 = state + point, s1[most_point_values<6>], flow, slope;
    const Pack* degrees = pack_temperature(pack);
    const Pack given = degrees ? *degrees : Pack(start_temperature(law_.view));
    const Pack eqps_n = s0[6];
    law_.view.flow_at_rest(eqps_n, point_temperature(law_.view, given, s0), flow, slope);
    PointSettings settings;
    settings.tangent = TangentKind::none;
    SpaceResponse<Pack> response;
    const Pack::Mask failed = respond(settings, law_.view, F, dt, given, s0, s1, response);
    if (any(failed)) return failed;

    // 2. what holds the cell's own dilatation
    const Pack elastic(law_.view.shear_modulus());
    const Pack modulus = SolidForces<4, Pack>::hourglass_modulus(elastic, eqps_n, flow, slope);
    const Pack held = state[pressure] + Pack(2.0 * fraction_) * modulus * (own - mean);

    // 3. forces, and their work over the cycle
    const Pack volume = g.volume_t * g.jacobian;
    Pack stress[6], now[3 * count], done(0.0);
    for (int i = 0; i < 6; ++i) stress[i] = i < 3 ? s1[i] + held : s1[i];
    typename Body::Gradients gradients;
    Body::push_forward(g, false, gradients);
    std::fill_n(now, 3 * count, Pack(0.0));
    Body::add_force(gradients, stress, volume, now);
    for (int a = 0; a < count; ++a)
      for (int i = 0; i < 3; ++i) {
        done += Pack(0.5) * (state[force_row + 3 * a + i] + now[3 * a + i]) * du[a][i];
        state[force_row + 3 * a + i] = nodal[freedoms * a + i] = now[3 * a + i];
        nodal[freedoms * a + 3 + i] = Pack(0.0);
      }
    const Pack lost = Pack(0.5) * (state[pressure] * g.volume_t + held * volume) * own;
    state[work] += done - lost;
    state[held_work] += lost;
    state[pressure] = held;
    std::copy_n(s1, point_rows_, s0);
    return failed;
  }

  Owned<Law> law_;
  double fraction_;
  const NodalVolumes& volumes_;
};

}  // namespace

std::unique_ptr<SpaceSolids> make_nodal_tetrahedra(std::vector<int> cells, const SpaceNodes<double>& nodes,
                                                   SpaceSolidLaw law, double density, double fraction,
                                                   const NodalVolumes& volumes) {
  return std::visit(
      [&]<class Law>(Owned<Law>& own) -> std::unique_ptr<SpaceSolids> {
        return std::make_unique<NodalBlock<Law>>(std::move(cells), nodes, std::move(own), density, fraction, volumes);
      },
      law);
}

}  // namespace presswork::explicit_dynamics
