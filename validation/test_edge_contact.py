# SPDX-License-Identifier: Apache-2.0
"""Edges of shells keep a radius of half their length out of the sheet."""

import pytest
from edge_contact import draw

pytestmark = pytest.mark.validation


def test_edges_keep_out_what_nodes_let_in() -> None:
    """Of 0.8 mm: nodes alone more than 40 %, edges less than 4 %; the balance within 0.4 %."""
    nodes, edges = (draw(1.0, 2.0, points) for points in ("nodes", "edges"))
    assert nodes.sunk > 0.32
    assert edges.sunk < 0.032
    assert edges.energy_error < 0.4


def test_both_agree_where_the_mesh_is_finer() -> None:
    """Force within 2.5 % of each other and 4 % of a mesh twice as fine, where a shell is as long as the radius."""
    nodes, edges, fine = draw(1.0, 1.0, "nodes"), draw(1.0, 1.0, "edges"), draw(1.0, 0.5, "nodes")
    assert edges.force == pytest.approx(nodes.force, rel=0.025)
    assert edges.force == pytest.approx(fine.force, rel=0.04)
    assert edges.sunk < 0.02 < nodes.sunk
