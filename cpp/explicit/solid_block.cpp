// SPDX-License-Identifier: Apache-2.0
#include "explicit/solid_block.hpp"

#include <stdexcept>

namespace presswork::explicit_dynamics {

template <Cell cell, Treatment treatment>
void SolidBlock::use() {
  nodes_ = node_count(cell);
  advance_ = &Solid2d<cell, 1, treatment>::template evaluate<AdiabaticMises>;
  bound_ = &bound_pack<cell, treatment>;
  weigh_ = &SolidBlock::set_masses<cell>;
}

SolidBlock::SolidBlock(std::string_view element, std::vector<int> cells, const double* points,
                       const AdiabaticMises& law, double density, const SolidSettings& settings)
    : cells(std::move(cells)), law_(law), density_(density), settings_(settings) {
  if (element == "tri3")
    use<Cell::tri3, Treatment::standard>();
  else if (element == "quad4_1pt")
    use<Cell::quad4, Treatment::one_point>();
  else
    throw std::invalid_argument("the explicit loop has no element of this name");
  if (this->cells.empty() || this->cells.size() % nodes_ != 0)
    throw std::invalid_argument("cells must have shape (n > 0, nodes of the element)");
  n_ = static_cast<int>(this->cells.size()) / nodes_;
  const auto n = static_cast<std::size_t>(n_);
  stress.resize(4 * n), eqps.resize(n), rise.resize(n), hourglass.resize(2 * n), volume.resize(n), work.resize(2 * n);
  mass.resize(n * nodes_), mass_factor.assign(n, 1.0);
  (this->*weigh_)(points);
}

BlockView SolidBlock::view(const double* points, const double* increment, double dt, double* force) {
  BlockView b{n_,
              cells.data(),
              points,
              increment,
              settings_.axisymmetric,
              settings_.depth,
              stress.data(),
              eqps.data(),
              hourglass.data(),
              settings_.hourglass_fraction,
              stress.data(),
              eqps.data(),
              hourglass.data(),
              volume.data(),
              force,
              nullptr,
              false};
  b.user_n = b.user = rise.data();
  b.work = work.data();
  b.when.dt = dt;
  return b;
}

// State is advanced in place: a pack reads its cells before it writes them, and no cell is in two packs.
int SolidBlock::advance(const double* points, const double* increment, double dt, double* force, int pack) {
  PointSettings settings;
  settings.measure = settings_.measure;
  settings.tangent = TangentKind::none;
  return advance_(view(points, increment, dt, force), settings, law_, pack);
}

void SolidBlock::bound_frequencies(const double* points, double* squared) const {
#pragma omp parallel for schedule(static) if (n_ > 4000)
  for (int pack = 0; pack < n_packs(); ++pack) bound_(*this, points, pack, squared);
}

// Row sums of the consistent mass, r and all: a node on the axis has the mass of the ring's part that is its own.
template <Cell cell>
void SolidBlock::set_masses(const double* points) {
  constexpr int q_count = cell == Cell::tri3 ? 6 : 4;  // exact for N_a r det J
  constexpr int count = node_count(cell);
  static const ShapeTable<cell, q_count> rule;
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
      const double thickness = settings_.axisymmetric ? 2.0 * std::numbers::pi * r : settings_.depth;
      for (int a = 0; a < count; ++a)
        mass[std::size_t(e) * count + a] += density_ * rule.weight[q] * det * thickness * rule.N[q][a];
    }
}

// The eigenvalues of M^-1 V B^T D B are those of A = V D (B M^-1 B^T), of which n can differ from 0 (3 in plane strain,
// 4 in axisymmetry); with their sum s and sum of squares t the largest is at most s/n + sqrt((n-1)/n (t - s^2/n))
// (Wolkowicz & Styan 1980). The hourglass control adds at most its own.
template <Cell cell, Treatment treatment>
void SolidBlock::bound_pack(const SolidBlock& block, const double* points, int pack, double* squared) {
  using Kernel = Solid2d<cell, 1, treatment>;
  using T = Pack;
  constexpr int count = Kernel::nodes;
  T x[count][2], inverse_mass[count];
  const int first = pack * pack_width;
  for (int lane = 0; lane < pack_width; ++lane) {
    const std::size_t e = std::min(first + lane, block.n_ - 1);
    for (int a = 0; a < count; ++a) {
      for (int i = 0; i < 2; ++i) x[a][i].set(lane, points[2 * block.cells[e * count + a] + i]);
      inverse_mass[a].set(lane, 1.0 / (block.mass_factor[e] * block.mass[e * count + a]));
    }
  }
  const bool ring = block.settings_.axisymmetric;
  BlockView b{};
  b.axisymmetric = ring;
  b.depth = block.settings_.depth;
  typename Kernel::PointGeometry g;
  bool measured = false;
  if constexpr (treatment == Treatment::one_point)
    if ((measured = ring)) Kernel::measure_mean(x, g);
  if (!measured) Kernel::measure_reference(b, x, 0, g);

  T G[4][4] = {};
  for (int a = 0; a < count; ++a) {
    const T along[2][4] = {{g.grad[a][0], T(0.0), g.hoop[a], g.grad[a][1]},
                           {T(0.0), g.grad[a][1], T(0.0), g.grad[a][0]}};
    for (const auto& row : along)
      for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j) G[i][j] += inverse_mass[a] * row[i] * row[j];
  }
  const double shear = block.law_.mises.shear_modulus(), lame = block.law_.mises.bulk_modulus() - 2.0 / 3.0 * shear;
  T A[4][4], sum(0.0), squares(0.0);
  for (int j = 0; j < 4; ++j) {
    const T trace = T(lame) * (G[0][j] + G[1][j] + G[2][j]);
    for (int i = 0; i < 3; ++i) A[i][j] = g.volume_t * (trace + T(2.0 * shear) * G[i][j]);
    A[3][j] = g.volume_t * T(shear) * G[3][j];
  }
  for (int i = 0; i < 4; ++i) {
    sum += A[i][i];
    for (int j = 0; j < 4; ++j) squares += A[i][j] * A[j][i];
  }
  const double n = ring ? 4.0 : 3.0;
  T bound = sum * T(1.0 / n) + square_root(larger(T((n - 1.0) / n) * (squares - sum * sum * T(1.0 / n)), T(0.0)));
  if constexpr (treatment == Treatment::one_point) {
    constexpr double h[4] = {1, -1, 1, -1};
    T at[2] = {T(0.0), T(0.0)}, norm(0.0), inertia(0.0);
    for (int a = 0; a < 4; ++a)
      for (int i = 0; i < 2; ++i) at[i] += T(h[a]) * x[a][i], norm += g.grad[a][i] * g.grad[a][i];
    for (int a = 0; a < 4; ++a) {
      const T gamma = T(0.25) * (T(h[a]) - at[0] * g.grad[a][0] - at[1] * g.grad[a][1]);
      inertia += gamma * gamma * inverse_mass[a];
    }
    bound += T(2.0 * block.settings_.hourglass_fraction * shear) * g.volume_t * norm * inertia;
  }
  for (int lane = 0; lane < pack_width && first + lane < block.n_; ++lane) squared[first + lane] = bound[lane];
}

}  // namespace presswork::explicit_dynamics
