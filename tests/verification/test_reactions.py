# SPDX-License-Identifier: Apache-2.0
"""Reactions in the history: closed forms in the implicit procedure, balance of momentum in the explicit one."""

from __future__ import annotations

import numpy as np
import pytest

from presswork import Case, ShellCase, build_model, run
from presswork.explicit.shells import ExplicitShells
from presswork.process.explicit.begin_forming import begin_explicit_forming
from presswork.process.implicit.forming import ImplicitForming
from presswork.results import Result
from presswork.view.plots.history_plot import stress_strain

SWIFT = {"law": "swift", "K": 565.0, "e0": 0.007, "n": 0.26}
STEEL = {"young": 2e5, "poisson": 0.3, "hardening": SWIFT}


def record(case):
    """Return every row of a run, and the recording at its end."""
    recording = ImplicitForming(build_model(case), threads=1)
    return [recording.row(report) for report in recording.advance()], recording


def bar(analysis: str, element: str, **changes) -> Case:
    """A quarter of a bar 10 mm wide and 20 mm long, or of a round one 10 mm thick, pulled by 5 mm at each end."""
    data = {
        "title": "bar", "analysis": analysis,
        "workpiece": {"material": "steel", "element": element, "mesh": {"size": [5, 10], "cells": [2, 3]}},
        "materials": {"steel": STEEL},
        "boundary": {"axis": {"set": "left", "fix": ["x"]}, "middle": {"set": "bottom", "fix": ["y"]}},
        "stages": [{"name": "pull", "displacement": [{"set": "top", "component": "y", "value": 5.0}]}],
        "output": {"steps": 1}, "solver": {"max_increment": 0.01},
    }  # fmt: skip
    return Case(**(data | changes))


@pytest.mark.parametrize("element", ["tri3", "quad4_fbar", "quad8"])
@pytest.mark.parametrize("analysis", ["axisymmetric", "plane_strain"])
def test_a_tension_test_has_its_force_and_its_maximum_where_considere_says(analysis, element):
    """F = area stress; it is largest where d stress/d strain = stress: at the strain n - e0 of Swift's law."""
    rows, recording = record(bar(analysis, element))
    force = np.array([row["top.force_y"] for row in rows])
    moved = np.array([row["top.displacement_y"] for row in rows])
    assert moved[-1] == pytest.approx(5.0)
    np.testing.assert_allclose(force, [-row["middle.force_y"] for row in rows], rtol=1e-6)
    factor = 1.0 if analysis == "axisymmetric" else 2 / np.sqrt(3)  # of plane strain: stress, and 1/ of strain
    strain = np.log1p(moved / 10)
    flow = 565 * (0.007 + factor * strain) ** 0.26
    for _ in range(5):  # less the elastic strain
        flow = 565 * (0.007 + np.maximum(factor * strain - flow / 2e5, 0.0)) ** 0.26
    start = np.pi * 25 if analysis == "axisymmetric" else 5.0
    closed = factor * flow * start * np.exp(-strain)
    plastic = strain > 0.05
    np.testing.assert_allclose(force[plastic], closed[plastic], rtol=3e-3)
    assert strain[np.argmax(force)] == pytest.approx(0.26 - 0.007 / factor, abs=0.012)
    point = recording.snapshot().point_data["reaction_force"]
    top, bottom = (recording.mesh.node_sets[name] for name in ("top", "bottom"))
    assert point[top, 1].sum() == pytest.approx(force[-1])
    assert point[bottom, 1].sum() == pytest.approx(-force[-1], rel=1e-6)
    assert not point[np.setdiff1d(np.arange(len(point)), [*top, *bottom]), 1].any()


def test_names_that_are_taken_are_told_apart():
    """A tool, a boundary entry and a moved set may have the same name."""
    case = bar(
        "plane_strain", "quad4",
        boundary={"top": {"set": "left", "fix": ["x"]}, "left": {"set": "bottom", "fix": ["y"]}},
        tools={"left": {"profile": [[-1, -1], [-1, 30]], "contact": "frictionless"}},
    )  # fmt: skip
    columns = ImplicitForming(build_model(case), threads=1).columns
    assert len(columns) == len(set(columns))
    assert {"left.force_x", "boundary_left.force_y", "top.force_x", "displacement_top.force_y"} <= set(columns)


def test_support_of_one_body_bears_what_is_pushed_on_another():
    """Two blocks on each other: displacement above, contact, support below."""
    mesh = {"origin": [0, 10], "size": [8, 6], "cells": [4, 3]}
    data = bar("plane_strain", "quad4_fbar").model_dump(exclude_unset=True)
    data["bodies"] = {"die": {"material": "steel", "element": "quad4_fbar", "mesh": mesh}}
    data["contacts"] = {"joint": {"between": ["workpiece", "die"], "contact": "frictionless"}}
    data["boundary"] |= {"die_axis": {"set": "die.left", "fix": ["x"]}}
    data["stages"] = [{"name": "push", "displacement": [{"set": "die.top", "component": "y", "value": -0.1}]}]
    data["solver"] = {"initial_increment": 0.1, "max_increment": 0.25}
    rows, _ = record(Case(**data))
    last = rows[-1]
    assert last["die.top.force_y"] < -1000
    assert last["middle.force_y"] == pytest.approx(-last["die.top.force_y"], rel=1e-4)
    assert abs(last["joint.force_y"]) == pytest.approx(abs(last["die.top.force_y"]), rel=1e-4)


@pytest.mark.parametrize("displacements", ["small", "large"])
def test_clamp_of_a_plate_bears_force_and_moment_of_its_load(displacements):
    """A cantilever 40 mm long and 10 mm wide with 2 N/mm across its tip: about the clamp F l, of l as it is bent."""
    case = ShellCase(
        title="cantilever", analysis="shell",
        workpiece={"material": "steel", "element": "shell4_mitc", "section": {"thickness": 1.0},
                   "mesh": {"size": [40, 10], "cells": [8, 2]}},
        materials={"steel": {"young": 2e5, "poisson": 0.3, "hardening": {"law": "linear", "yield_stress": 3000}}},
        boundary={"clamp": {"set": "left", "hold": "clamped"}},
        stages=[{"name": "load", "edge_force": [{"set": "right", "value": [0, 0, 2]}]}],
        solver={"displacements": displacements, "initial_increment": 0.25, "max_increment": 0.25},
        output={"steps": 1},
    )  # fmt: skip
    rows, recording = record(case)
    row, tip = rows[-1], recording.mesh.node_sets["right"]
    moved = recording.procedure.state.nodes.displacement[tip, :3]
    assert row["clamp.force_z"] == pytest.approx(-20.0, rel=1e-4)
    arm = 40.0 if displacements == "small" else 40.0 + moved[:, 0].mean()
    assert row["clamp.moment_y"] == pytest.approx(20.0 * arm, rel=2e-3)
    assert abs(row["clamp.moment_x"]) < 1.0
    deflection = 20 * 40**3 / (3 * 2e5 * 10 / 12)
    if displacements == "small":  # between a beam's, and that of a strip that keeps its width
        assert 0.91 * deflection < moved[:, 2].mean() < 1.01 * deflection
    else:
        assert moved[:, 2].mean() < 0.99 * deflection
        assert moved[:, 0].mean() < -0.05


def test_explicit_solids_take_the_impulse_of_their_reactions():
    """Sum of reactions over the rows = change of momentum, to rounding; and in the end F = area stress."""
    data = bar("plane_strain", "quad4_1pt").model_dump(exclude_unset=True)
    data["materials"]["steel"]["density"] = 7.85e-9
    data["procedure"] = "explicit"
    move = {"set": "top", "component": "y", "value": 2.0}
    data["stages"] = [{"name": "pull", "duration": 1e-3, "displacement": [move]}]
    del data["solver"]
    data["output"] = {"rows": 40, "steps": 1}
    recording = begin_explicit_forming(build_model(Case(**data)), threads=1)
    impulse, rows = 0.0, []
    for report in recording.advance():
        rows.append(recording.row(report))
        impulse += 1e-3 / 40 * (rows[-1]["top.force_y"] + rows[-1]["middle.force_y"])
        if len(rows) == 17:
            momentum = float((recording.solids.mass * recording.solids.velocity[:, 1]).sum())
            assert impulse == pytest.approx(momentum, rel=1e-9)
    strain = np.log(1.2)
    closed = 2 / np.sqrt(3) * 565 * (0.007 + 2 / np.sqrt(3) * strain) ** 0.26 * 5 / 1.2
    tail = np.mean([row["top.force_y"] for row in rows[-4:]])
    assert tail == pytest.approx(closed, rel=0.02)
    field = recording.snapshot().point_data["reaction_force"]
    assert field[recording.mesh.node_sets["top"], 1].sum() == pytest.approx(rows[-1]["top.force_y"])


def test_explicit_shells_take_the_impulse_of_their_reactions():
    """A strip held at one end and pulled at the other: what both do is the change of momentum, in every component."""
    from presswork import _core

    x, y = np.meshgrid(np.linspace(0, 20, 9), np.linspace(0, 5, 3))
    points = np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)])
    cells = np.array([[i + 9 * j, i + 1 + 9 * j, i + 10 + 9 * j, i + 9 + 9 * j] for j in range(2) for i in range(8)])
    isotropic = _core.YieldFunction.hill1948([0.5, 0.5, 0.5, 1.5, 1.5, 1.5])
    law = _core.SheetLaw(207e3, 0.3, isotropic, _core.HardeningLaw.swift, [565.0, 0.007, 0.26])
    shells = ExplicitShells(points, cells, 0.8, law, 7.85e-9)
    left, right = np.flatnonzero(points[:, 0] == 0), np.flatnonzero(points[:, 0] == 20)
    shells.fix(left, "uvwabc"[:3])
    shells.fix(right, "u", 5000.0)
    shells.fix(right, "w", 1000.0)
    shells.reset_reaction()
    shells.advance(200)
    reaction = shells.reaction_impulse
    momentum = (shells.mass[:, :1] * shells.velocity[:, :3]).sum(axis=0)
    np.testing.assert_allclose(reaction[:, :3].sum(axis=0), momentum, atol=1e-9 * np.abs(momentum).max())
    assert reaction[left, 0].sum() < 0 < reaction[right, 0].sum()
    assert not reaction[np.setdiff1d(np.arange(len(points)), [*left, *right])].any()


def test_nominal_stress_and_strain_come_from_the_undeformed_ends(tmp_path):
    """Whichever end is pulled: stress force/area and strain displacement/length, positive in tension."""
    for end, other, value in (("top", "bottom", 5.0), ("bottom", "top", -5.0)):
        case = bar(
            "axisymmetric", "quad4_fbar",
            boundary={"axis": {"set": "left", "fix": ["x"]}, "grip": {"set": other, "fix": ["y"]}},
            stages=[{"name": "pull", "displacement": [{"set": end, "component": "y", "value": value}]}],
        )  # fmt: skip
        run(case, tmp_path / end)
        strain, stress = stress_strain(Result(tmp_path / end))[end]
        assert strain[[0, -1]] == pytest.approx([0.0, 0.5])
        assert stress.max() == pytest.approx(565 * 0.26**0.26 * np.exp(0.007 - 0.26), rel=3e-3)


@pytest.mark.parametrize("procedure", ["implicit", "explicit"])
def test_the_force_of_a_standing_ring_is_what_the_press_feels(procedure):
    """A cone that a billet is pressed into bears the ram's force; what it holds round itself loads no press.

    Explicitly, in the mean of the last ten output intervals: the billet vibrates between the tools.
    """
    explicit = procedure == "explicit"
    data = bar("axisymmetric", "quad4_1pt" if explicit else "quad4_fbar").model_dump(exclude_unset=True)
    data["boundary"] = {"axis": {"set": "left", "fix": ["x"]}}
    data["tools"] = {
        "ram": {"profile": [[0, 10], [20, 10]], "contact": "frictionless"},
        "cone": {"profile": [[12, 7], [5, 0], [-1, 0]], "contact": "frictionless"},
    }
    data["stages"] = [{"name": "press", "duration": 2e-3, "tools": {"ram": {"stroke": 2.0, "direction": [0, -1]}}}]
    if explicit:
        data["materials"]["steel"]["density"] = 7.85e-9
        data["procedure"] = "explicit"
        del data["solver"]
        data["output"] = {"rows": 40, "steps": 1}
        impact = begin_explicit_forming(build_model(Case(**data)), threads=1)
        late = [impact.row(report) for report in impact.advance()][-10:]
        names = ("ram.force", "cone.force", "cone.force_x", "cone.force_y")
        last = {name: float(np.mean([row[name] for row in late])) for name in names}
    else:
        last = record(Case(**data))[0][-1]
    assert abs(last["cone.force_x"]) > 0.1 * last["ram.force"]
    assert last["cone.force"] == pytest.approx(abs(last["cone.force_y"]), rel=1e-12)
    assert last["cone.force"] == pytest.approx(last["ram.force"], rel=0.01)
