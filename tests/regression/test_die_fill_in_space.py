# SPDX-License-Identifier: Apache-2.0
"""Dies of facets with a flash land in runs in space: how far they are filled, and how thick the flash is."""

import numpy as np
import pytest

from presswork import build_model, read_case, run_model
from presswork.case.space.schema import SpaceCase
from presswork.examples import copy_example
from presswork.observe.die_fill.dies import DieFill
from presswork.observe.die_fill.space import DieFillInSpace
from presswork.outcome import GaveUpError
from presswork.process.begin import begin
from tests.unit.mesh.test_die_cavity import make_die

HARDENING = {"law": "swift", "K": 500, "e0": 0.01, "n": 0.2}


def write_stl(path, points, triangles):
    """Write facets; return the path as text."""
    lines = [
        f"facet normal 0 0 0\nouter loop\n{''.join(f'vertex {x:.9g} {y:.9g} {z:.9g}' + chr(10) for x, y, z in facet)}"
        "endloop\nendfacet\n"
        for facet in points[triangles]
    ]
    path.write_text("solid die\n" + "".join(lines) + "endsolid die\n")
    return str(path)


def make_case(tools, *, height=6.0, standing=False):
    """The eighth of a block of 4 x 4 mm that a die presses; standing: the quarter, not held across the way of dies."""
    sides = [("x", "left", "x"), ("y", "bottom", "y"), ("z", "back", "z")]
    return SpaceCase(
        title="a block in a pocket",
        analysis="solid",
        workpiece={
            "material": "steel",
            "element": "hex8_fbar",
            "mesh": {"kind": "box", "size": [2.0, 2.0, height], "cells": [2, 2, 3]},
        },
        materials={"steel": {"young": 2e5, "poisson": 0.3, "hardening": HARDENING}},
        tools=tools,
        boundary={name: {"set": side, "fix": [axis]} for name, side, axis in sides[: 2 if standing else 3]},
        stages=[{"name": "press", "tools": {"die": {"stroke": 0.1, "direction": [0, 0, -1]}}}],
        output={"steps": 1},
    )


def test_a_die_in_space_tells_its_fill_and_its_flash(tmp_path):
    """A block beneath a pocket of which it touches the floor: its top of 4 x 4 mm; the land is 3.5 mm lower."""
    path = write_stl(tmp_path / "die.stl", *make_die(start=0.0))
    case = make_case({"die": {"shape": "file", "path": path, "position": [0, 0, 2], "contact": "frictionless"}})
    model = build_model(case)
    result = run_model(model, tmp_path / "out", threads=1).result
    floor, whole = 2.0**2, 0.25 * (5.0**2 + (12.0**2 - 5.0**2) * np.sqrt(2.0))
    assert result.history["die.fill"][-1] == pytest.approx(floor / whole, abs=0.01)
    assert result.history["die.flash_thickness"][-1] == pytest.approx(2 * (2.0 - 0.1 + 0.5), abs=1e-6)
    told = result.summary["die_fill"]["die"]
    assert told["wall_filled"] == result.history["die.fill"][-1]
    assert told["largest_gap_mm"] > 2.0
    # where the metal is drawn beyond the wall, as beside an edge of a die that cuts its cells, it has reached it
    lifted = result.points(-1) + np.array([0.0, 0.0, 0.3])
    beyond = DieFillInSpace(model).measure(model.mesh, lifted, {"die": np.array([0.0, 0.0, -0.1])})
    assert beyond["die.fill"] == pytest.approx(floor / whole, abs=0.01)


@pytest.mark.parametrize("start", [0.0, -1.0])
def test_a_die_that_stands_is_filled_where_metal_can_be_however_much_of_it_is_drawn(tmp_path, start):
    """The block fills the floor beneath it; beyond the symmetry planes there is no metal to fill the die with."""
    points, triangles = make_die(start=start)
    upper = write_stl(tmp_path / "upper.stl", points, triangles)
    lower = write_stl(tmp_path / "lower.stl", points * [1.0, 1.0, -1.0], triangles[:, ::-1])
    tools = {
        name: {"shape": "file", "path": path, "position": [0, 0, z], "contact": "frictionless"}
        for name, path, z in (("die", upper, 4.0), ("lower", lower, 4.0))
    }
    model = build_model(make_case(tools, height=8.0, standing=True))
    fill = DieFillInSpace(model)
    found = fill.measure(model.mesh, model.mesh.points, dict.fromkeys(("die", "lower"), np.zeros(3)))
    floor, whole = 2.0**2, 0.25 * (5.0**2 + (12.0**2 - 5.0**2) * np.sqrt(2.0))
    assert found["die.fill"] == pytest.approx(floor / whole, abs=0.01)
    assert found["lower.fill"] == pytest.approx(floor / whole, abs=0.01)
    assert found["lower.flash_thickness"] == pytest.approx(1.0, abs=1e-6)


def test_a_run_that_gives_up_on_a_full_die_says_so(monkeypatch, tmp_path):
    case = read_case(copy_example("forging_hub", tmp_path))
    recording = begin(build_model(case), 1)

    def give_up():
        raise GaveUpError("no equilibrium")

    monkeypatch.setattr(recording.procedure, "advance", give_up)
    monkeypatch.setattr(recording, "_change_mesh", lambda failure="": False)
    monkeypatch.setattr(
        recording.observers.find(DieFill), "measure", lambda *_: {"upper.fill": 0.99, "upper.flash_thickness": 1.0}
    )
    with pytest.raises(GaveUpError, match=r"no equilibrium; upper is full \(99 % of its wall\)"):
        next(recording.advance())
