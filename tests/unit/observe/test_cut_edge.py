# SPDX-License-Identifier: Apache-2.0
"""Zones of edges whose outline is drawn: sheets and slugs with a roll-over, a wall, a slanted fracture and a burr."""

import numpy as np
import pytest

from presswork.observe.cut_edge import measure_cut_edge

DOWN = np.array([0.0, -1.0])
ROLLOVER, SHEARED, FRACTURE, BURR = 0.2, 0.5, 1.3, 0.1


def sheet(*, tilt=0.0):
    """A sheet of 2 mm right of a hole at x = 0, its burr below: outline, nodes of the crack."""
    angle = np.linspace(0.5 * np.pi, 0.0, 25)
    bend = np.column_stack([0.6 * (1.0 - np.cos(angle)), 2.0 - ROLLOVER * (1.0 - np.sin(angle))])  # down to the wall
    wall = np.column_stack([np.zeros(6), np.linspace(2.0 - ROLLOVER, FRACTURE, 6)])
    crack = np.column_stack([np.linspace(0.0, 0.2, 20), np.linspace(FRACTURE, -BURR, 20)])
    outside = np.array([[0.25, -0.5 * BURR], [0.3, 0.0]])
    low = np.column_stack([np.linspace(0.4, 10.0, 90), np.zeros(90)])
    high = np.column_stack([np.linspace(10.0, 0.65, 90), np.full(90, 2.0)])
    parts = [bend, wall[1:-1], crack, outside, low, high]
    marked = np.concatenate([np.full(len(part), part is crack) for part in parts])
    line = np.concatenate(parts)
    line[:, 1] += tilt * line[:, 0]
    return line, marked


def test_zones_of_a_drawn_edge_are_those_drawn():
    edge = measure_cut_edge(*sheet(), DOWN)
    assert edge is not None
    assert edge.thickness == pytest.approx(2.0, abs=1e-9)
    assert edge.fracture == pytest.approx(FRACTURE, abs=1e-9)
    assert edge.burr == pytest.approx(BURR, abs=1e-9)
    assert edge.rollover + edge.sheared == pytest.approx(ROLLOVER + SHEARED, abs=1e-9)
    assert edge.rollover == pytest.approx(ROLLOVER, abs=0.06)  # the bend is tangent to its wall


def test_zones_are_from_the_surfaces_of_a_sheet_that_is_bent_down():
    edge = measure_cut_edge(*sheet(tilt=0.05), DOWN)
    assert edge is not None
    assert edge.thickness == pytest.approx(2.0, abs=0.02)
    assert edge.burr == pytest.approx(BURR, abs=0.03)


def test_the_slug_has_the_zones_of_the_sheet_turned_round():
    line, marked = sheet()
    edge = measure_cut_edge(-line, marked, DOWN)
    assert edge is not None
    assert (edge.fracture, edge.burr) == pytest.approx((FRACTURE, BURR), abs=1e-9)


def test_a_piece_without_a_crack_has_no_edge():
    line, marked = sheet()
    assert measure_cut_edge(line, np.zeros_like(marked), DOWN) is None
    assert measure_cut_edge(line, np.ones_like(marked), DOWN) is None
