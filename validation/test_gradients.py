# SPDX-License-Identifier: Apache-2.0
"""Derivatives of stampings against central differences of whole runs: more numbers than tests/verification has."""

from __future__ import annotations

from pathlib import Path

import pytest

from presswork.case.stamping.schema import StampingCase
from tests.problems.differentiated import bend_over_die, differentiate, largest_error

pytestmark = pytest.mark.validation


def test_strip_bent_over_a_die_and_let_go(tmp_path: Path) -> None:
    """Whole runs differ so little that no node comes to a tool, and no layer yields, between them."""
    by = {
        "materials.steel.hardening.K": 565.0,
        "materials.steel.hardening.n": 0.26,
        "materials.steel.young": 206e3,
        "tools.die.mu": 0.1,
        "stages.0.tools.punch.stroke": 3.0,
        "blank.thickness": 1.0,
        "blank.size.0": 44.0,
        "tools.die.edge_radius": 6.0,
        "tools.die.width": 21.0,
    }
    apart = {key: 1e-4 if key.startswith("materials") else 1e-3 if key.endswith("mu") else 2e-5 for key in by}
    of = ["punch.force", "tip.x", "tip.z", "plastic_work", "friction_work", "external_work"]
    found = differentiate(StampingCase, bend_over_die(), of, by, tmp_path, apart=apart)
    errors = {(key, name): largest_error(*both) for key, columns in found.items() for name, both in columns.items()}
    print("\n".join(f"{key} {name}: {error:.1e}" for (key, name), error in errors.items()))
    assert max(errors.values()) < 1e-6
