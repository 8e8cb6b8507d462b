// SPDX-License-Identifier: Apache-2.0
// Shells of one kind, section and law in the explicit loop: gathers and scatters around a kernel of element/.
//
// A Kind says what the shell is; it has
//   nodes, name                                     name: in messages
//   rows(section)                                   of its state
//   inertia_ratio(area, thickness)                  rotary inertia over mass [mm2]
//   begin(x, axis, thickness, area, set)            area and state at the start, by set(row, value); false where the
//                                                   element has no area or the axis of its law is normal to it
//   advance(law, section, now, x, v, w, room, state, force)  one step of a pack; room between tools at its nodes, or
//   null bound_frequency(young, poisson, x, state, mass, ratio)  bound of the highest frequency squared [1/s2]
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>

#include "explicit/gather.hpp"
#include "explicit/space/shell_section.hpp"
#include "material/umat.hpp"

namespace presswork::explicit_dynamics {

template <class Real, class Kind>
class ShellBlock final : public SheetBlock<Real> {
  using P = PackOf<Real>;
  static constexpr int lanes = SheetBlock<Real>::lanes, each = Kind::nodes, forces = 6 * each;

 public:
  ShellBlock(const SpaceNodes<Real>& nodes, ShellSection section, std::vector<int> connectivity,
             const double* thickness, const double* axis)
      : SheetBlock<Real>(each, std::move(connectivity), Kind::rows(section)), section_(std::move(section)) {
    section_.control.density = section_.density;
    for (int e = 0; e < this->n_; ++e) {
      double x[each][3], area;
      for (int a = 0; a < each; ++a)
        std::copy_n(nodes.position.data() +
                        std::size_t(SpaceNodes<Real>::position_stride) * this->connectivity_[std::size_t(each) * e + a],
                    3, x[a]);
      if (!Kind::begin(x, axis + 3 * std::size_t(e), thickness[e], area,
                       [&](int row, double value) { this->set_value(e, row, value); }))
        throw std::invalid_argument(Kind::name + std::to_string(e) +
                                    " has no area, or the axis of its material is normal to it");
      const double young = std::visit([](const auto& law) { return law.young; }, section_.law);
      this->stiffest_spring_[e] = stiffest_spring(young, area, thickness[e], each);
      this->mass_[e] = this->true_mass_[e] = section_.density * area * thickness[e];
      this->area_[e] = area;
      this->inertia_ratio_[e] = Kind::inertia_ratio(area, thickness[e]);
    }
  }

  const ShellSection& section() const override { return section_; }

  int advance(const SpaceNodes<Real>& nodes, double dt, double time, int first, int last, Real* force) override {
    return std::visit([&](const auto& law) { return advance_packs(law, nodes, dt, time, first, last, force); },
                      section_.law);
  }

  void bound_frequencies(const SpaceNodes<Real>& nodes, double* squared) const override {
    const auto [young, poisson] =
        std::visit([](const auto& law) { return std::pair(law.young, law.poisson); }, section_.law);
#pragma omp parallel for schedule(static) if (this->n_ >= SpaceNodes<Real>::serial_elements)
    for (int pack = 0; pack < this->n_packs(); ++pack) {
      P x[each][3], mass, ratio;
      gather_positions<each>(nodes, this->pack_nodes(pack), x);
      const int used = std::min(lanes, this->n_ - pack * lanes);
      for (int lane = 0; lane < lanes; ++lane) {
        const int e = pack * lanes + std::min(lane, used - 1);
        mass.set(lane, static_cast<Real>(this->mass_[e]));
        ratio.set(lane, static_cast<Real>(this->inertia_ratio_[e]));
      }
      const P bound = Kind::bound_frequency(young, poisson, x, this->pack_state(pack), mass, ratio);
      for (int lane = 0; lane < used; ++lane) squared[pack * lanes + lane] = bound[lane];
    }
  }

 private:
  template <class Law>
  int advance_packs(const Law& law, const SpaceNodes<Real>& nodes, double dt, double time, int first, int last,
                    Real* force) {
    if constexpr (std::is_same_v<Law, UserSheet> && !std::is_same_v<Real, double>) {
      return -1;  // refused when it is made
    } else {
      return advance_with(law, nodes, dt, time, first, last, force);
    }
  }

  template <class Law>
  int advance_with(const Law& law, const SpaceNodes<Real>& nodes, double dt, double time, int first, int last,
                   Real* force) {
    int failed = -1;
    [[maybe_unused]] std::optional<ShellPlaces> places;
    for (int pack = first; pack < last; ++pack) {
      P x[each][3], v[each][3], w[each][3], nodal[forces];
      this->expect_pack(pack + 1);
      gather_positions<each>(nodes, this->pack_nodes(pack), x);
      gather_motion<each>(nodes, this->pack_nodes(pack), v, w);
      P room[each];
      if (nodes.room) gather_room<each>(nodes, this->pack_nodes(pack), room);
      if (nodes.room && this->is_relieved()) {
        P relief;
        for (int lane = 0; lane < lanes; ++lane)
          relief.set(lane, static_cast<Real>(this->relief(std::min(pack * lanes + lane, this->n_ - 1))));
        for (P& of_node : room) of_node = of_node - relief;
      }
      LayerConditions<P> now{dt, this->pack_temperature(pack)};
      now.slower = this->slower;
      if constexpr (std::is_same_v<Law, UserSheet>) now.places = place_shells(time, pack, x, places);
      Kind::advance(law, section_, now, x, v, w, nodes.room ? room : nullptr, this->pack_state(pack), nodal);
      Real* to[lanes];
      for (int lane = 0; lane < lanes; ++lane) to[lane] = force + forces * (std::size_t(pack - first) * lanes + lane);
      if constexpr (forces % (lanes / 2) == 0)
        store_records<forces>(nodal, to);
      else
        for (int lane = 0; lane < lanes; ++lane)
          for (int i = 0; i < forces; ++i) to[lane][i] = nodal[i][lane];
      if constexpr (Law::can_fail)
        if (failed < 0 && any(!(nodal[0] * nodal[0] > P(-1)))) {
          const int shell = find_failed(pack, x, v, w, nodal[0]);
          auto told = LawStatus::no_stress;
          if (places && places->fault.status != LawStatus::done) told = places->fault.status;
          if (shell >= 0) failed = reasons * shell + static_cast<int>(told);
        }
    }
    return failed;
  }

  // Numbers, centres and sizes of a pack's shells at a time.
  ShellPlaces* place_shells(double time, int pack, const P x[each][3], std::optional<ShellPlaces>& made) const {
    if (!made) made.emplace();
    made->first = pack * lanes;
    made->lanes.count = std::min(lanes, this->n_ - pack * lanes);
    for (int lane = 0; lane < made->lanes.count; ++lane) {
      UmatPlace& place = made->lanes.place[lane];
      double p[3], q[3], normal[3];
      for (int i = 0; i < 3; ++i) {
        place.coordinates[i] = 0.0;
        for (int a = 0; a < each; ++a) place.coordinates[i] += x[a][i][lane] / each;
        p[i] = x[2][i][lane] - x[0][i][lane], q[i] = x[each - 1][i][lane] - x[1][i][lane];
        if (each == 3) p[i] = x[1][i][lane] - x[0][i][lane], q[i] = x[2][i][lane] - x[0][i][lane];
      }
      shell4::cross(p, q, normal);
      place.length = std::sqrt(0.5 * std::sqrt(shell4::dot(normal, normal)));
      place.cell = section_.number.empty() ? pack * lanes + lane + 1 : section_.number[pack * lanes + lane] + 1;
      place.time[0] = place.time[1] = time;
    }
    return &*made;
  }

  // The first element of a pack whose force is NaN though its motion is finite, or -1.
  int find_failed(int pack, const P x[each][3], const P v[each][3], const P w[each][3], const P& force) const {
    for (int lane = 0; lane < lanes && pack * lanes + lane < this->n_; ++lane) {
      bool finite = true;
      for (int a = 0; a < each; ++a)
        for (int i = 0; i < 3; ++i)
          finite =
              finite && std::isfinite(x[a][i][lane]) && std::isfinite(v[a][i][lane]) && std::isfinite(w[a][i][lane]);
      if (finite && std::isnan(force[lane])) return pack * lanes + lane;
    }
    return -1;
  }

  ShellSection section_;
};

}  // namespace presswork::explicit_dynamics
