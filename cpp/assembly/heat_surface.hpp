// SPDX-License-Identifier: Apache-2.0
// Where the surface of bodies touches a tool or is near it, as heat passes.
//
// An edge touches a tool if the tool holds both its ends, a face if it holds all its corners. Across a gap the
// conductance at no pressure falls evenly with the distance, to nothing at a width; the part that passes is taken off
// what the surroundings see of the surface.
#pragma once

#include <cstdint>
#include <vector>

#include "contact/facing.hpp"
#include "element/heat_conduction.hpp"

namespace presswork {

struct SurfaceEdges {
  int n, nodes, n_points;
  int corners;          // 2 of edges, 3 or 4 of faces in space
  const int* edges;     // (n, nodes), corners first
  const double* areas;  // that each node of each edge stands for (n, nodes) [mm2]
};

struct HeatingTool {
  const std::uint8_t* holds;     // whether it touches a node (n_points)
  const double* push;            // on the nodes, along the normal (n_points) [N]
  const double* gap;             // distance of the nodes (n_points) [mm]
  TemperatureTable conductance;  // by pressure [MPa], [N/(mm s K)]
  double width;                  // across which heat passes [mm]
};

struct Touch {
  std::vector<std::uint8_t> touching;     // edges (n)
  std::vector<double> pressure;           // at the nodes of edges that touch (n_points) [MPa]
  std::vector<int> nodes;                 // that the tool touches or is near
  std::vector<double> area, conductance;  // of these nodes [mm2], [N/(mm s K)]
};

// seen (n, nodes): loses what touches and what passes.
Touch find_touch(const SurfaceEdges& surface, const HeatingTool& tool, double* seen);

// Pairs of nodes, each once and in order, and the sums over them of amounts at points of facing sides (n_found). Each
// point shares its amounts among the nodes of both sides, edges or faces, by their shape functions.
struct PairSums {
  std::vector<int> pairs;                 // (n, 2)
  std::vector<std::vector<double>> sums;  // of each amount (n)
};

struct FacingPoints {
  int n, nodes;                           // of points; of a side: 2 of edges, 3 or 4 of faces
  const int *own, *other;                 // sides
  const double *own_shape, *other_shape;  // (n, nodes)
};

PairSums sum_pairs(const FacingPoints& found, const int* own, const int* other,
                   const std::vector<const double*>& amounts);

// What passes between a surface and the profile of a tool with a mesh, over the pairs of nodes that face each other:
// sums of conductance times area [N mm/(s K)], and of area [mm2].
//
// Both are chords of the profile, so that a piece that touches it faces it within `chords` of its length; where it is
// near the distance is that of the nodes from the exact profile. touching (n_edges): of the edges, whose pieces are
// numbered through n_edges after n_edges; pressure (n_points) [MPa]; thickness as find_facing has it.
struct MeshedTool {
  Edges profile;
  const double* gap;             // distance of the nodes (n_points) [mm]
  TemperatureTable conductance;  // by pressure [MPa], [N/(mm s K)]
  double width;                  // across which heat passes [mm]
};
PairSums link_tool(const double* points, Edges pieces, const bool* touching, int n_edges, const double* pressure,
                   const MeshedTool& tool, double chords, double thickness);

}  // namespace presswork
