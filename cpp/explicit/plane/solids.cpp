// SPDX-License-Identifier: Apache-2.0
#include "explicit/plane/solids.hpp"

#include <algorithm>
#include <stdexcept>

#include "tensor/records.hpp"

namespace presswork::explicit_dynamics {

namespace {

// Positions of a pack's nodes and their moves in the cycle, lane by lane; node: [node][lane].
template <int count>
[[gnu::always_inline]] inline void gather(const double* nodes, const int* node, Pack x[count][2], Pack du[count][2]) {
  constexpr int stride = PlaneNodes::position_stride;
  for (int a = 0; a < count; ++a, node += Pack::width) {
    const double* from[Pack::width];
    for (int lane = 0; lane < Pack::width; ++lane) from[lane] = nodes + std::size_t(stride) * node[lane];
    Pack record[stride];
    load_records<stride>(from, record);
    for (int i = 0; i < 2; ++i) x[a][i] = record[i], du[a][i] = record[2 + i];
  }
}

template <class Cell, class Law>
class Block final : public PlaneSolids {
  static constexpr int count = Cell::nodes, record = PlaneNodes::record(count);

 public:
  Block(std::vector<int> cells, const double* points, Law law, double density, const SolidSection& section)
      : PlaneSolids(count, std::move(cells), CycleRow::count + extra_rows(law.view)),
        law_(std::move(law)),
        section_(section) {
    set_masses(points, density);
  }

  [[gnu::flatten]] int advance(const PlaneNodes& nodes, double dt, double time, int first, int last,
                               double* force) override {
    int failed = -1;
    for (int pack = first; pack < last; ++pack, force += record * lanes) {
      Pack x[count][2], du[count][2], nodal[record];
      gather<count>(nodes.position.data(), pack_nodes(pack), x, du);
      CyclePlace place;
      place.first = pack * lanes, place.used = std::min(lanes, n_ - pack * lanes), place.time = time;
      place.temperature = pack_temperature(pack);
      Pack* state = pack_state(pack);
      const Pack::Mask bad = OnePointSolid<Cell>::advance(law_.view, section_, dt, x, du, place, state, nodal);
      for (int lane = 0; failed < 0 && lane < lanes && any(bad); ++lane)
        if (bad[lane]) failed = reasons * std::min(pack * lanes + lane, n_ - 1);
      if (failed < 0 && place.fault.status != LawStatus::done)
        failed = reasons * place.fault.cell + static_cast<int>(place.fault.status);
      for (int i = 2 * count; i < record; ++i) nodal[i] = Pack(0.0);
      double* to[lanes];
      for (int lane = 0; lane < lanes; ++lane) to[lane] = force + record * lane;
      store_records<record>(nodal, to);
    }
    return failed;
  }

  void bound_frequencies(const PlaneNodes& nodes, double* squared) const override {
    const IsotropicModuli moduli = moduli_of(law_.view);
#pragma omp parallel for schedule(static) if (n_ > 4000)
    for (int pack = 0; pack < n_packs(); ++pack) {
      Pack x[count][2], du[count][2], nodal_mass[count];
      gather<count>(nodes.position.data(), pack_nodes(pack), x, du);
      const int used = std::min(lanes, n_ - pack * lanes);
      for (int lane = 0; lane < lanes; ++lane) {
        const std::size_t e = pack * lanes + std::min(lane, used - 1);
        for (int a = 0; a < count; ++a) nodal_mass[a].set(lane, mass_factor_[e] * nodal_mass_[e * count + a]);
      }
      const Pack bound = OnePointSolid<Cell>::bound_frequency(moduli, section_, x, nodal_mass);
      for (int lane = 0; lane < used; ++lane) squared[pack * lanes + lane] = bound[lane];
    }
  }

 private:
  // Row sums of the consistent mass, r and all: a node on the axis has the mass of the ring's part that is its own.
  void set_masses(const double* points, double density) {
    constexpr int q_count = std::is_same_v<Cell, Tri3> ? 6 : 4;  // exact for N_a r det J
    static const ShapeTable<Cell, q_count> rule;
    for (int e = 0; e < n_; ++e)
      for (int q = 0; q < q_count; ++q) {
        double jacobian[2][2] = {}, r = 0.0;
        for (int a = 0; a < count; ++a) {
          const double* x = points + 2 * connectivity_[std::size_t(e) * count + a];
          r += rule.N[q][a] * x[0];
          for (int i = 0; i < 2; ++i)
            for (int j = 0; j < 2; ++j) jacobian[i][j] += rule.dN[q][a][i] * x[j];
        }
        const double det = jacobian[0][0] * jacobian[1][1] - jacobian[0][1] * jacobian[1][0];
        const double thickness = section_.axisymmetric ? 2.0 * std::numbers::pi * r : section_.depth;
        for (int a = 0; a < count; ++a)
          nodal_mass_[std::size_t(e) * count + a] += density * rule.weight[q] * det * thickness * rule.N[q][a];
      }
  }

  Law law_;
  SolidSection section_;
};

}  // namespace

void PlaneSolids::list_state(const std::string& owner, std::vector<StateField>& fields) {
  fields.push_back(row_field(owner, "mass_factor", mass_factor_.data(), mass_factor_.size()));
  StateField points = rows_field(owner, "points", CycleRow::stress, CycleRow::hourglass, CycleRow::count);
  points.shape = {std::size_t(n_), 1, points.shape[1]};
  fields.push_back(std::move(points));
  fields.push_back(rows_field(owner, "hourglass", CycleRow::hourglass, 2));
  fields.push_back(rows_field(owner, "work", CycleRow::work, 2));
}

std::unique_ptr<PlaneSolids> make_plane_solids(std::string_view element, std::vector<int> cells, const double* points,
                                               PlaneSolidLaw law, double density, const SolidSection& section) {
  const auto make = [&]<class Cell>() {
    if (cells.empty() || cells.size() % Cell::nodes != 0)
      throw std::invalid_argument("cells must have shape (n > 0, nodes of the element)");
    return std::visit(
        [&](auto& chosen) -> std::unique_ptr<PlaneSolids> {
          using Law = std::remove_reference_t<decltype(chosen)>;
          return std::make_unique<Block<Cell, Law>>(std::move(cells), points, std::move(chosen), density, section);
        },
        law);
  };
  if (element == "tri3") return make.template operator()<Tri3>();
  if (element == "quad4_1pt") return make.template operator()<Quad4>();
  throw std::invalid_argument("the explicit loop has no plane element of this name");
}

}  // namespace presswork::explicit_dynamics
