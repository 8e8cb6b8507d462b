// SPDX-License-Identifier: Apache-2.0
#include "explicit/space/nodal_tetrahedra.hpp"

#include <cmath>

#include "element/tet_nodal.hpp"

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
    double at[4][3];
    for (int a = 0; a < 4; ++a) {
      const std::size_t node = cells_[4 * std::size_t(e) + a];
      for (int i = 0; i < 3; ++i)
        at[a][i] = nodes.position.data()[Nodes::position_stride * node + i] -
                   ago * nodes.motion.data()[Nodes::motion_stride * node + i];
    }
    volume_[e] = six_volumes(at);
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
  using Kernel = NodalTetrahedron<Pack>;

 public:
  NodalBlock(std::vector<int> cells, const Nodes& nodes, Owned<Law> law, double density, double fraction,
             const NodalVolumes& volumes)
      : SpaceSolids(count, std::move(cells), Kernel::point, 1, kept_values(law.view), Kernel::work, Kernel::held_work),
        law_(std::move(law)),
        fraction_(fraction),
        volumes_(volumes) {
    set_masses<Tet4, 1>(nodes, density);
  }

  int advance(const Nodes& nodes, double dt, double time, int first, int last, double* force) override {
    int failed = -1;
    LawOfPack<Law, 1> law(law_.view);
    for (int pack = first; pack < last; ++pack, force += record * lanes) {
      Pack x[count][3], du[count][3], spin[count][3], nodal[record];
      gather_positions<count>(nodes, pack_nodes(pack), x);
      gather_motion<count>(nodes, pack_nodes(pack), du, spin);
      law.template begin<Tet4>(place_of(pack, time, dt), x);
      for (int a = 0; a < count; ++a)
        for (int i = 0; i < 3; ++i) du[a][i] *= Pack(dt), x[a][i] -= du[a][i];
      const Pack* degrees = pack_temperature(pack);
      const Pack given = degrees ? *degrees : Pack(start_temperature(law_.view));
      Pack* state = pack_state(pack);
      Pack::Mask no_stress = Pack(1.0) < Pack(0.0);
      const Pack::Mask bad =
          Kernel::advance(law.at(0), fraction_, dt, given, x, du, mean_change(pack), state, no_stress);
      if (any(bad) || any(no_stress)) {
        if (failed < 0) failed = name_failed(pack, bad, no_stress, law.told());
        continue;
      }
      for (int a = 0; a < count; ++a)
        for (int i = 0; i < 3; ++i) {
          nodal[freedoms * a + i] = state[Kernel::force_row + 3 * a + i];
          nodal[freedoms * a + 3 + i] = Pack(0.0);
        }
      double* to[lanes];
      for (int lane = 0; lane < lanes; ++lane) to[lane] = force + record * lane;
      store_records<record>(nodal, to);
    }
    return failed;
  }

  SpaceSection section() const override { return make_section(SpaceSection::Kind::nodal, law_.view, fraction_); }

  void bound_frequencies(const Nodes& nodes, double* squared) const override {
    const double bulk = law_.view.bulk_modulus(), shear = law_.view.shear_modulus();
#pragma omp parallel for schedule(static) if (n_ >= Nodes::serial_elements)
    for (int pack = 0; pack < n_packs(); ++pack) {
      Pack x[count][3], mass[count];
      load_masses(pack, mass);
      gather_positions<count>(nodes, pack_nodes(pack), x);
      const Pack bound = Kernel::bound_frequency(bulk, shear, x, mass);
      for (int lane = 0; lane < std::min(lanes, n_ - pack * lanes); ++lane) squared[pack * lanes + lane] = bound[lane];
    }
  }

  void list_state(const std::string& owner, std::vector<StateField>& fields) override {
    SpaceSolids::list_state(owner, fields);
    fields.push_back(rows_field(owner, "work", Kernel::work, 2));
    fields.push_back(rows_field(owner, "pressure", Kernel::pressure, 1));
    fields.push_back(rows_field(owner, "force", Kernel::force_row, 3 * count));
  }

 private:
  // Mean of the logarithms by which the volumes of the nodes of a pack's cells have changed.
  Pack mean_change(int pack) const {
    Pack mean(0.0);
    const int* node = pack_nodes(pack);
    for (int a = 0; a < count; ++a, node += lanes)
      for (int lane = 0; lane < lanes; ++lane) mean.set(lane, mean[lane] + 0.25 * volumes_.change(node[lane]));
    return mean;
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
