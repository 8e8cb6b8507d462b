// SPDX-License-Identifier: Apache-2.0
// Sparsity pattern and scatter, D freedoms a node: 1 for heat, 2 for solids in the plane, 3 in space, 4 with a
// pressure, 6 for shells.
//
// Rows are filled in chunks. A chunk knows the element entries that add up to its DxD node pairs, cell by cell, so that
// the element arrays are read in order. Every pair is summed in the order of its cells by one thread: the bits do not
// depend on the number of threads. Symmetric patterns store the upper triangle only.
#pragma once

#include <cstdint>
#include <vector>

namespace presswork {

struct BlockConnectivity {
  int n_cells;
  int nodes;
  const int* connectivity;  // (n_cells, nodes)
};

// A node may take F = min(D, 3) freedoms in a frame of its own: the displacement of a solid, which comes first, or the
// rotation of a shell, which comes last.
template <int D>
class Assembler {
 public:
  static constexpr int freedoms = D, frame_size = D > 3 ? 3 : D;

  // couplings: further node pairs (n_couplings, 2) that the pattern must hold, in either order.
  Assembler(int n_nodes, const std::vector<BlockConnectivity>& blocks, bool symmetric, int n_couplings = 0,
            const int* couplings = nullptr);

  int n_nodes() const { return n_nodes_; }
  bool symmetric() const { return symmetric_; }
  const std::vector<int>& indptr() const { return indptr_; }
  const std::vector<int>& indices() const { return indices_; }

  // Fill data (nnz) from the element stiffnesses of each block. turned[i] marks nodes whose freedoms are taken in their
  // own frame: frames (n_nodes, F, F), rows are the local axes.
  void assemble_matrix(const std::vector<const double*>& stiffness, const std::uint8_t* turned, const double* frames,
                       double* data) const;

  // Add DxD blocks (n, D, D) at node pairs (n, 2) that the pattern holds; below the diagonal is left out if symmetric.
  void add_blocks(int n, const int* pairs, const double* blocks, const std::uint8_t* turned, const double* frames,
                  double* data) const;

  // force (n_nodes, D) from the element forces of each block.
  void assemble_vector(const std::vector<const double*>& element_force, double* force) const;

  // Prescribe the freedoms of mask: rhs loses the columns times value, rows and columns become `scale` on the diagonal,
  // rhs there scale * value.
  void constrain(const std::uint8_t* mask, const double* value, double scale, double* data, double* rhs) const;

 private:
  struct PairSources {  // per chunk of rows, the element entries that add up to its node pairs, in the order of cells
    int freedoms = 0;
    std::vector<std::int64_t> start;    // (n_chunks + 1)
    std::vector<std::uint32_t> source;  // offset of entry (D a, D b) in the packed array
    std::vector<std::uint32_t> pair;    // to which it is added, counted from the first of the chunk
  };
  struct NodeSources {
    std::vector<std::int64_t> start;
    std::vector<std::int32_t> source;
  };

  void build_pairs(const std::vector<BlockConnectivity>& blocks, int n_couplings, const int* couplings);
  void build_csr();
  void build_chunks();
  void build_sources(const BlockConnectivity& block);
  std::int64_t find_pair(int row, int column) const;
  void sum_chunk(int chunk, const std::vector<const double*>& stiffness, double* sums) const;
  void store_pair(std::int64_t pair, int row, int column, const double k[D * D], double* data, bool add) const;

  int n_nodes_;
  bool symmetric_;
  std::vector<std::int64_t> pair_start_;  // (n_nodes + 1)
  std::vector<int> pair_column_;
  std::vector<int> chunk_start_;    // (n_chunks + 1), of nodes
  std::int64_t largest_chunk_ = 0;  // [node pairs]
  std::vector<int> indptr_, indices_;
  std::vector<PairSources> pair_sources_;
  std::vector<NodeSources> node_sources_;
};

extern template class Assembler<1>;
extern template class Assembler<2>;
extern template class Assembler<3>;
extern template class Assembler<4>;
extern template class Assembler<6>;

}  // namespace presswork
