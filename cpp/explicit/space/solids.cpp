// SPDX-License-Identifier: Apache-2.0
#include "explicit/space/solids.hpp"

#include <algorithm>

#include "element/solid.hpp"

namespace presswork::explicit_dynamics {

namespace {

// The points of a pack of cells: their state is kept in the rows of the pack, and replaced when all has gone well.
template <class Body, int n_points, class Law>
struct PackPoints {
  LawOfPack<Law, n_points>& law;
  double dt;
  Pack start;                       // temperature where none is given
  const Pack *temperature, *state;  // given to the points, or null; of the first point
  int rows;
  Pack next[n_points][most_point_values<6>];
  Pack::Mask failed;

  [[gnu::always_inline]] inline void advance(int q, const Pack[][3], const Pack[][3], const typename Body::Point*,
                                             const Pack* F, typename Body::Response& response) {
    const Pack given = temperature ? temperature[q] : start;
    PointSettings settings;
    settings.tangent = TangentKind::none;
    failed = either(failed, respond(settings, law.at(q), F, dt, given, state + q * rows, next[q], response));
  }
  void keep(int, Pack) const {}
};

template <class Cell, int n_points, Treatment treatment, class Law>
class Block final : public SpaceSolids {
  static constexpr int count = Cell::nodes, record = Nodes::record(count);
  using Kernel = Solid<3, Cell, n_points, treatment, Pack>;
  using Body = typename Kernel::Body;
  // Rows: work, forces on the nodes, the points.
  static constexpr int work_row = 0, force_row = 1, first_point = force_row + 3 * count;

 public:
  void list_state(const std::string& owner, std::vector<StateField>& fields) override {
    SpaceSolids::list_state(owner, fields);
    fields.push_back(rows_field(owner, "work", work_row, 1));
    fields.push_back(rows_field(owner, "force", force_row, 3 * count));
  }
  Block(std::vector<int> cells, const Nodes& nodes, Owned<Law> law, double density)
      : SpaceSolids(count, std::move(cells), first_point, n_points, kept_values(law.view), work_row, -1),
        law_(std::move(law)) {
    set_masses<Cell, n_points>(nodes, density);
  }

  int advance(const Nodes& nodes, double dt, double time, int first, int last, double* force) override {
    int failed = -1;
    LawOfPack<Law, n_points> law(law_.view);
    for (int pack = first; pack < last; ++pack, force += record * lanes) {
      Pack x[count][3], du[count][3], spin[count][3], now[3 * count], nodal[record];
      gather_positions<count>(nodes, pack_nodes(pack), x);
      gather_motion<count>(nodes, pack_nodes(pack), du, spin);
      law.template begin<Cell>(place_of(pack, time, dt), x);
      for (int a = 0; a < count; ++a)
        for (int i = 0; i < 3; ++i) du[a][i] *= Pack(dt), x[a][i] -= du[a][i];
      Pack* state = pack_state(pack);
      PackPoints<Body, n_points, Law> points{law,
                                             dt,
                                             Pack(start_temperature(law_.view)),
                                             pack_temperature(pack),
                                             state + first_point,
                                             point_rows_,
                                             {},
                                             Pack(1.0) < Pack(0.0)};
      const Pack::Mask bad = Kernel::evaluate({}, {}, x, du, points, now, nullptr);
      if (any(bad) || any(points.failed)) {
        if (failed < 0) failed = name_failed(pack, bad, points.failed, law.told());
        continue;
      }
      Pack done(0.0);
      for (int a = 0; a < count; ++a)
        for (int i = 0; i < 3; ++i) {
          done += (state[force_row + 3 * a + i] + now[3 * a + i]) * du[a][i];
          state[force_row + 3 * a + i] = nodal[freedoms * a + i] = now[3 * a + i];
          nodal[freedoms * a + 3 + i] = Pack(0.0);
        }
      state[work_row] += Pack(0.5) * done;
      for (int q = 0; q < n_points; ++q) keep_point(law.at(q), points.next[q], state + first_point + q * point_rows_);
      double* to[lanes];
      for (int lane = 0; lane < lanes; ++lane) to[lane] = force + record * lane;
      store_records<record>(nodal, to);
    }
    return failed;
  }

  // At most the sum of w_q (K + 2 G) sum_a |grad N_a|^2/m_a over the points: the energy of a motion is at most K tr^2 +
  // 2 G |strain|^2 there, and trace and size of its gradient are at most those of the nodes' parts together.
  void bound_frequencies(const Nodes& nodes, double* squared) const override {
    const double modulus = law_.view.bulk_modulus() + 2.0 * law_.view.shear_modulus();
#pragma omp parallel for schedule(static) if (n_ >= Nodes::serial_elements)
    for (int pack = 0; pack < n_packs(); ++pack) {
      Pack x[count][3], mass[count], bound(0.0);
      load_masses(pack, mass);
      gather_positions<count>(nodes, pack_nodes(pack), x);
      const int used = std::min(lanes, n_ - pack * lanes);
      for (int q = 0; q < n_points; ++q) {
        typename Body::Point g;
        Body::measure_reference({}, x, q, g);
        for (int a = 0; a < count; ++a)
          for (int i = 0; i < 3; ++i) bound += g.volume_t * g.grad[a][i] * g.grad[a][i] / mass[a];
      }
      for (int lane = 0; lane < used; ++lane) squared[pack * lanes + lane] = modulus * bound[lane];
    }
  }

 private:
  Owned<Law> law_;
};

}  // namespace

void SpaceSolids::list_state(const std::string& owner, std::vector<StateField>& fields) {
  fields.push_back(row_field(owner, "mass_factor", mass_factor_.data(), mass_factor_.size()));
  StateField points = rows_field(owner, "points", first_point_, n_points_ * point_rows_);
  points.shape = {std::size_t(n_), std::size_t(n_points_), std::size_t(point_rows_)};
  fields.push_back(std::move(points));
}

std::unique_ptr<SpaceSolids> make_space_solids(std::string_view element, std::vector<int> cells,
                                               const SpaceNodes<double>& nodes, SpaceSolidLaw law, double density,
                                               double hourglass_fraction) {
  if (cells.empty() || cells.size() % Hex8::nodes != 0)
    throw std::invalid_argument("cells must have shape (n > 0, nodes of the element)");
  const auto make = [&]<Treatment treatment>() {
    return std::visit(
        [&]<class Law>(Owned<Law>& chosen) -> std::unique_ptr<SpaceSolids> {
          return std::make_unique<Block<Hex8, 8, treatment, Law>>(std::move(cells), nodes, std::move(chosen), density);
        },
        law);
  };
  if (element == "hex8") return make.template operator()<Treatment::standard>();
  if (element == "hex8_fbar") return make.template operator()<Treatment::fbar>();
  if (element == "hex8_1pt")
    return make_one_point_hexahedra(std::move(cells), nodes, std::move(law), density, hourglass_fraction);
  throw std::invalid_argument("the explicit loop has no solid in space of this name");
}

}  // namespace presswork::explicit_dynamics
