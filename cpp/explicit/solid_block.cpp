// SPDX-License-Identifier: Apache-2.0
#include "explicit/solid_block.hpp"

#include <algorithm>
#include <stdexcept>

#include "tensor/records.hpp"

namespace presswork::explicit_dynamics {

namespace {

// Positions of a pack's nodes and their moves in the cycle, lane by lane; node: [node][lane].
template <int count>
[[gnu::always_inline]] inline void gather(const double* nodes, const int* node, Pack x[count][2], Pack du[count][2]) {
  for (int a = 0; a < count; ++a, node += Pack::width) {
    const double* from[Pack::width];
    for (int lane = 0; lane < Pack::width; ++lane)
      from[lane] = nodes + std::size_t(SolidBlock::node_record) * node[lane];
    Pack record[SolidBlock::node_record];
    load_records<SolidBlock::node_record>(from, record);
    for (int i = 0; i < 2; ++i) x[a][i] = record[i], du[a][i] = record[2 + i];
  }
}

}  // namespace

SolidBlock::SolidBlock(std::string_view element, std::vector<int> cells, const double* points, SolidLawChoice law,
                       double density, const SolidSection& section)
    : cells(std::move(cells)), law_(std::move(law)), density_(density), section_(section) {
  if (element == "tri3")
    use<Tri3>(points);
  else if (element == "quad4_1pt")
    use<Quad4>(points);
  else
    throw std::invalid_argument("the explicit loop has no element of this name");
}

template <class Cell>
void SolidBlock::use(const double* points) {
  nodes_ = Cell::nodes;
  if (cells.empty() || cells.size() % nodes_ != 0)
    throw std::invalid_argument("cells must have shape (n > 0, nodes of the element)");
  n_ = static_cast<int>(cells.size()) / nodes_;
  std::visit(
      [this](const auto& law) {
        using Law = decltype(view(law));
        rows_ = CycleRow::count + extra_rows(view(law));
        advance_ = &SolidBlock::advance_packs<Cell, Law>;
      },
      law_);
  bound_ = &SolidBlock::bound_packs<Cell>;
  packed_.resize(std::size_t(n_packs()) * nodes_ * lanes);
  for (int slot = 0; slot < n_packs() * lanes; ++slot)
    for (int a = 0; a < nodes_; ++a)
      packed_[(std::size_t(slot / lanes) * nodes_ + a) * lanes + slot % lanes] =
          cells[std::size_t(nodes_) * std::min(slot, n_ - 1) + a];
  state_ = AlignedArray<double>(std::size_t(n_packs()) * rows_ * lanes);
  start_law();
  mass.resize(cells.size()), mass_factor.assign(n_, 1.0);
  set_masses<Cell>(points);
}

// Row sums of the consistent mass, r and all: a node on the axis has the mass of the ring's part that is its own.
template <class Cell>
void SolidBlock::set_masses(const double* points) {
  constexpr int q_count = std::is_same_v<Cell, Tri3> ? 6 : 4;  // exact for N_a r det J
  constexpr int count = Cell::nodes;
  static const ShapeTable<Cell, q_count> rule;
  for (int e = 0; e < n_; ++e)
    for (int q = 0; q < q_count; ++q) {
      double jacobian[2][2] = {}, r = 0.0;
      for (int a = 0; a < count; ++a) {
        const double* x = points + 2 * cells[std::size_t(e) * count + a];
        r += rule.N[q][a] * x[0];
        for (int i = 0; i < 2; ++i)
          for (int j = 0; j < 2; ++j) jacobian[i][j] += rule.dN[q][a][i] * x[j];
      }
      const double det = jacobian[0][0] * jacobian[1][1] - jacobian[0][1] * jacobian[1][0];
      const double thickness = section_.axisymmetric ? 2.0 * std::numbers::pi * r : section_.depth;
      for (int a = 0; a < count; ++a)
        mass[std::size_t(e) * count + a] += density_ * rule.weight[q] * det * thickness * rule.N[q][a];
    }
}

// What a law keeps before the first cycle: its x is the plane's, a deformation gradient is that of no deformation.
void SolidBlock::start_law() {
  std::vector<std::pair<int, double>> first;
  if (std::holds_alternative<Owned<PlaneLaw>>(law_)) first = {{rows_ - 2, 1.0}};
  if (const auto* user = std::get_if<OwnedUmat>(&law_))
    for (int i : {0, 4, 8}) first.push_back({CycleRow::count + user->umat.n_state + UmatHistory<4>::F + i, 1.0});
  for (int e = 0; e < n_; ++e)
    for (const auto& [row, value] : first) set_value(e, row, value);
}

void SolidBlock::set_temperature(const double* degrees) {
  if (temperature_.size() == 0) temperature_ = AlignedArray<double>(std::size_t(n_packs()) * lanes);
  for (int slot = 0; slot < n_packs() * lanes; ++slot) temperature_.data()[slot] = degrees[std::min(slot, n_ - 1)];
}

template <class Cell, class Law>
int SolidBlock::advance_packs(const double* nodes, double dt, double time, int first, int last, double* force) {
  constexpr int count = Cell::nodes;
  using Own = std::conditional_t<std::is_same_v<Law, CycleUmat>, OwnedUmat, Owned<Law>>;
  const Own& own = *std::get_if<Own>(&law_);
  int failed = -1;
  for (int pack = first; pack < last; ++pack, force += force_record * lanes) {
    Pack x[count][2], du[count][2], nodal[force_record];
    gather<count>(nodes, &packed_[std::size_t(pack) * count * lanes], x, du);
    Pack* state = reinterpret_cast<Pack*>(state_.data() + index(pack * lanes, 0));
    CyclePlace place;
    place.first = pack * lanes, place.used = std::min(lanes, n_ - pack * lanes), place.time = time;
    if (temperature_.size() > 0) place.temperature = reinterpret_cast<const Pack*>(temperature_.data()) + pack;
    Pack::Mask bad;
    if constexpr (std::is_same_v<Law, CycleUmat>)
      bad = OnePointSolid<Cell>::advance(view(own), section_, dt, x, du, place, state, nodal);
    else
      bad = OnePointSolid<Cell>::advance(own.view, section_, dt, x, du, place, state, nodal);
    for (int lane = 0; failed < 0 && lane < lanes && any(bad); ++lane)
      if (bad[lane]) failed = reasons * std::min(pack * lanes + lane, n_ - 1);
    if (failed < 0 && place.fault.status != LawStatus::done)
      failed = reasons * place.fault.cell + static_cast<int>(place.fault.status);
    for (int i = 2 * count; i < force_record; ++i) nodal[i] = Pack(0.0);
    double* to[lanes];
    for (int lane = 0; lane < lanes; ++lane) to[lane] = force + force_record * lane;
    store_records<force_record>(nodal, to);
  }
  return failed;
}

template <class Cell>
void SolidBlock::bound_packs(const double* nodes, double* squared) const {
  constexpr int count = Cell::nodes;
  const IsotropicModuli moduli = std::visit([this](const auto& law) { return moduli_of(view(law)); }, law_);
#pragma omp parallel for schedule(static) if (n_ > 4000)
  for (int pack = 0; pack < n_packs(); ++pack) {
    Pack x[count][2], du[count][2], nodal_mass[count];
    gather<count>(nodes, &packed_[std::size_t(pack) * count * lanes], x, du);
    const int used = std::min(lanes, n_ - pack * lanes);
    for (int lane = 0; lane < lanes; ++lane) {
      const std::size_t e = pack * lanes + std::min(lane, used - 1);
      for (int a = 0; a < count; ++a) nodal_mass[a].set(lane, mass_factor[e] * mass[e * count + a]);
    }
    const Pack bound = OnePointSolid<Cell>::bound_frequency(moduli, section_, x, nodal_mass);
    for (int lane = 0; lane < used; ++lane) squared[pack * lanes + lane] = bound[lane];
  }
}

}  // namespace presswork::explicit_dynamics
