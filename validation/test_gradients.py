# SPDX-License-Identifier: Apache-2.0
"""Derivatives of stampings against central differences of whole runs: more numbers than tests/verification has."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from presswork.case.stamping.schema import StampingCase
from tests.problems.differentiated import bend_over_die, differentiate, draw_under_holder, largest_error

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
    check(
        bend_over_die(),
        by,
        ["punch.force", "tip.x", "tip.z", "plastic_work", "friction_work", "external_work"],
        tmp_path,
    )


def test_strip_drawn_from_under_a_holder_and_let_go(tmp_path: Path) -> None:
    by = {
        "materials.steel.hardening.K": 565.0,
        "tools.die.mu": 0.1,
        "stages.0.tools.holder.force": 800.0,
        "stages.0.tools.punch.stroke": 3.0,
        "blank.thickness": 1.0,
        "tools.die.edge_radius": 6.0,
    }
    check(draw_under_holder(), by, ["punch.force", "tip.x", "tip.z", "plastic_work", "friction_work"], tmp_path)


def check(data: dict[str, Any], by: dict[str, float], of: list[str], folder: Path) -> None:
    apart = {
        key: 1e-4 if key.startswith("materials") else 1e-3 if key.endswith(("mu", "force")) else 2e-5 for key in by
    }
    found = differentiate(StampingCase, data, of, by, folder, apart=apart)
    errors = {(key, name): largest_error(*both) for key, columns in found.items() for name, both in columns.items()}
    print("\n".join(f"{key} {name}: {error:.1e}" for (key, name), error in errors.items()))
    assert max(errors.values()) < 1e-6
