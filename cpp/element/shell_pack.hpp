// SPDX-License-Identifier: Apache-2.0
// One pack of shells in one increment: lanes in, points and layers, lanes out. The arithmetic is in shell.hpp.
#pragma once

#include <algorithm>

#include "element/layered_section.hpp"
#include "element/shell.hpp"
#include "element/shell_bubble.hpp"

namespace presswork {

enum class ShellFault : int { none = 0, inside_out = 1, turned_too_far = 2, law = 3, bubble = 4 };
inline constexpr int shell_faults = 5;

inline constexpr double bubble_tolerance = 1e-7;  // [rad] of Newton's last step; what it leaves is its square
inline constexpr int bubble_steps = 12;

// Views of one block of shells, C-contiguous. q points in the plane, k layers, h history values, m directors.
struct ShellView {
  int n_cells, n_layers, n_history;
  const int* connectivity;       // (n_cells, nodes)
  const int* director_of;        // (n_cells, nodes) into director
  const double* undeformed;      // (n_points, 3) [mm]: what the shape of a cell ties its strains by
  const double* points;          // (n_points, 3) at t [mm]
  const double* increment;       // (n_points, 6) displacement [mm], rotation vector [rad] since t
  const double* director;        // (m, 3) at t
  const double* layer_position;  // (k) in (-1, 1)
  const double* layer_weight;    // (k), sums to 2
  double dt, penalty;
  const double *thickness_n, *stress_n, *history_n, *direction_n, *shear_n, *internal_n;
  double* thickness;                    // (n_cells, q) [mm]
  double* stress;                       // (n_cells, q, k, 3) [MPa]
  double* history;                      // (n_cells, q, k, h)
  double* direction;                    // (n_cells, q, k, 2)
  double* shear;                        // (n_cells, q, 2)
  double* internal;                     // (n_cells, internal_values)
  double* volume;                       // (n_cells, q, k) [mm3] at t+dt
  double* force;                        // (n_packs, 6 nodes, pack_width)
  double* stiffness;                    // (n_packs, 6 nodes, 6 nodes, pack_width), or null
  bool symmetric;                       // keep the symmetric part of the stiffness
  bool small = false;                   // displacements: points and directors are the undeformed ones
  const double* temperature = nullptr;  // (n_cells, q, k) given [degrees C]; null: that of the law's start
  // for laws from shared libraries
  UmatPlace when = {};        // stage, increment and times
  int first_cell = 0;         // of the block in the mesh
  LawFault* fault = nullptr;  // (n_packs)
};

struct ShellFailure {
  int cell = -1;
  ShellFault fault = ShellFault::none;
};

// What plastic flow leaves of stress beside that at the centre: von Mises' stress over that of the elastic trial, as a
// mean over the layers, of membrane stress and, weighted by z^2, of bending; 1 in elastic steps. With derivatives.
template <class T>
struct Retained {
  T trial[2], found[2], trial_slope[2][3][3], found_slope[2][3][3];  // slopes by E0, E1, E2

  Retained() {
    for (int m = 0; m < 2; ++m) {
      trial[m] = found[m] = T(negligible_square);
      for (int p = 0; p < 3; ++p)
        for (int c = 0; c < 3; ++c) trial_slope[m][p][c] = found_slope[m][p][c] = T(0.0);
    }
  }

  // height: of the layer in half thicknesses; z [mm]
  void add(const StressSquares<T>& s, const T Q[3][3], double weight, double height, T z) {
    for (int m = 0; m < 2; ++m) {
      T power(m == 0 ? weight : weight * height * height);
      trial[m] += power * s.trial.value, found[m] += power * s.found.value;
      for (int p = 0; p < 3; ++p, power *= z)
        for (int c = 0; c < 3; ++c)
          for (int i = 0; i < 3; ++i) {
            trial_slope[m][p][c] += power * Q[i][c] * s.trial.slope[i];
            found_slope[m][p][c] += power * Q[i][c] * s.found.slope[i];
          }
    }
  }

  T evaluate(int m, T slope[3][3]) const {
    T ratio = square_root(found[m] / trial[m]), half = T(0.5) * ratio;
    const auto flows = ratio < T(1.0);
    T of_found = select(flows, half / found[m], T(0.0)), of_trial = select(flows, half / trial[m], T(0.0));
    for (int p = 0; p < 3; ++p)
      for (int c = 0; c < 3; ++c) slope[p][c] = of_found * found_slope[m][p][c] - of_trial * trial_slope[m][p][c];
    return select(flows, ratio, T(1.0));
  }
};

template <class Cell, int n_points, Tying tying, class T>
struct ShellPack {
  using Kernel = Shell<Cell, n_points, tying, T>;
  using Table = typename Kernel::Table;
  static constexpr int nodes = Kernel::nodes, freedoms = Kernel::freedoms, mesh_nodes = Kernel::mesh_nodes;
  static constexpr int internal_values = Kernel::has_bubble ? 2 : 0;
  static constexpr int width = std::is_same_v<T, double> ? 1 : pack_width;

  const ShellView& view;
  const ShellLaw& law;
  const Table& table = Table::get();
  int first, used, cells[width];
  typename Kernel::Nodes n;
  T undeformed[nodes][3];
  typename Kernel::Forms forms{table, {}};
  T mid_x[nodes][3], mid_d[nodes][3], end_x[nodes][3], end_d[nodes][3];  // half-way and at t+dt

  ShellPack(const ShellView& v, const ShellLaw& l, int pack) : view(v), law(l), first(pack * width) {
    used = std::min(width, v.n_cells - first);
    for (int lane = 0; lane < width; ++lane) {
      cells[lane] = first + std::min(lane, used - 1);
      for (int a = 0; a < mesh_nodes; ++a) {
        const std::size_t at = static_cast<std::size_t>(cells[lane]) * mesh_nodes + a;
        const int node = v.connectivity[at], director = v.director_of[at];
        for (int i = 0; i < 3; ++i) {
          lanes::set(undeformed[a][i], lane, v.undeformed[3 * node + i]);
          lanes::set(n.x[a][i], lane, v.points[3 * node + i]);
          lanes::set(n.u[a][i], lane, v.increment[6 * node + i]);
          lanes::set(n.turn[a].theta[i], lane, v.increment[6 * node + 3 + i]);
          lanes::set(n.d[a][i], lane, v.director[3 * director + i]);
        }
      }
    }
  }

  // values of a point (n_cells, rows, size): row is the same in all lanes
  void load(const double* array, std::size_t rows, std::size_t row, int size, T* to) const {
    for (int lane = 0; lane < width; ++lane)
      for (int i = 0; i < size; ++i) lanes::set(to[i], lane, array[(cells[lane] * rows + row) * size + i]);
  }
  void save(const T* from, std::size_t rows, std::size_t row, int size, double* array) const {
    save(from, rows, row, size, size, array);
  }
  // the first `count` of them
  void save(const T* from, std::size_t rows, std::size_t row, int count, int size, double* array) const {
    for (int lane = 0; lane < used; ++lane)
      for (int i = 0; i < count; ++i) array[(cells[lane] * rows + row) * size + i] = lanes::get(from[i], lane);
  }

  ShellFailure find(Mask<T> bad, ShellFault fault) const {
    for (int lane = 0; lane < used; ++lane)
      if (lanes::is(bad, lane)) return {cells[lane], fault};
    return {};
  }

  // Where the lanes of layer k of point q are, for a law from a shared library: on the mid-surface.
  UmatLanes find_lanes(int q, int k, const typename Kernel::Surface& surface) const {
    UmatLanes found;
    found.count = used;
    double whole = 0.0;
    for (double weight : table.shape.weight) whole += weight;
    for (int lane = 0; lane < used; ++lane) {
      UmatPlace& place = found.place[lane] = view.when;
      for (int i = 0; i < 3; ++i)
        for (int a = 0; a < mesh_nodes; ++a)
          place.coordinates[i] += table.shape.N[q][a] * lanes::get(end_x[a][i], lane);
      place.length = std::sqrt(whole * lanes::get(surface.area, lane));
      place.cell = view.first_cell + cells[lane] + 1, place.point = q + 1, place.section_point = k + 1;
      const std::size_t row = (std::size_t(cells[lane]) * n_points + q) * view.n_layers + k;
      found.history_n[lane] = view.history_n + row * view.n_history + 1;
      found.history[lane] = view.history + row * view.n_history + 1;
    }
    return found;
  }

  // A layer whose law is from a shared library, by what takes a LayerLaw. On a frame of its own: the lanes take room.
  template <class Advance>
  [[gnu::noinline]] Mask<T> advance_user(int q, int k, const typename Kernel::Surface& surface,
                                         const Advance& advance) const {
    const UmatLanes place = find_lanes(q, k, surface);
    return advance({law, &place, first, &view.fault[first / width]});
  }

  // All layers of point q: their resultants, new thickness and volumes
  ShellFailure run_layers(int q, const typename Kernel::Surface& surface, const typename Kernel::Strain& strain,
                          bool with_modulus, typename Kernel::Resultants& sum, Retained<T>* retained = nullptr) const {
    const std::size_t rows = static_cast<std::size_t>(n_points) * view.n_layers;
    T h, area_now(0.0), volume_now(0.0);  // of all layers, over those of one at t as large as the reference cell
    load(view.thickness_n, n_points, q, 1, &h);
    for (int k = 0; k < view.n_layers; ++k) {
      const std::size_t row = static_cast<std::size_t>(q) * view.n_layers + k;
      Layer<T> at, end;
      LayerResponse<T> response;
      load(view.stress_n, rows, row, 3, at.state);
      if (law.own) load(view.history_n, rows, row, view.n_history, at.state + 3);
      load(view.direction_n, rows, row, 2, at.direction);
      T z = T(0.5 * view.layer_position[k]) * h, Q[3][3], covariant[3], E[3];
      T area = Kernel::lamina_map(surface, z, at.direction, Q);
      for (int c = 0; c < 3; ++c) covariant[c] = strain.E[0][c] + z * (strain.E[1][c] + z * strain.E[2][c]);
      for (int i = 0; i < 3; ++i) E[i] = Q[i][0] * covariant[0] + Q[i][1] * covariant[1] + Q[i][2] * covariant[2];
      // a layer folded onto itself has no stretch
      T c11 = T(1.0) + T(2.0) * E[0], c22 = T(1.0) + T(2.0) * E[1], squared = c11 * c22 - E[2] * E[2];
      T least = view.small ? T(1.0) : smaller(c11, squared);
      if (auto bad = find(!(least > T(1e-6)), ShellFault::inside_out); bad.cell >= 0) return bad;
      StressSquares<T> squares;
      T given(law.start_temperature());
      if (view.temperature) load(view.temperature, rows, row, 1, &given);
      const auto respond = view.small ? &respond_layer_linearly<T> : &respond_layer<T>;
      const auto advance = [&](const LayerLaw& layer_law) {
        return respond(layer_law, view.dt, given, E, with_modulus, at, end, response, retained ? &squares : nullptr);
      };
      auto failed = law.own ? advance({law}) : advance_user(q, k, surface, advance);
      if (retained) retained->add(squares, Q, 0.5 * view.layer_weight[k], view.layer_position[k], z);
      if (auto bad = find(failed, ShellFault::law); bad.cell >= 0) return bad;
      T weight = T(0.5 * table.shape.weight[q] * view.layer_weight[k]) * area * h;
      T across = view.small ? T(1.0) : exponential(response.thickness_strain);
      T widened = square_root(squared), volume = view.small ? weight : weight * across * widened;
      T share = T(0.5 * view.layer_weight[k]) * area * widened;
      area_now += share, volume_now += share * across;
      if (with_modulus && !view.small) {
        const T over = T(1.0) / squared, of_area[3] = {c22 * over, c11 * over, -E[2] * over};
        for (int p = 0; p < 3; ++p, share *= z)
          for (int c = 0; c < 3; ++c)
            for (int i = 0; i < 3; ++i) {
              sum.area[p][c] += share * Q[i][c] * of_area[i];
              sum.thickness[p][c] += share * across * Q[i][c] * (of_area[i] + response.thickness_slope[i]);
            }
      }
      Kernel::add_layer(response, Q, weight, z, with_modulus, sum);
      save(end.state, rows, row, 3, view.stress);
      save(end.state + 3, rows, row, law.own ? view.n_history : 1, view.n_history, view.history);
      save(end.direction, rows, row, 2, view.direction);
      save(&volume, rows, row, 1, view.volume);
    }
    if (!view.small) {
      h *= volume_now / area_now;
      sum.change_thickness(volume_now, area_now);
    }
    save(&h, n_points, q, 1, view.thickness);
    return {};
  }

  // Transverse shear of point q: force per area of the reference cell times the weight, and its stiffness
  void run_shear(int q, const typename Kernel::Surface& surface, const T strain[2], double penalty, T force[2],
                 T D[2][2]) const {
    T h, p[2];
    load(view.thickness_n, n_points, q, 1, &h);
    load(view.shear_n, n_points, q, 2, p);
    T stiffness = T(shear_factor * 0.5 / (1.0 + law.poisson) * law.young) * h * surface.area;
    const T* inverse = surface.inverse;
    p[0] += stiffness * (inverse[0] * strain[0] + inverse[2] * strain[1]);
    p[1] += stiffness * (inverse[2] * strain[0] + inverse[1] * strain[1]);
    save(p, n_points, q, 2, view.shear);
    T weight(table.shape.weight[q]), with_penalty = weight * stiffness * T(1.0 + penalty);
    for (int k = 0; k < 2; ++k) force[k] = weight * p[k];
    D[0][0] = with_penalty * inverse[0], D[1][1] = with_penalty * inverse[1];
    D[0][1] = D[1][0] = with_penalty * inverse[2];
  }

  void turn(int a) {
    const T theta[3] = {n.turn[a].theta[0], n.turn[a].theta[1], n.turn[a].theta[2]};
    view.small ? n.turn[a].turn_linearly(theta, n.d[a]) : n.turn[a].turn(theta, n.d[a]);
  }

  void place(int a) {
    const T half(view.small ? 0.0 : 0.5), whole(view.small ? 0.0 : 1.0);
    for (int i = 0; i < 3; ++i) {
      mid_x[a][i] = n.x[a][i] + half * n.u[a][i], mid_d[a][i] = n.d[a][i] + half * n.turn[a].change[i];
      end_x[a][i] = n.x[a][i] + whole * n.u[a][i], end_d[a][i] = n.d[a][i] + whole * n.turn[a].change[i];
    }
  }

  // Force and stiffness (null: not wanted) by positions and directors
  ShellFailure run_points(double penalty, T force[freedoms], T (*K)[freedoms]) const {
    for (int i = 0; i < freedoms; ++i) {
      force[i] = T(0.0);
      for (int j = 0; K && j < freedoms; ++j) K[i][j] = T(0.0);
    }
    for (int q = 0; q < n_points; ++q) {
      typename Kernel::Surface surface;
      typename Kernel::Gradient gradient;
      typename Kernel::Strain strain;
      typename Kernel::Resultants sum;
      T a[2][3], b[2][3], shear[2], D[2][2];
      auto folded = Kernel::measure_surface(forms, q, n, surface) | Kernel::base_vectors(table, q, end_x, end_d, a, b);
      if (auto bad = find(folded, ShellFault::inside_out); bad.cell >= 0) return bad;
      Kernel::differentiate(forms, q, mid_x, mid_d, gradient);
      Kernel::measure(gradient, n, strain);
      clear(sum);
      if (auto bad = run_layers(q, surface, strain, K != nullptr, sum); bad.cell >= 0) return bad;
      run_shear(q, surface, strain.shear, penalty, shear, D);
      Kernel::differentiate(forms, q, end_x, end_d, gradient);
      Kernel::add_force(gradient, sum, shear, force);
      if (K) Kernel::add_stiffness(forms, q, gradient, sum, shear, D, !view.small, K);
    }
    return {};
  }

  // The same with the bubble in balance and condensed, for nodes 1 to 3. The bubble does not feel the penalty.
  ShellFailure run_bubble(T force[freedoms], T K[freedoms][freedoms]) {
    Bubble<T> bubble;
    bubble.small = view.small;
    load(view.internal_n, 1, 0, internal_values, bubble.q_n);
    for (int k = 0; k < 2; ++k) bubble.q[k] = bubble.q_n[k];
    for (int i = 0; i < 3; ++i) n.x[mesh_nodes][i] = n.u[mesh_nodes][i] = T(0.0);
    bubble.span(n.x, n.u);
    auto run = [&](double penalty) {
      bubble.direct(n.d[mesh_nodes], n.turn[mesh_nodes].change);
      place(mesh_nodes);
      auto failure = run_points(penalty, force, K);
      bubble.reduce(force, K);
      return failure;
    };
    typename Bubble<T>::Coupling coupling;
    for (int step = 0;; ++step) {
      if (auto bad = run(0.0); bad.cell >= 0) return bad;
      coupling = bubble.couple(force, K);
      Bubble<T> next = bubble;
      const auto moving = find(!(next.step(coupling) < T(bubble_tolerance * bubble_tolerance)), ShellFault::bubble);
      if (moving.cell < 0) break;
      if (step == bubble_steps) return moving;
      bubble = next;
    }
    save(bubble.q, 1, 0, internal_values, view.internal);
    if (view.stiffness && view.penalty > 0.0)
      if (auto bad = run(view.penalty); bad.cell >= 0) return bad;
    bubble.condense(coupling, force, K);
    return {};
  }

  ShellFailure evaluate() {
    forms.fit(undeformed);
    // 1. directors, and the configuration half-way and at the end
    T turned(0.0);
    for (int a = 0; a < mesh_nodes; ++a) {
      turn(a);
      turned = larger(turned, n.turn[a].s);
      place(a);
    }
    if (auto bad = find(!(turned < T(largest_turn_squared)), ShellFault::turned_too_far); bad.cell >= 0) return bad;

    // 2. point by point
    T force[freedoms], matrix[freedoms][freedoms];
    T(*K)[freedoms] = view.stiffness ? matrix : nullptr;
    ShellFailure failure;
    if constexpr (Kernel::has_bubble)
      failure = run_bubble(force, matrix);
    else
      failure = run_points(view.penalty, force, K);
    if (failure.cell >= 0) return failure;

    // 3. from directors to rotations, and out
    Kernel::take_rotations(n, force, K, view.small);
    write(force, K);
    return {};
  }

  static void clear(typename Kernel::Resultants& sum) {
    for (auto& row : sum.S)
      for (auto& s : row) s = T(0.0);
    for (int p = 0; p < 3; ++p)
      for (int c = 0; c < 3; ++c) sum.thickness[p][c] = sum.area[p][c] = T(0.0);
    for (auto& matrix : sum.C)
      for (auto& row : matrix)
        for (auto& c : row) c = T(0.0);
  }

  void write(const T* force, const T (*K)[freedoms]) const {
    auto put = [this](double* array, std::size_t per_pack, std::size_t index, const T& value) {
      for (int lane = 0; lane < width; ++lane) {
        const int slot = first + lane, pack = slot / pack_width;
        array[(pack * per_pack + index) * pack_width + slot % pack_width] = lanes::get(value, lane);
      }
    };
    constexpr int rows = 6 * mesh_nodes;
    for (int i = 0; i < rows; ++i) put(view.force, rows, i, force[i]);
    if (!K) return;
    for (int i = 0; i < rows; ++i)
      for (int j = 0; j < rows; ++j)
        put(view.stiffness, rows * rows, i * rows + j, view.symmetric ? T(0.5) * (K[i][j] + K[j][i]) : K[i][j]);
  }

  static ShellFailure evaluate_pack(const ShellView& view, const ShellLaw& law, int pack) {
    return ShellPack(view, law, pack).evaluate();
  }
};

}  // namespace presswork
