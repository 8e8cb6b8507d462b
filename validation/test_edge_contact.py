# SPDX-License-Identifier: Apache-2.0
"""Edges of shells keep a radius of half their length out of the sheet."""

import pytest

from validation.edge_contact import draw

pytestmark = pytest.mark.validation


def test_edges_keep_out_what_nodes_let_in() -> None:
    """Of 0.8 mm: nodes alone more than 40 %, edges less than 4 %; the balance within 0.4 %."""
    nodes, edges = (draw(1.0, 2.0, points) for points in ("nodes", "edges"))
    assert nodes.sunk > 0.32
    assert edges.sunk < 0.032
    assert edges.energy_error < 0.4
