# SPDX-License-Identifier: Apache-2.0
"""The division of a mesh over ranks."""

import numpy as np
import pytest

from presswork.ranks.division import bisect, divide
from presswork.ranks.launch import count_ranks
from presswork.ranks.parts import make_part, own_nodes
from tests.problems.space_solids import box


@pytest.mark.parametrize("size", [1, 2, 3, 4, 7])
def test_every_rank_has_its_share_of_cells_and_owns_nodes_of_its_own_cells(size):
    mesh = box("hex8_fbar", (4.0, 2.0, 1.0), (8, 4, 2))
    division = divide(mesh, size)
    counts = np.bincount(division.rank_of_cell[0], minlength=size)
    assert counts.sum() == 64
    assert counts.max() - counts.min() <= 2
    cells = mesh.blocks[0].connectivity
    for node, owner in enumerate(division.owner):
        assert owner in division.rank_of_cell[0][(cells == node).any(axis=1)]


def test_cells_are_cut_across_the_longest_side():
    centres = np.array([[x, y] for x in range(4) for y in range(2)], dtype=float)
    assert bisect(centres, 2).tolist() == [0, 0, 0, 0, 1, 1, 1, 1]
    assert np.bincount(bisect(centres, 4)).tolist() == [2, 2, 2, 2]


def test_more_ranks_than_cells_are_refused():
    with pytest.raises(ValueError, match="9 ranks, but the mesh has only 8 cells"):
        divide(box("hex8_fbar", (1.0, 1.0, 1.0), (2, 2, 2)), 9)


@pytest.mark.parametrize(
    ("environment", "ranks"),
    [
        ({}, 1),
        ({"OMPI_COMM_WORLD_SIZE": "4"}, 4),
        ({"PMI_SIZE": "3"}, 3),
        ({"SLURM_STEP_NUM_TASKS": "8"}, 1),  # a batch job that starts one process by itself
        ({"SLURM_STEP_NUM_TASKS": "8", "PMIX_RANK": "0"}, 8),
    ],
)
def test_launchers_are_known_by_their_variables(environment, ranks):
    assert count_ranks(environment) == ranks


def test_a_node_that_follows_another_has_its_owner_and_no_part_has_it_without_the_other():
    mesh = box("hex8_fbar", (4.0, 2.0, 1.0), (8, 4, 2))
    first, last = (np.flatnonzero(np.abs(mesh.points[:, 0] - x) < 1e-9) for x in (0.0, 4.0))
    cells, pairs = mesh.blocks[0].connectivity, np.column_stack([first, last])
    assert (own_nodes(mesh.points, [cells], 3)[pairs] != own_nodes(mesh.points, [cells], 3)[first][:, None]).any()
    for rank in range(3):
        part = make_part(mesh.points, [cells], 3, rank, [False], following=(pairs[:, ::-1], 1))
        assert np.array_equal(part.owner[first], part.owner[last])
        assert np.isin(first, part.nodes)[np.isin(last, part.nodes)].all()
        needs = np.isin(cells, np.flatnonzero(part.owner == rank)).any(axis=1)
        assert np.array_equal(part.elements[0], np.flatnonzero(needs))
        assert np.isin(cells[needs], part.nodes).all()


def test_nodes_that_all_ranks_know_come_from_their_owners_and_bring_no_cells():
    mesh = box("hex8_fbar", (4.0, 2.0, 1.0), (8, 4, 2))
    cells, known = mesh.blocks[0].connectivity, np.flatnonzero(mesh.points[:, 2] < 1e-9).astype(np.int32)
    parts = [make_part(mesh.points, [cells], 3, rank, [False], known=known) for rank in range(3)]
    for rank, part in enumerate(parts):
        assert np.isin(known, part.nodes).all()
        alone = make_part(mesh.points, [cells], 3, rank, [False])
        assert np.array_equal(part.elements[0], alone.elements[0])
        for other, ghosts in part.ghosts.items():
            sent = parts[other].nodes[parts[other].sent[rank]]
            assert np.array_equal(part.nodes[ghosts], sent)
            assert (part.owner[sent] == other).all()
