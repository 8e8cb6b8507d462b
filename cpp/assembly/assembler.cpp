// SPDX-License-Identifier: Apache-2.0
#include "assembly/assembler.hpp"

#include <algorithm>
#include <stdexcept>

#include "tensor/pack.hpp"

namespace presswork {

namespace {

constexpr std::int64_t chunk_values = 4096;  // of the matrix, summed in a first-level cache
constexpr std::int64_t lead = 64;            // how many sources ahead the element arrays are fetched from memory

// Index of entry (row, column) of a cell's matrix in the packed array; the lanes of one entry lie side by side.
std::int64_t packed_index(int cell, int freedoms, int row, int column) {
  const std::int64_t pack = cell / pack_width;
  return ((pack * freedoms + row) * freedoms + column) * pack_width + cell % pack_width;
}

// A temperature has no direction.
void turn_block(const double*, const double*, double (&)[1]) {}

// Q K Q^T of a 2x2 block, with the frame of its row on the left and of its column on the right.
void turn_block(const double* row_frame, const double* column_frame, double (&k)[4]) {
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

// The same of a 3x3 block.
void turn_block(const double* row_frame, const double* column_frame, double (&k)[9]) {
  for (int c = 0; row_frame && c < 3; ++c) {
    const double old[3] = {k[c], k[3 + c], k[6 + c]};
    for (int i = 0; i < 3; ++i)
      k[3 * i + c] = row_frame[3 * i] * old[0] + row_frame[3 * i + 1] * old[1] + row_frame[3 * i + 2] * old[2];
  }
  for (int r = 0; column_frame && r < 3; ++r) {
    const double old[3] = {k[3 * r], k[3 * r + 1], k[3 * r + 2]};
    for (int i = 0; i < 3; ++i)
      k[3 * r + i] = column_frame[3 * i] * old[0] + column_frame[3 * i + 1] * old[1] + column_frame[3 * i + 2] * old[2];
  }
}

// The same of a 4x4 block whose first three rows and columns are taken in the frames.
void turn_block(const double* row_frame, const double* column_frame, double (&k)[16]) {
  for (int c = 0; row_frame && c < 4; ++c) {
    const double old[3] = {k[c], k[4 + c], k[8 + c]};
    for (int i = 0; i < 3; ++i)
      k[4 * i + c] = row_frame[3 * i] * old[0] + row_frame[3 * i + 1] * old[1] + row_frame[3 * i + 2] * old[2];
  }
  for (int r = 0; column_frame && r < 4; ++r) {
    const double old[3] = {k[4 * r], k[4 * r + 1], k[4 * r + 2]};
    for (int i = 0; i < 3; ++i)
      k[4 * r + i] = column_frame[3 * i] * old[0] + column_frame[3 * i + 1] * old[1] + column_frame[3 * i + 2] * old[2];
  }
}

// The same of a 6x6 block whose last three rows and columns are taken in the frames.
void turn_block(const double* row_frame, const double* column_frame, double (&k)[36]) {
  for (int c = 0; row_frame && c < 6; ++c) {
    const double old[3] = {k[18 + c], k[24 + c], k[30 + c]};
    for (int i = 0; i < 3; ++i)
      k[18 + 6 * i + c] = row_frame[3 * i] * old[0] + row_frame[3 * i + 1] * old[1] + row_frame[3 * i + 2] * old[2];
  }
  for (int r = 0; column_frame && r < 6; ++r) {
    const double old[3] = {k[6 * r + 3], k[6 * r + 4], k[6 * r + 5]};
    for (int i = 0; i < 3; ++i)
      k[6 * r + 3 + i] =
          column_frame[3 * i] * old[0] + column_frame[3 * i + 1] * old[1] + column_frame[3 * i + 2] * old[2];
  }
}

template <int F>
const double* frame_of(int node, const std::uint8_t* turned, const double* frames) {
  return turned[node] ? frames + F * F * static_cast<std::int64_t>(node) : nullptr;
}

}  // namespace

template <int D>
Assembler<D>::Assembler(int n_nodes, const std::vector<BlockConnectivity>& blocks, bool symmetric, int n_couplings,
                        const int* couplings)
    : n_nodes_(n_nodes), symmetric_(symmetric) {
  build_pairs(blocks, n_couplings, couplings);
  build_csr();
  build_chunks();
  for (const auto& block : blocks) build_sources(block);
}

template <int D>
void Assembler<D>::build_pairs(const std::vector<BlockConnectivity>& blocks, int n_couplings, const int* couplings) {
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

template <int D>
void Assembler<D>::build_csr() {
  indptr_.assign(D * n_nodes_ + 1, 0);
  for (int i = 0; i < n_nodes_; ++i) {
    const int pairs = static_cast<int>(pair_start_[i + 1] - pair_start_[i]);
    for (int r = 0; r < D; ++r) indptr_[D * i + r + 1] = indptr_[D * i + r] + D * pairs - (symmetric_ ? r : 0);
  }
  indices_.resize(indptr_.back());
  for (int i = 0; i < n_nodes_; ++i)
    for (int r = 0; r < D; ++r) {
      int at = indptr_[D * i + r];
      for (auto p = pair_start_[i]; p < pair_start_[i + 1]; ++p)
        for (int c = 0; c < D; ++c)
          if (!(symmetric_ && pair_column_[p] == i && c < r)) indices_[at++] = D * pair_column_[p] + c;
    }
}

template <int D>
void Assembler<D>::build_chunks() {
  chunk_start_.push_back(0);
  for (int i = 0; i < n_nodes_; ++i) {
    const auto first = pair_start_[chunk_start_.back()];
    if (pair_start_[i + 1] - first > chunk_values / (D * D) && chunk_start_.back() < i) chunk_start_.push_back(i);
    largest_chunk_ = std::max(largest_chunk_, pair_start_[i + 1] - pair_start_[chunk_start_.back()]);
  }
  chunk_start_.push_back(n_nodes_);
}

template <int D>
std::int64_t Assembler<D>::find_pair(int row, int column) const {
  const auto first = pair_column_.begin() + pair_start_[row], last = pair_column_.begin() + pair_start_[row + 1];
  const auto it = std::lower_bound(first, last, column);
  return it != last && *it == column ? it - pair_column_.begin() : -1;
}

template <int D>
void Assembler<D>::build_sources(const BlockConnectivity& block) {
  if (packed_index(block.n_cells, D * block.nodes, 0, 0) > UINT32_MAX)
    throw std::length_error("a block of cells is too large for 32-bit offsets: split it");
  const int n = block.nodes, cell_freedoms = D * n;
  const std::size_t n_chunks = chunk_start_.size() - 1;
  std::vector<std::uint32_t> chunk_of(n_nodes_);
  for (std::size_t k = 0; k < n_chunks; ++k)
    std::fill(chunk_of.begin() + chunk_start_[k], chunk_of.begin() + chunk_start_[k + 1], k);
  PairSources pairs;
  pairs.freedoms = cell_freedoms;
  pairs.start.assign(n_chunks + 1, 0);
  NodeSources nodes;
  nodes.start.assign(n_nodes_ + 1, 0);
  const auto is_stored = [&](int row, int column) { return !symmetric_ || column >= row; };
  for (int e = 0; e < block.n_cells; ++e) {
    const int* cell = block.connectivity + static_cast<std::int64_t>(e) * n;
    for (int a = 0; a < n; ++a) {
      ++nodes.start[cell[a] + 1];
      for (int b = 0; b < n; ++b) pairs.start[chunk_of[cell[a]] + 1] += is_stored(cell[a], cell[b]);
    }
  }
  for (std::size_t k = 0; k < n_chunks; ++k) pairs.start[k + 1] += pairs.start[k];
  for (int i = 0; i < n_nodes_; ++i) nodes.start[i + 1] += nodes.start[i];
  pairs.source.resize(pairs.start.back());
  pairs.pair.resize(pairs.start.back());
  nodes.source.resize(nodes.start.back());
  auto pair_fill = pairs.start;
  auto node_fill = nodes.start;
  for (int e = 0; e < block.n_cells; ++e) {
    const int* cell = block.connectivity + static_cast<std::int64_t>(e) * n;
    for (int a = 0; a < n; ++a) {
      nodes.source[node_fill[cell[a]]++] = (e / pack_width * cell_freedoms + D * a) * pack_width + e % pack_width;
      const auto chunk = chunk_of[cell[a]];
      const auto first = pair_start_[chunk_start_[chunk]];
      for (int b = 0; b < n; ++b) {
        if (!is_stored(cell[a], cell[b])) continue;
        const auto at = pair_fill[chunk]++;
        pairs.source[at] = static_cast<std::uint32_t>(packed_index(e, cell_freedoms, D * a, D * b));
        pairs.pair[at] = static_cast<std::uint32_t>(find_pair(cell[a], cell[b]) - first);
      }
    }
  }
  pair_sources_.push_back(std::move(pairs));
  node_sources_.push_back(std::move(nodes));
}

template <int D>
void Assembler<D>::store_pair(std::int64_t pair, int row, int column, const double k[D * D], double* data,
                              bool add) const {
  const std::int64_t offset = D * (pair - pair_start_[row]);
  for (int r = 0; r < D; ++r) {
    // rows of a symmetric matrix lose what is left of the diagonal: r entries of the first pair
    const int lost = symmetric_ ? r : 0;
    double* at = data + indptr_[D * row + r] + offset - lost;
    for (int c = column == row ? lost : 0; c < D; ++c) at[c] = add ? at[c] + k[D * r + c] : k[D * r + c];
  }
}

template <int D>
void Assembler<D>::assemble_matrix(const std::vector<const double*>& stiffness, const std::uint8_t* turned,
                                   const double* frames, double* data) const {
  const int n_chunks = static_cast<int>(chunk_start_.size()) - 1;
#pragma omp parallel
  {
    std::vector<double> sums(largest_chunk_ * D * D);
#pragma omp for schedule(static) nowait
    for (int chunk = 0; chunk < n_chunks; ++chunk) {
      sum_chunk(chunk, stiffness, sums.data());
      const double* sum = sums.data();
      for (int row = chunk_start_[chunk]; row < chunk_start_[chunk + 1]; ++row)
        for (auto p = pair_start_[row]; p < pair_start_[row + 1]; ++p, sum += D * D) {
          const int column = pair_column_[p];
          double k[D * D];
          std::copy_n(sum, D * D, k);
          turn_block(frame_of<frame_size>(row, turned, frames), frame_of<frame_size>(column, turned, frames), k);
          store_pair(p, row, column, k, data, false);
        }
    }
  }
}

template <int D>
void Assembler<D>::sum_chunk(int chunk, const std::vector<const double*>& stiffness, double* sums) const {
  const auto n_pairs = pair_start_[chunk_start_[chunk + 1]] - pair_start_[chunk_start_[chunk]];
  std::fill_n(sums, n_pairs * D * D, 0.0);
  for (std::size_t block = 0; block < stiffness.size(); ++block) {
    const auto& sources = pair_sources_[block];
    const std::int64_t next_row = static_cast<std::int64_t>(sources.freedoms) * pack_width;
    const std::int64_t last = static_cast<std::int64_t>(sources.source.size()) - 1;
    for (auto s = sources.start[chunk]; s < sources.start[chunk + 1]; ++s) {
      const double* ahead = stiffness[block] + sources.source[std::min(s + lead, last)];
      for (int r = 0; r < D; ++r) __builtin_prefetch(ahead + r * next_row);
      const double* entry = stiffness[block] + sources.source[s];
      double* k = sums + static_cast<std::int64_t>(D * D) * sources.pair[s];
      for (int r = 0; r < D; ++r)
        for (int c = 0; c < D; ++c) k[D * r + c] += entry[r * next_row + c * pack_width];
    }
  }
}

template <int D>
void Assembler<D>::add_blocks(int n, const int* pairs, const double* blocks, const std::uint8_t* turned,
                              const double* frames, double* data) const {
  for (int i = 0; i < n; ++i) {
    const int row = pairs[2 * i], column = pairs[2 * i + 1];
    if (symmetric_ && column < row) continue;
    const auto p = find_pair(row, column);
    if (p < 0) continue;
    double k[D * D];
    std::copy_n(blocks + static_cast<std::int64_t>(D * D) * i, D * D, k);
    turn_block(frame_of<frame_size>(row, turned, frames), frame_of<frame_size>(column, turned, frames), k);
    store_pair(p, row, column, k, data, true);
  }
}

template <int D>
void Assembler<D>::assemble_vector(const std::vector<const double*>& element_force, double* force) const {
#pragma omp parallel for schedule(static) if (n_nodes_ > 5000)
  for (int node = 0; node < n_nodes_; ++node) {
    double f[D] = {};
    for (std::size_t block = 0; block < element_force.size(); ++block) {
      const auto& sources = node_sources_[block];
      for (auto s = sources.start[node]; s < sources.start[node + 1]; ++s) {
        const double* entry = element_force[block] + sources.source[s];
        for (int i = 0; i < D; ++i) f[i] += entry[i * pack_width];
      }
    }
    std::copy_n(f, D, force + static_cast<std::int64_t>(D) * node);
  }
}

template <int D>
void Assembler<D>::constrain(const std::uint8_t* mask, const double* value, double scale, double* data,
                             double* rhs) const {
  std::vector<std::uint8_t> held(n_nodes_);  // nodes with a prescribed freedom
  for (int node = 0; node < n_nodes_; ++node)
    held[node] = std::any_of(mask + D * node, mask + D * (node + 1), [](std::uint8_t m) { return m != 0; });
  // columns of prescribed freedoms leave the free rows
#pragma omp parallel for schedule(static) if (n_nodes_ > 5000)
  for (int node = 0; node < n_nodes_; ++node)
    for (auto p = pair_start_[node]; p < pair_start_[node + 1]; ++p) {
      if (!held[pair_column_[p]]) continue;
      for (int row = D * node; row < D * (node + 1); ++row) {
        if (mask[row]) continue;
        const int lost = symmetric_ ? row - D * node : 0;
        double* at = data + indptr_[row] + D * (p - pair_start_[node]) - lost;
        for (int c = pair_column_[p] == node ? lost : 0; c < D; ++c) {
          const int column = D * pair_column_[p] + c;
          if (!mask[column]) continue;
          rhs[row] -= at[c] * value[column];
          at[c] = 0.0;
        }
      }
    }
  const int n = D * n_nodes_;
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

template class Assembler<1>;
template class Assembler<2>;
template class Assembler<3>;
template class Assembler<4>;
template class Assembler<6>;

}  // namespace presswork
