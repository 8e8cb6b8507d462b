// SPDX-License-Identifier: Apache-2.0
// Films of heat: what heats and cools the surface of bodies, lumped at its nodes.
//
// A film adds the heat that it gives to the nodes [N mm/s] at their temperatures [degrees C], and minus its derivative
// by the temperature of the same node [N mm/(s K)]. Of a film between nodes the derivative by the other one is minus
// its factor.
#pragma once

#include <algorithm>
#include <cmath>
#include <variant>
#include <vector>

#include "element/heat_conduction.hpp"

namespace presswork {

// Nodes that each exchange heat with a temperature of its own, in proportion to the difference.
struct NodeFilm {
  std::vector<int> nodes;
  std::vector<double> factor, other;  // [N mm/(s K)], [degrees C]

  int n_nodes() const { return nodes.empty() ? 0 : *std::max_element(nodes.begin(), nodes.end()) + 1; }
  void add(const double* temperature, double* power, double* slope) const {
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const int a = nodes[i];
      power[a] += factor[i] * (other[i] - temperature[a]);
      slope[a] += factor[i];
    }
  }
};

// Newton's law of cooling with a coefficient that may depend on temperature.
struct ConvectionFilm {
  std::vector<double> area;         // that each node stands for [mm2]
  std::vector<double> coefficient;  // rows of a TemperatureTable [N/(mm s K)]
  double ambient;

  int n_nodes() const { return static_cast<int>(area.size()); }
  void add(const double* temperature, double* power, double* slope) const {
    const TemperatureTable table{coefficient.data(), static_cast<int>(coefficient.size()) / TemperatureTable::columns};
    for (std::size_t a = 0; a < area.size(); ++a) {
      if (area[a] == 0.0) continue;
      double h, change;
      table.find(temperature[a], h, change);
      const double excess = temperature[a] - ambient;
      power[a] -= area[a] * h * excess;
      slope[a] += area[a] * (h + change * excess);
    }
  }
};

// Stefan and Boltzmann's law between a grey surface and large surroundings.
struct RadiationFilm {
  static constexpr double zero_celsius = 273.15;
  std::vector<double> factor;  // area times emissivity times their constant, by node [N mm/(s K4)]
  double ambient;

  int n_nodes() const { return static_cast<int>(factor.size()); }
  void add(const double* temperature, double* power, double* slope) const {
    const double around = ambient + zero_celsius, fourth = around * around * around * around;
    for (std::size_t a = 0; a < factor.size(); ++a) {
      if (factor[a] == 0.0) continue;
      const double kelvin = temperature[a] + zero_celsius, cube = kelvin * kelvin * kelvin;
      power[a] -= factor[a] * (cube * kelvin - fourth);
      slope[a] += 4 * factor[a] * cube;
    }
  }
};

// Heat that does not depend on temperature.
struct FluxFilm {
  std::vector<double> given;  // by node [N mm/s]

  int n_nodes() const { return static_cast<int>(given.size()); }
  void add(const double*, double* power, double*) const {
    for (std::size_t a = 0; a < given.size(); ++a) power[a] += given[a];
  }
};

// Conductance between two nodes each.
struct PairFilm {
  std::vector<int> pairs;      // (n, 2)
  std::vector<double> factor;  // [N mm/(s K)]

  int n_nodes() const { return pairs.empty() ? 0 : *std::max_element(pairs.begin(), pairs.end()) + 1; }
  void add(const double* temperature, double* power, double* slope) const {
    for (std::size_t i = 0; i < factor.size(); ++i) {
      const int a = pairs[2 * i], b = pairs[2 * i + 1];
      const double flow = factor[i] * (temperature[a] - temperature[b]);
      power[a] -= flow, power[b] += flow;
      slope[a] += factor[i], slope[b] += factor[i];
    }
  }
};

// Martensite that austenite becomes below `start`, free (1 - exp(-rate (start - T))), and never less than before
// (Koistinen & Marburger 1959).
struct MartensiteFilm {
  std::vector<int> nodes;
  std::vector<double> heat, free, before;  // set free by all of a node in the step [N mm/s]; fractions
  double start, rate;                      // [degrees C], [1/K]

  int n_nodes() const { return nodes.empty() ? 0 : *std::max_element(nodes.begin(), nodes.end()) + 1; }
  void add(const double* temperature, double* power, double* slope) const {
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const double below = start - temperature[nodes[i]];
      if (below <= 0.0) continue;
      const double left = std::exp(-rate * below), formed = free[i] * (1.0 - left);
      if (formed < before[i]) continue;
      power[nodes[i]] += heat[i] * (formed - before[i]);
      slope[nodes[i]] += heat[i] * rate * free[i] * left;
    }
  }
};

using HeatFilm = std::variant<NodeFilm, ConvectionFilm, RadiationFilm, FluxFilm, PairFilm, MartensiteFilm>;

}  // namespace presswork
