# SPDX-License-Identifier: Apache-2.0
"""A curved binder closes on a flat blank: where it starts, how far it goes, what is refused, and its energy."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from presswork import CaseError, build_model
from presswork.case.stamping.schema import StampingCase
from presswork.model import Model
from presswork.process.explicit.stamping import ExplicitStamping

RADIUS, LENGTH, WIDTH, THICKNESS, CLOSE = 600.0, 120.0, 40.0, 0.8, 0.84
YOUNG, POISSON = 2.06e5, 0.3
FALL = (0.5 * LENGTH) ** 2 / (2.0 * RADIUS)
"""Of the binder from the middle to the end of the blank [mm]."""


def write_binder(path: Path, *, bump: float = 0.0) -> str:
    """Write a binder that falls by x^2/(2 RADIUS), wider than the blank; bump: of its middle beyond the blank [mm]."""
    x, y = np.linspace(-65.0, 65.0, 27), np.linspace(-25.0, 25.0, 6)
    grid = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1)
    height = -(grid[..., 0] ** 2) / (2.0 * RADIUS)
    height[12:15, 0] += bump
    points = np.concatenate([grid, height[..., None]], axis=-1)
    a, b, c, d = points[:-1, :-1], points[1:, :-1], points[1:, 1:], points[:-1, 1:]
    facets = np.stack([np.stack([a, b, c], axis=-2), np.stack([a, c, d], axis=-2)], axis=2).reshape(-1, 3, 3)
    text = "".join(
        "facet normal 0 0 0\nouter loop\n" + "".join("vertex {:.9g} {:.9g} {:.9g}\n".format(*p) for p in f)
        + "endloop\nendfacet\n" for f in facets
    )  # fmt: skip
    path.write_text(f"solid binder\n{text}endsolid binder\n")
    return str(path)


def make_case(path: str, *stages: dict[str, Any], **keys: Any) -> StampingCase:
    """Return a case of a blank between two binders of one surface."""
    tool = {"shape": "file", "path": path}
    hardening = {"law": "linear", "yield_stress": 900.0, "modulus": 1000.0}
    return StampingCase(
        title="wrap", analysis="stamping",
        blank={"material": "steel", "shape": "rectangle", "size": [LENGTH, WIDTH], "thickness": THICKNESS,
               "element_size": 10.0},
        materials={"steel": {"young": YOUNG, "poisson": POISSON, "hardening": hardening}},
        tools={"die": {"kind": "die", **tool}, "holder": {"kind": "holder", **tool}},
        stages=stages, output={"rows": 20, "steps": 1}, **keys,
    )  # fmt: skip


WRAP: dict[str, Any] = {"name": "wrap", "velocity": "1 m/s", "tools": {"holder": {"close": CLOSE}}}


def build(path: str, *stages: dict[str, Any], **keys: Any) -> Model:
    return build_model(make_case(path, *stages, **keys))


@pytest.fixture(scope="module")
def binder(tmp_path_factory: pytest.TempPathFactory) -> str:
    return write_binder(tmp_path_factory.mktemp("wrap") / "binder.stl")


def test_holder_starts_where_it_touches_the_blank_and_closes_by_distance(binder) -> None:
    """It starts at the ends of the blank, FALL above the die, and stops where the surfaces leave CLOSE."""
    model = build(binder, WRAP)
    die, holder = model.tools
    apart = holder.position[2] - die.position[2]
    assert apart == pytest.approx(FALL + THICKNESS, abs=0.01)
    stroke = -model.stages[0].tool_motion["holder"].move[2]
    cosine = np.cos(np.arctan(65.0 / RADIUS))
    assert stroke == pytest.approx(apart - CLOSE / cosine, abs=0.01)
    assert model.stages[0].ramp == pytest.approx(0.5 * model.stages[0].duration)


def test_what_lies_beyond_the_blank_does_not_hold_the_die_off(tmp_path) -> None:
    """A rim rises by 2 mm from y = -15 to -25 mm; the blank ends half-way up, at -20."""
    path = write_binder(tmp_path / "bump.stl", bump=2.0)
    die, _ = build(path, WRAP).tools
    assert die.position[2] == pytest.approx(-0.5 * THICKNESS - 1.0, abs=0.01)


@pytest.mark.parametrize(("stages", "told"), [
    ([{"name": "wrap", "velocity": "1 m/s", "tools": {"holder": {"stroke": FALL + 0.2}}}], "leaves less than 0.9 of"),
    ([{"name": "wrap", "velocity": "1 m/s", "tools": {"holder": {"stroke": FALL - 1.0}}}], "it holds nothing"),
    ([{"name": "wrap", "duration": 0.01, "tools": {"holder": {"force": 5e3}}}], "would slam shut"),
    ([{**WRAP, "tools": {"holder": {"close": 9.0}}}], "it stands so near already"),
])  # fmt: skip
def test_motions_that_do_not_close_the_binder_are_refused(binder, stages, told) -> None:
    with pytest.raises(CaseError, match=told):
        build(binder, *stages)


def test_strokes_and_forces_that_close_the_binder_are_accepted(binder) -> None:
    build(binder, {"name": "wrap", "velocity": "1 m/s", "tools": {"holder": {"stroke": FALL - 0.1}}})
    push = {"name": "hold", "duration": 0.001, "tools": {"holder": {"force": 5e3}}}
    build(binder, WRAP, push)
    build(binder, push, procedure="implicit")


def test_wrapping_takes_the_energy_of_bending_and_ends_softly(binder) -> None:
    """E t^3/(24 (1 - nu^2)) k^2 an area is that of a wide strip bent about one axis; 1/(1 - nu^2) less if narrow.

    The play of CLOSE leaves the free ends straight, over some sqrt(8 RADIUS 0.04 mm) = 14 mm, which takes less.
    """
    run = ExplicitStamping(build(binder, WRAP), threads=1)
    energies = [report.energies for report in run.advance()][-1]
    bending = YOUNG * THICKNESS**3 / 24.0 / RADIUS**2 * LENGTH * WIDTH
    assert 0.87 * bending < energies.internal < 1.1 * bending / (1.0 - POISSON**2)
    assert energies.kinetic < 0.05 * energies.internal
    x, _, z = run.positions().T
    assert np.abs(z + x**2 / (2.0 * RADIUS)).max() < 0.1
