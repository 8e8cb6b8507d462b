// SPDX-License-Identifier: Apache-2.0
#include "assembly/assembler.hpp"

#include <algorithm>
#include <stdexcept>

#include "tensor/pack.hpp"

namespace presswork {

namespace {

// Index of entry (row, column) of a cell's matrix in the packed array; the lanes of one entry lie side by side.
std::int64_t packed_index(int cell, int freedoms, int row, int column) {
  const std::int64_t pack = cell / pack_width;
  return ((pack * freedoms + row) * freedoms + column) * pack_width + cell % pack_width;
}

// Q K Q^T of a 2x2 block, with the frame of its row on the left and of its column on the right.
void turn_block(const double* row_frame, const double* column_frame, double k[4]) {
  if (row_frame) {
    const double* q = row_frame;
    const double a = q[0] * k[0] + q[1] * k[2], b = q[0] * k[1] + q[1] * k[3];
    const double c = q[2] * k[0] + q[3] * k[2], d = q[2] * k[1] + q[3] * k[3];
    k[0] = a, k[1] = b, k[2] = c, k[3] = d;
  }
  if (column_frame) {
    const double* q = column_frame;
    const double a = k[0] * q[0] + k[1] * q[1], b = k[0] * q[2] + k[1] * q[3];
    const double c = k[2] * q[0] + k[3] * q[1], d = k[2] * q[2] + k[3] * q[3];
    k[0] = a, k[1] = b, k[2] = c, k[3] = d;
  }
}

const double* frame_of(int node, const std::uint8_t* turned, const double* frames) {
  return turned[node] ? frames + 4 * static_cast<std::int64_t>(node) : nullptr;
}

}  // namespace

Assembler::Assembler(int n_nodes, const std::vector<BlockConnectivity>& blocks, bool symmetric, int n_couplings,
                     const int* couplings)
    : n_nodes_(n_nodes), symmetric_(symmetric) {
  build_pairs(blocks, n_couplings, couplings);
  build_csr();
  for (const auto& block : blocks) build_sources(block);
}

void Assembler::build_pairs(const std::vector<BlockConnectivity>& blocks, int n_couplings, const int* couplings) {
  std::vector<std::vector<int>> columns(n_nodes_);
  for (int i = 0; i < n_nodes_; ++i) columns[i].push_back(i);
  for (const auto& block : blocks)
    for (int e = 0; e < block.n_cells; ++e) {
      const int* cell = block.connectivity + static_cast<std::int64_t>(e) * block.nodes;
      for (int a = 0; a < block.nodes; ++a)
        for (int b = 0; b < block.nodes; ++b)
          if (!symmetric_ || cell[b] >= cell[a]) columns[cell[a]].push_back(cell[b]);
    }
  for (int i = 0; i < n_couplings; ++i) {
    const int a = couplings[2 * i], b = couplings[2 * i + 1];
    if (!symmetric_ || b >= a) columns[a].push_back(b);
    if (!symmetric_ || a >= b) columns[b].push_back(a);
  }
  pair_start_.assign(n_nodes_ + 1, 0);
  for (int i = 0; i < n_nodes_; ++i) {
    auto& c = columns[i];
    std::sort(c.begin(), c.end());
    c.erase(std::unique(c.begin(), c.end()), c.end());
    pair_start_[i + 1] = pair_start_[i] + static_cast<std::int64_t>(c.size());
  }
  pair_column_.reserve(pair_start_[n_nodes_]);
  for (const auto& c : columns) pair_column_.insert(pair_column_.end(), c.begin(), c.end());
}

void Assembler::build_csr() {
  indptr_.assign(2 * n_nodes_ + 1, 0);
  for (int i = 0; i < n_nodes_; ++i) {
    const int pairs = static_cast<int>(pair_start_[i + 1] - pair_start_[i]);
    indptr_[2 * i + 1] = indptr_[2 * i] + 2 * pairs;
    indptr_[2 * i + 2] = indptr_[2 * i + 1] + 2 * pairs - (symmetric_ ? 1 : 0);
  }
  indices_.resize(indptr_.back());
  for (int i = 0; i < n_nodes_; ++i)
    for (int r = 0; r < 2; ++r) {
      int at = indptr_[2 * i + r];
      for (auto p = pair_start_[i]; p < pair_start_[i + 1]; ++p)
        for (int c = 0; c < 2; ++c)
          if (!(symmetric_ && pair_column_[p] == i && c < r)) indices_[at++] = 2 * pair_column_[p] + c;
    }
}

std::int64_t Assembler::find_pair(int row, int column) const {
  const auto first = pair_column_.begin() + pair_start_[row], last = pair_column_.begin() + pair_start_[row + 1];
  const auto it = std::lower_bound(first, last, column);
  return it != last && *it == column ? it - pair_column_.begin() : -1;
}

void Assembler::build_sources(const BlockConnectivity& block) {
  if (packed_index(block.n_cells, 2 * block.nodes, 0, 0) > UINT32_MAX)
    throw std::length_error("a block of cells is too large for 32-bit offsets: split it");
  const int n = block.nodes, freedoms = 2 * n;
  const std::int64_t n_pairs = pair_start_[n_nodes_], per_cell = static_cast<std::int64_t>(n) * n;
  std::vector<std::int64_t> pair_of(block.n_cells * per_cell, -1);
  PairSources pairs;
  pairs.freedoms = freedoms;
  pairs.start.assign(n_pairs + 1, 0);
  NodeSources nodes;
  nodes.start.assign(n_nodes_ + 1, 0);
  for (int e = 0; e < block.n_cells; ++e) {
    const int* cell = block.connectivity + static_cast<std::int64_t>(e) * n;
    for (int a = 0; a < n; ++a) {
      ++nodes.start[cell[a] + 1];
      for (int b = 0; b < n; ++b) {
        if (symmetric_ && cell[b] < cell[a]) continue;
        const auto p = find_pair(cell[a], cell[b]);
        pair_of[e * per_cell + a * n + b] = p;
        ++pairs.start[p + 1];
      }
    }
  }
  for (std::int64_t p = 0; p < n_pairs; ++p) pairs.start[p + 1] += pairs.start[p];
  for (int i = 0; i < n_nodes_; ++i) nodes.start[i + 1] += nodes.start[i];
  pairs.source.resize(pairs.start.back());
  nodes.source.resize(nodes.start.back());
  auto pair_fill = pairs.start;
  auto node_fill = nodes.start;
  for (int e = 0; e < block.n_cells; ++e) {
    const int* cell = block.connectivity + static_cast<std::int64_t>(e) * n;
    for (int a = 0; a < n; ++a) {
      nodes.source[node_fill[cell[a]]++] = (e / pack_width * freedoms + 2 * a) * pack_width + e % pack_width;
      for (int b = 0; b < n; ++b) {
        const auto p = pair_of[e * per_cell + a * n + b];
        if (p >= 0) pairs.source[pair_fill[p]++] = static_cast<std::uint32_t>(packed_index(e, freedoms, 2 * a, 2 * b));
      }
    }
  }
  pair_sources_.push_back(std::move(pairs));
  node_sources_.push_back(std::move(nodes));
}

void Assembler::store_pair(std::int64_t pair, int row, int column, const double k[4], double* data, bool add) const {
  const std::int64_t offset = 2 * (pair - pair_start_[row]);
  auto put = [&](std::int64_t at, double value) { data[at] = add ? data[at] + value : value; };
  put(indptr_[2 * row] + offset, k[0]);
  put(indptr_[2 * row] + offset + 1, k[1]);
  if (!symmetric_) {
    put(indptr_[2 * row + 1] + offset, k[2]);
    put(indptr_[2 * row + 1] + offset + 1, k[3]);
  } else {  // the second row has lost its first entry
    if (column != row) put(indptr_[2 * row + 1] + offset - 1, k[2]);
    put(indptr_[2 * row + 1] + offset, k[3]);
  }
}

void Assembler::assemble_matrix(const std::vector<const double*>& stiffness, const std::uint8_t* turned,
                                const double* frames, double* data) const {
#pragma omp parallel for schedule(static)
  for (int row = 0; row < n_nodes_; ++row)
    for (auto p = pair_start_[row]; p < pair_start_[row + 1]; ++p) {
      double k[4] = {0, 0, 0, 0};
      for (std::size_t block = 0; block < stiffness.size(); ++block) {
        const auto& sources = pair_sources_[block];
        const std::int64_t next_row = static_cast<std::int64_t>(sources.freedoms) * pack_width;
        for (auto s = sources.start[p]; s < sources.start[p + 1]; ++s) {
          const double* entry = stiffness[block] + sources.source[s];
          k[0] += entry[0];
          k[1] += entry[pack_width];
          k[2] += entry[next_row];
          k[3] += entry[next_row + pack_width];
        }
      }
      const int column = pair_column_[p];
      turn_block(frame_of(row, turned, frames), frame_of(column, turned, frames), k);
      store_pair(p, row, column, k, data, false);
    }
}

void Assembler::add_blocks(int n, const int* pairs, const double* blocks, const std::uint8_t* turned,
                           const double* frames, double* data) const {
  for (int i = 0; i < n; ++i) {
    const int row = pairs[2 * i], column = pairs[2 * i + 1];
    if (symmetric_ && column < row) continue;
    const auto p = find_pair(row, column);
    if (p < 0) continue;
    double k[4] = {blocks[4 * i], blocks[4 * i + 1], blocks[4 * i + 2], blocks[4 * i + 3]};
    turn_block(frame_of(row, turned, frames), frame_of(column, turned, frames), k);
    store_pair(p, row, column, k, data, true);
  }
}

void Assembler::assemble_vector(const std::vector<const double*>& element_force, double* force) const {
#pragma omp parallel for schedule(static) if (n_nodes_ > 5000)
  for (int node = 0; node < n_nodes_; ++node) {
    double fx = 0, fy = 0;
    for (std::size_t block = 0; block < element_force.size(); ++block) {
      const auto& sources = node_sources_[block];
      for (auto s = sources.start[node]; s < sources.start[node + 1]; ++s) {
        const double* entry = element_force[block] + sources.source[s];
        fx += entry[0];
        fy += entry[pack_width];
      }
    }
    force[2 * node] = fx;
    force[2 * node + 1] = fy;
  }
}

void Assembler::constrain(const std::uint8_t* mask, const double* value, double scale, double* data,
                          double* rhs) const {
  const int n = 2 * n_nodes_;
  // columns of prescribed freedoms leave the free rows
#pragma omp parallel for schedule(static) if (n_nodes_ > 5000)
  for (int row = 0; row < n; ++row) {
    if (mask[row]) continue;
    for (int at = indptr_[row]; at < indptr_[row + 1]; ++at) {
      const int column = indices_[at];
      if (!mask[column]) continue;
      rhs[row] -= data[at] * value[column];
      data[at] = 0.0;
    }
  }
  // rows of prescribed freedoms; above the diagonal of a symmetric matrix they stand for columns too
  for (int row = 0; row < n; ++row) {
    if (!mask[row]) continue;
    for (int at = indptr_[row]; at < indptr_[row + 1]; ++at) {
      const int column = indices_[at];
      if (symmetric_ && !mask[column]) rhs[column] -= data[at] * value[row];
      data[at] = row == column ? scale : 0.0;
    }
    rhs[row] = scale * value[row];
  }
}

}  // namespace presswork
