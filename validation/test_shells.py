# SPDX-License-Identifier: Apache-2.0
"""Longer problems of Sze, Liu & Lo (2004), as in tests/verification/test_shell_large_rotation.py."""

from __future__ import annotations

import numpy as np
import pytest

from presswork.implicit.arc_length import ArcLengthProcedure
from tests.problems.plane_solids import elastic
from tests.problems.shells import CLAMPED, RX, X, Y, Z, fixing, patch, shell_model, symmetry
from tests.verification.test_shell_large_rotation import TABLES, cylinder, deviation, follow, lines

pytestmark = pytest.mark.validation


def test_pinched_cylinder_with_diaphragms() -> None:
    """It snaps through several wrinkles on the way; the same displacements pass where the table has its points.

    Control by load may stop at a wrinkle's limit load, and does with MITC4+ at 77 %; MITC4 jumps over all of them.
    """
    mesh = cylinder(100.0, 100.0, 1.0, (40, 40), "shell4_mitc")
    held = [("left", symmetry(Y)), ("right", fixing(X, Z)), ("bottom", symmetry(X)), ("top", symmetry(Z))]
    model = shell_model(mesh, elastic(3e4, 0.3), held, forces=[("bottom_left", (0, 0, -3000.0))],
                        initial_increment=0.025, max_increment=0.025)  # fmt: skip
    found, _ = follow(model, [("bottom_left", Z), ("top_left", X)])
    assert deviation(found, "pinched_cylinder_diaphragms", [1]) < 0.012
    assert deviation(found[:, [0, 2]], "pinched_cylinder_diaphragms", [2]) < 0.03


@pytest.mark.parametrize(("element", "n", "tolerance"), [
    ("shell4_mitc_plus", 40, 0.004), ("shell9_mitc", 24, 0.012), ("shell3_mitc_plus", 40, 0.022),
])  # fmt: skip
def test_pinched_cylinder_with_diaphragms_by_arc_length(element, n, tolerance) -> None:
    """Control by load stops at the first limit load that Newton does not jump over; the arc passes them all."""
    mesh = cylinder(100.0, 100.0, 1.0, (n, n), element)
    held = [("left", symmetry(Y)), ("right", fixing(X, Z)), ("bottom", symmetry(X)), ("top", symmetry(Z))]
    model = shell_model(mesh, elastic(3e4, 0.3), held, forces=[("bottom_left", (0, 0, -3000.0))],
                        control="arc_length", initial_increment=0.02)  # fmt: skip
    procedure = ArcLengthProcedure(model, threads=1)
    increments = sum(1 for _ in procedure.advance())
    moved = procedure.state.nodes.displacement
    found = [-moved[mesh.node_sets["bottom_left"], Z].mean(), moved[mesh.node_sets["top_left"], X].mean()]
    assert found == pytest.approx(TABLES["pinched_cylinder_diaphragms"]["data"][-1][1:], rel=tolerance)
    assert increments < 150


def test_pinched_semi_cylinder() -> None:
    radius = 101.6

    def shape(u, v):
        return np.column_stack([u, radius * np.sin(v), radius * np.cos(v)])

    mesh = patch(shape, lines(304.8, 32), lines(np.pi / 2, 32), thickness=3.0,
                 normal=lambda u, v: np.column_stack([0 * u, np.sin(v), np.cos(v)]))  # fmt: skip
    held = [("left", CLAMPED), ("bottom", symmetry(Y)), ("top", fixing(Z, RX))]
    model = shell_model(mesh, elastic(2068.5, 0.3), held, forces=[("bottom_right", (0, 0, -1000.0))],
                        initial_increment=0.025, max_increment=0.025)  # fmt: skip
    found, _ = follow(model, [("bottom_right", Z)])
    assert deviation(found, "pinched_semi_cylinder", [1]) < 0.01
