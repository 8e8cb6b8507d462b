// SPDX-License-Identifier: Apache-2.0
#include "assembly/heat_equation.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "assembly/krylov.hpp"

namespace presswork {

namespace {

constexpr int most_iterations = 25;
constexpr double balanced = 1e-11;  // largest out-of-balance over the sum of all heat flows
constexpr double worn = 1e-2;       // part of what is out of balance that a correction leaves at most if its matrix
                                    // is to serve again
constexpr double inexact = 1e-7;    // largest residual of a correction found by iterations, over what is out of balance
constexpr double finest = 1e-12;    // smallest
constexpr int most_inner = 80;      // such iterations beyond which factors are cheaper
constexpr double correction =
    1e-10;  // largest correction [K] over the largest temperature: nothing smaller is worth one

class Watch {
 public:
  explicit Watch(double& seconds) : seconds_(seconds), started_(std::chrono::steady_clock::now()) {}
  ~Watch() { seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - started_).count(); }

 private:
  double& seconds_;
  std::chrono::steady_clock::time_point started_;
};

double sum_absolute(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double v : values) sum += std::abs(v);
  return sum;
}

double find_largest(const std::vector<double>& values) {
  double largest = 0.0;
  for (const double v : values) largest = std::max(largest, std::abs(v));
  return largest;
}

void add_to_diagonal(const Assembler<1>& assembler, const std::vector<double>& diagonal, std::vector<double>& data) {
  const auto &indptr = assembler.indptr(), &indices = assembler.indices();
  for (int i = 0; i < assembler.n_nodes(); ++i)
    for (int k = indptr[i]; k < indptr[i + 1]; ++k)
      if (indices[k] == i) {
        data[k] += diagonal[i];
        break;
      }
}

}  // namespace

HeatEquation::HeatEquation(int n_points, std::vector<HeatBody> bodies, const SolidSection& section)
    : n_points_(n_points), bodies_(std::move(bodies)), section_(section) {
  for (const auto& body : bodies_) {
    const std::size_t packs = (body.n_cells() + pack_width - 1) / pack_width, nodes = body.type->nodes;
    cell_flow_.emplace_back(packs * nodes * pack_width);
    cell_conduction_.emplace_back(packs * nodes * nodes * pack_width);
  }
  for (auto* nodal : {&content_n_, &content_, &diagonal_, &flow_, &power_, &residual_, &rhs_, &change_})
    nodal->resize(n_points);
  turned_.assign(n_points, 0);
  frames_.assign(n_points, 1.0);
}

void HeatEquation::find_content(const double* temperature, double* content, double* slope) const {
  std::fill_n(content, n_points_, 0.0);
  std::fill_n(slope, n_points_, 0.0);
  for (const auto& body : bodies_) {
    const HeatContent table{body.piece.data(), static_cast<int>(body.piece.size()) / HeatContent::columns, body.latent,
                            body.start, body.end};
    for (int a = 0; a < n_points_; ++a) {
      if (body.mass[a] == 0.0) continue;
      double stored, specific;
      table.find(temperature[a], stored, specific);
      content[a] += body.mass[a] * stored;
      slope[a] += body.mass[a] * specific;
    }
  }
}

// Fill what is out of balance at result.temperature, the sum of all flows, and the part of the matrix's diagonal that
// storage and films give. False for a cell turned inside out.
bool HeatEquation::evaluate(const Assembler<1>& assembler, const HeatStepInput& input, bool with_matrix,
                            HeatStepResult& result) {
  const Watch watch(result.assembly_seconds);
  const double* temperature = result.temperature.data();
  std::vector<const double*> flows;
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const auto& body = bodies_[i];
    const HeatBlock block{body.n_cells(), body.connectivity.data(), input.points, section_};
    const TemperatureTable table{body.conductivity.data(),
                                 static_cast<int>(body.conductivity.size()) / TemperatureTable::columns};
    const int failed = conduct_heat(*body.type, block, table, temperature, cell_flow_[i].data(),
                                    with_matrix ? cell_conduction_[i].data() : nullptr);
    if (failed >= 0) {
      result.outcome = HeatOutcome::turned_cell, result.block = static_cast<int>(i), result.cell = failed;
      return false;
    }
    flows.push_back(cell_flow_[i].data());
  }
  assembler.assemble_vector(flows, flow_.data());
  find_content(temperature, content_.data(), diagonal_.data());
  for (int a = 0; a < n_points_; ++a) {
    const double stored = (content_[a] - content_n_[a]) / input.dt;
    residual_[a] = stored + flow_[a] - (input.source ? input.source[a] : 0.0);
    diagonal_[a] /= input.dt;
    power_[a] = stored;
  }
  largest_ = sum_absolute(power_) + sum_absolute(flow_);
  for (const auto* film : input.films) {
    std::fill(power_.begin(), power_.end(), 0.0);
    std::visit([&](const auto& f) { f.add(temperature, power_.data(), diagonal_.data()); }, *film);
    for (int a = 0; a < n_points_; ++a) residual_[a] -= power_[a];
    largest_ += sum_absolute(power_);
  }
  return true;
}

// Fill the derivative of what was out of balance last, prescribed temperatures held.
void HeatEquation::assemble(const Assembler<1>& assembler, const HeatStepInput& input) {
  data_.assign(assembler.indices().size(), 0.0);
  std::vector<const double*> conduction;
  for (const auto& block : cell_conduction_) conduction.push_back(block.data());
  assembler.assemble_matrix(conduction, turned_.data(), frames_.data(), data_.data());
  add_to_diagonal(assembler, diagonal_, data_);
  for (const auto* film : input.films) {
    const auto* across = std::get_if<PairFilm>(film);
    if (!across) continue;
    std::vector<int> pairs = across->pairs;
    for (std::size_t i = 0; i < across->factor.size(); ++i)
      pairs.insert(pairs.end(), {across->pairs[2 * i + 1], across->pairs[2 * i]});
    std::vector<double> entries;
    for (int side = 0; side < 2; ++side)
      for (const double f : across->factor) entries.push_back(-f);
    assembler.add_blocks(static_cast<int>(entries.size()), pairs.data(), entries.data(), turned_.data(), frames_.data(),
                         data_.data());
  }
  const double scale = find_largest(diagonal_);
  const std::vector<double> none(n_points_, 0.0);
  std::fill(rhs_.begin(), rhs_.end(), 0.0);
  assembler.constrain(input.mask, none.data(), scale > 0.0 ? scale : 1.0, data_.data(), rhs_.data());
  fresh_ = true;
}

// Fill Newton's correction; accuracy: residual over that before. False for a singular matrix.
bool HeatEquation::correct(const Assembler<1>& assembler, const HeatStepInput& input, const DirectSolver& direct,
                           double accuracy) {
  for (int a = 0; a < n_points_; ++a) rhs_[a] = input.mask[a] ? 0.0 : -residual_[a];
  if (input.iterative) {
    const SparseMatrix matrix{n_points_, assembler.indptr().data(), assembler.indices().data(), data_.data(),
                              assembler.symmetric()};
    const double tolerance = std::clamp(accuracy, finest, inexact);
    if (solve_iteratively(matrix, rhs_.data(), tolerance, most_inner, change_.data())) return true;
  }
  const bool solved = direct(fresh_, data_, rhs_, change_);
  fresh_ = false;
  return solved;
}

// Fill the heat that flows in, by film and by prescribed temperatures.
void HeatEquation::count(const HeatStepInput& input, HeatStepResult& result) const {
  std::vector<double> power(n_points_), slope(n_points_);
  const auto apart = [&](const std::vector<double>& flow) {
    std::array<double, 2> sums{0.0, 0.0};
    for (int a = 0; a < n_points_; ++a) sums[a >= input.counted] += flow[a];
    return sums;
  };
  for (const auto* film : input.films) {
    std::fill(power.begin(), power.end(), 0.0);
    std::visit([&](const auto& f) { f.add(result.temperature.data(), power.data(), slope.data()); }, *film);
    result.power.push_back(apart(power));
  }
  for (int a = 0; a < n_points_; ++a) power[a] = input.mask[a] ? residual_[a] : 0.0;
  result.power.push_back(apart(power));
}

HeatStepResult HeatEquation::solve(const Assembler<1>& assembler, const HeatStepInput& input, const double* guess,
                                   const DirectSolver& direct) {
  HeatStepResult result;
  result.temperature.resize(n_points_);
  for (int a = 0; a < n_points_; ++a) result.temperature[a] = input.mask[a] ? input.prescribed[a] : guess[a];
  find_content(input.temperature_n, content_n_.data(), diagonal_.data());
  bool finished = false, has_matrix = false;
  const auto end = [&](HeatOutcome outcome) {
    result.outcome = outcome;
    return result;
  };
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    if (!evaluate(assembler, input, !has_matrix, result)) return result;
    double out = 0.0;
    for (int a = 0; a < n_points_; ++a)
      if (!input.mask[a]) out += std::abs(residual_[a]);
    if (!std::isfinite(out)) return end(HeatOutcome::unbounded);
    if (finished || out <= balanced * largest_) {
      count(input, result);
      return end(HeatOutcome::converged);
    }
    const double relative = out / largest_;
    if (has_matrix && relative > worn * result.residual.back()) {
      evaluate(assembler, input, true, result);
      has_matrix = false;
    }
    if (!has_matrix) {
      const Watch watch(result.assembly_seconds);
      assemble(assembler, input);
      has_matrix = true;
    }
    {
      const Watch watch(result.solve_seconds);
      if (!correct(assembler, input, direct, 0.1 * balanced / relative)) return end(HeatOutcome::singular);
    }
    for (int a = 0; a < n_points_; ++a) result.temperature[a] += change_[a];
    result.residual.push_back(relative);
    result.correction.push_back(find_largest(change_));
    finished = result.correction.back() <= correction * std::max(1.0, find_largest(result.temperature));
  }
  return end(HeatOutcome::no_balance);
}

}  // namespace presswork
