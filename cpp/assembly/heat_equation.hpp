// SPDX-License-Identifier: Apache-2.0
// One time step of the heat equation by backward Euler and Newton's method (docs/theory/heat.md):
//
//   (H(T) - H(T_n)) / dt + K(T) T = power of the films + sources
//
// H is the heat content of the lumped masses, so that what a step stores is what flows in, to the tolerance of the
// iteration, however the specific heat depends on temperature. Newton's matrix of the first guess serves for all
// corrections as long as it brings each of them near. Corrections come from conjugate gradients where these find them
// quickly, as in short time steps, else from a direct solver.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "assembly/assembler.hpp"
#include "assembly/heat_films.hpp"
#include "element/heat_block.hpp"
#include "element/heat_storage.hpp"

namespace presswork {

// Cells of one kind and material.
struct HeatBody {
  const HeatCellType* type;
  std::vector<int> connectivity;     // (n_cells, nodes)
  std::vector<double> conductivity;  // rows of a TemperatureTable [N/(s K)]
  std::vector<double> piece;         // rows of a HeatContent
  double latent, start, end;         // of a HeatContent
  std::vector<double> mass;          // at the nodes (n_points) [t]

  int n_cells() const { return static_cast<int>(connectivity.size()) / type->nodes; }
};

struct HeatStepInput {
  const double* points;         // (n_points, d), where the nodes are at the end [mm]
  const double* temperature_n;  // (n_points) [degrees C]
  double dt;                    // [s]
  std::vector<const HeatFilm*> films;
  const std::uint8_t* mask;  // nodes whose temperature is prescribed
  const double* prescribed;  // their temperatures
  const double* source;      // heat made at the nodes (n_points) [N mm/s], or null
  int counted;               // the heat of so many first nodes and that of the others is counted apart
  bool iterative;            // whether conjugate gradients are tried first
};

enum class HeatOutcome { converged, unbounded, singular, no_balance, turned_cell };

struct HeatStepResult {
  HeatOutcome outcome = HeatOutcome::no_balance;
  std::vector<double> temperature;           // (n_points) [degrees C]
  std::vector<std::array<double, 2>> power;  // of each film, then of prescribed temperatures [N mm/s]
  std::vector<double> residual, correction;  // of every iteration: over all flows; largest [K]
  double assembly_seconds = 0, solve_seconds = 0;
  int block = 0, cell = 0;  // that is turned inside out
};

// Fills change (n_points), the solution of the matrix with `data` (nnz) and of `rhs`. fresh: the matrix is another than
// that of the call before. Returns false for a singular one.
using DirectSolver = std::function<bool(bool fresh, const std::vector<double>& data, const std::vector<double>& rhs,
                                        std::vector<double>& change)>;

class HeatEquation {
 public:
  HeatEquation(int n_points, std::vector<HeatBody> bodies, const SolidSection& section);

  int n_points() const { return n_points_; }
  int dimension() const { return bodies_.front().type->dim; }

  // Heat stored at the nodes (n_points) [N mm] and its derivative [N mm/K]; its zero is arbitrary.
  void find_content(const double* temperature, double* content, double* slope) const;

  // From a guess at the temperatures (n_points). The assembler has the pairs of cells and of films.
  HeatStepResult solve(const Assembler<1>& assembler, const HeatStepInput& input, const double* guess,
                       const DirectSolver& direct);

 private:
  struct Balance;

  bool evaluate(const Assembler<1>& assembler, const HeatStepInput& input, bool with_matrix, HeatStepResult& result);
  void assemble(const Assembler<1>& assembler, const HeatStepInput& input);
  bool correct(const Assembler<1>& assembler, const HeatStepInput& input, const DirectSolver& direct, double accuracy);
  void count(const HeatStepInput& input, HeatStepResult& result) const;

  int n_points_;
  std::vector<HeatBody> bodies_;
  SolidSection section_;
  // of the last evaluation: cells in packs, nodes, matrix
  std::vector<std::vector<double>> cell_flow_, cell_conduction_;
  std::vector<double> content_n_, content_, diagonal_, flow_, power_, residual_, rhs_, change_, data_;
  double largest_ = 0;  // sum of all flows [N mm/s]
  bool fresh_ = false;  // whether the direct solver has not seen the matrix
  std::vector<std::uint8_t> turned_;
  std::vector<double> frames_;
};

}  // namespace presswork
