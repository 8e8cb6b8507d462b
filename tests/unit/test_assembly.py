# SPDX-License-Identifier: Apache-2.0
"""The assembled matrix against a dense sum of element matrices; turned nodes, added blocks, prescribed freedoms."""

import numpy as np
import pytest
import scipy.sparse as sp

from presswork import _core

TRIANGLES = np.array([[0, 1, 4], [1, 3, 4], [3, 2, 4], [2, 0, 4]], dtype=np.int32)
QUADS = np.array([[1, 5, 6, 3]], dtype=np.int32)
N = 7


def pack(matrices: np.ndarray) -> np.ndarray:
    """Element arrays (n_cells, ...) in the packed layout (n_packs, ..., pack_width)."""
    width = _core.pack_width
    packs = -(-len(matrices) // width)
    padded = np.concatenate([matrices, np.repeat(matrices[-1:], packs * width - len(matrices), axis=0)])
    return np.ascontiguousarray(np.moveaxis(padded.reshape(packs, width, *matrices.shape[1:]), 1, -1))


class Assembled:
    def __init__(self, *, symmetric: bool) -> None:
        rng = np.random.default_rng(1)
        self.symmetric = symmetric
        self.assembler = _core.Assembler(N, [TRIANGLES, QUADS], symmetric)
        self.stiffness = [rng.standard_normal((4, 6, 6)), rng.standard_normal((1, 8, 8))]
        if symmetric:
            self.stiffness = [0.5 * (k + k.transpose(0, 2, 1)) for k in self.stiffness]
        self.turned = np.zeros(N, dtype=np.uint8)
        self.frames = np.tile(np.eye(2), (N, 1, 1))
        self.dense = np.zeros((2 * N, 2 * N))
        for cells, k in zip([TRIANGLES, QUADS], self.stiffness, strict=True):
            for cell, matrix in zip(cells, k, strict=True):
                freedoms = np.stack([2 * cell, 2 * cell + 1], axis=1).ravel()
                self.dense[np.ix_(freedoms, freedoms)] += matrix

    def data(self) -> np.ndarray:
        data = np.zeros(len(self.assembler.indices))
        self.assembler.assemble_matrix([pack(k) for k in self.stiffness], self.turned, self.frames, data)
        return data

    def to_dense(self, data: np.ndarray) -> np.ndarray:
        matrix = sp.csr_matrix((data, self.assembler.indices, self.assembler.indptr), shape=(2 * N, 2 * N)).toarray()
        return matrix + np.triu(matrix, 1).T if self.symmetric else matrix


@pytest.fixture(params=[True, False], ids=["symmetric", "unsymmetric"])
def assembled(request) -> Assembled:
    return Assembled(symmetric=request.param)


def test_matrix_is_the_sum_of_element_matrices(assembled) -> None:
    np.testing.assert_allclose(assembled.to_dense(assembled.data()), assembled.dense, atol=1e-14)


def test_turned_nodes_have_rows_and_columns_in_their_own_frame(assembled) -> None:
    turn = np.eye(2 * N)
    for node, angle in ((1, 0.3), (4, -1.1)):
        assembled.turned[node] = 1
        assembled.frames[node] = [[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]]
        turn[2 * node : 2 * node + 2, 2 * node : 2 * node + 2] = assembled.frames[node]
    np.testing.assert_allclose(assembled.to_dense(assembled.data()), turn @ assembled.dense @ turn.T, atol=1e-14)


def test_vector_is_the_sum_of_element_vectors(assembled) -> None:
    rng = np.random.default_rng(2)
    forces = [rng.standard_normal((4, 6)), rng.standard_normal((1, 8))]
    wanted = np.zeros((N, 2))
    for cells, f in zip([TRIANGLES, QUADS], forces, strict=True):
        np.add.at(wanted, cells, f.reshape(*cells.shape, 2))
    np.testing.assert_allclose(assembled.assembler.assemble_vector([pack(f) for f in forces]), wanted, atol=1e-14)


def test_added_blocks_land_at_their_node_pairs(assembled) -> None:
    block = np.array([[1.0, 2.0], [2.0, 5.0]])
    pairs = np.array([[1, 3], [3, 1], [3, 3]], dtype=np.int32)
    blocks = np.array([block, block.T, 2 * block])
    data = assembled.data()
    assembled.assembler.add_blocks(pairs, blocks, assembled.turned, assembled.frames, data)
    wanted = assembled.dense.copy()
    for (a, b), k in zip(pairs, blocks, strict=True):
        wanted[2 * a : 2 * a + 2, 2 * b : 2 * b + 2] += k
    np.testing.assert_allclose(assembled.to_dense(data), wanted, atol=1e-14)


def test_prescribed_freedoms_get_their_values_and_load_the_rest(assembled) -> None:
    rng = np.random.default_rng(3)
    mask = np.zeros(2 * N, dtype=np.uint8)
    mask[[0, 3, 8, 11]] = 1
    value = rng.standard_normal(2 * N) * mask
    rhs = rng.standard_normal(2 * N)
    dense = assembled.dense + 10 * np.eye(2 * N)
    data = assembled.data()
    shift = np.array([[i, i] for i in range(N)], dtype=np.int32)
    assembled.assembler.add_blocks(shift, np.tile(10 * np.eye(2), (N, 1, 1)), assembled.turned, assembled.frames, data)
    loaded = rhs.copy()
    assembled.assembler.constrain(mask, value, 3.0, data, loaded)
    found = np.linalg.solve(assembled.to_dense(data), loaded)
    free = mask == 0
    wanted = value.copy()
    wanted[free] = np.linalg.solve(dense[np.ix_(free, free)], rhs[free] - dense[np.ix_(free, ~free)] @ value[~free])
    np.testing.assert_allclose(found, wanted, atol=1e-12)


def test_couplings_widen_the_pattern_for_blocks_between_cells_that_share_no_node(assembled) -> None:
    couplings = np.array([[6, 0], [2, 5], [2, 2]], dtype=np.int32)
    narrow = assembled.assembler
    assembled.assembler = _core.Assembler(N, [TRIANGLES, QUADS], assembled.symmetric, couplings)
    assert len(assembled.assembler.indices) == len(narrow.indices) + 8 * (1 if assembled.symmetric else 2)
    data = assembled.data()
    block = np.array([[[1.0, 2.0], [3.0, 4.0]]])
    for row, column, k in ((0, 6, block), (6, 0, block.transpose(0, 2, 1))):
        pair = np.array([[row, column]], dtype=np.int32)
        assembled.assembler.add_blocks(pair, np.ascontiguousarray(k), assembled.turned, assembled.frames, data)
    wanted = assembled.dense.copy()
    wanted[0:2, 12:14] += block[0]
    wanted[12:14, 0:2] += block[0].T
    np.testing.assert_allclose(assembled.to_dense(data), wanted, atol=1e-14)


def test_couplings_must_be_nodes() -> None:
    with pytest.raises(ValueError, match="node indices"):
        _core.Assembler(N, [TRIANGLES, QUADS], True, np.array([[0, N]], dtype=np.int32))


@pytest.mark.parametrize("symmetric", [True, False])
def test_iterations_find_the_solution_or_say_that_it_is_far(symmetric) -> None:
    rng = np.random.default_rng(2)
    dense = rng.uniform(-1.0, 1.0, (30, 30)) * (rng.random((30, 30)) < 0.2)
    dense = 0.5 * (dense + dense.T) if symmetric else dense
    np.fill_diagonal(dense, 1.2 * np.abs(dense).sum(axis=1) + 1.0)
    rhs = rng.standard_normal(30)

    def solve(matrix: np.ndarray, most_iterations: int) -> np.ndarray | None:
        stored = sp.csr_matrix(np.triu(matrix) if symmetric else matrix)
        return _core.solve_iteratively(
            stored.indptr,
            stored.indices,
            stored.data,
            rhs,
            symmetric=symmetric,
            tolerance=1e-12,
            most_iterations=most_iterations,
        )

    assert solve(dense, 80) == pytest.approx(np.linalg.solve(dense, rhs), rel=1e-10, abs=1e-12)
    assert solve(dense, 2) is None
    dense[3, 3] = -1.0
    assert solve(dense, 80) is None, "the preconditioner needs a positive diagonal"
