# SPDX-License-Identifier: Apache-2.0
"""Derivatives found in a run, against central differences of whole runs and closed forms."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq

from presswork.case import build_model
from presswork.case.plane.schema import Case
from presswork.case.shell.schema import ShellCase
from presswork.case.space.schema import SpaceCase
from presswork.case.stamping.schema import StampingCase
from presswork.implicit import ram
from presswork.interaction.led import Led
from presswork.interaction.plane.plane_tools import PlaneTools
from presswork.interaction.space.space_tools import SpaceTools
from presswork.process.begin import begin
from presswork.results.history import name_derivative
from tests.problems.differentiated import (
    EVEN,
    bend_over_die,
    bend_strip,
    bend_twice,
    differentiate,
    draw_under_holder,
    largest_error,
    run_case,
    stamp_hot,
    twist_sector,
    upset_between_floating_tools,
    upset_block,
    upset_cylinder,
    upset_hot,
    upset_hot_block,
    upset_in_press,
    upset_two_blocks,
    upset_two_bodies,
    upset_until,
    upset_with_floating_tools,
    with_inertia,
)
from tests.problems.mapped_meshes import differentiate_with_meshes, upset_block_with_new_meshes, upset_with_new_meshes

BY = {
    "materials.steel.young": 200e3,
    "materials.steel.hardening.K": 700.0,
    "materials.steel.hardening.n": 0.2,
    "tools.punch.m": 0.2,
    "stages.0.tools.punch.stroke": 1.2,
    "workpiece.mesh.size.0": 10.0,
}


def test_upsetting_has_the_derivatives_of_whole_runs(tmp_path: Path) -> None:
    data = upset_cylinder(points={"rim": [10, 0]})
    found = differentiate(Case, data, ["punch.force", "rim.x", "damage_cockcroft_latham_max"], BY, tmp_path)
    for key, columns in found.items():
        for name, (own, other) in columns.items():
            assert largest_error(own, other) < 1e-6, (key, name)


def test_derivatives_go_through_new_meshes() -> None:
    """Against whole runs on the same new meshes, each where their own material is."""
    by = {"tools.punch.m": 0.2, "stages.0.tools.punch.stroke": 1.9}
    data, of = upset_with_new_meshes(stroke=1.9, increment=0.2), ["punch.force", "rim.x", "core.effective_stress"]
    found, n_meshes = differentiate_with_meshes(data, of, by)
    assert n_meshes == 3
    for names, both in found.items():
        assert largest_error(*both) < 1e-6, names


@pytest.mark.validation
def test_derivatives_go_through_new_meshes_in_space() -> None:
    """The same of tetrahedra. Whole runs lie closer together: values are carried within a range that has corners."""
    by = {"tools.punch.mu": 0.1, "workpiece.mesh.size.0": 10.0}
    of = ["punch.force", "rim.x", "core.effective_stress"]
    found, n_meshes = differentiate_with_meshes(upset_block_with_new_meshes(), of, by, apart=3e-5)
    assert n_meshes == 2
    for names, both in found.items():
        assert largest_error(*both) < 1e-6, names


@pytest.mark.parametrize(
    ("kind", "data", "of", "by"),
    [
        (
            Case,
            upset_two_bodies({"contact": "shear", "m": 0.2}),
            ["punch.force", "core.effective_stress"],
            {"materials.soft.hardening.K": 300.0, "contacts.joint.m": 0.2},
        ),
        (SpaceCase, upset_two_blocks(), ["punch.force", "rim.x"], {"contacts.joint.mu": 0.1}),
        (SpaceCase, twist_sector(), ["die.force", "rim.x"], {"stages.0.tools.die.turn": 40.0, "tools.die.mu": 0.3}),
    ],
    ids=["bodies in the plane", "bodies in space", "sector"],
)
def test_bodies_that_touch_and_sectors_have_the_derivatives_of_whole_runs(
    kind: type[Case | SpaceCase], data: dict[str, Any], of: list[str], by: dict[str, float], tmp_path: Path
) -> None:
    for key, columns in differentiate(kind, data, of, by, tmp_path).items():
        for name, both in columns.items():
            assert largest_error(*both) < 1e-6, (key, name)


def test_loose_equilibrium_has_three_digits_of_the_derivatives(tmp_path: Path) -> None:
    """With the default tolerance one neighbour a number is computed, beside the run itself."""
    asked = {"by": list(BY), "of": ["punch.force", "rim.x"]}
    data = upset_cylinder(points={"rim": [10, 0]}, gradients=asked)
    tight = run_case(Case, data, tmp_path / "tight").history
    loose = {"initial_increment": 0.25, "max_increment": 0.25}
    found = run_case(Case, {**data, "solver": loose}, tmp_path / "loose").history
    names = [name for name in tight if name.startswith("d(")]
    assert len(names) == 12
    for name in names:
        assert largest_error(np.asarray(found[name]), np.asarray(tight[name])) < 1e-3, name


def test_force_on_a_cylinder_rises_with_friction_by_the_closed_form(tmp_path: Path) -> None:
    """Thin friction: p / sigma0 = 1 + m d / (3 sqrt3 h) of a cylinder that does not harden (slab method)."""
    flow, radius, half = 300.0, 20.0, 5.0
    data = upset_cylinder(gradients={"by": ["tools.punch.m"]})
    data["workpiece"] = {
        **data["workpiece"],
        "mesh": {"kind": "rectangle", "size": [radius, half], "cells": [24, 6], "pattern": "quad"},
    }
    data["materials"] = {
        "steel": {"young": 200e3, "poisson": 0.3, "hardening": {"law": "linear", "yield_stress": flow, "modulus": 0.0}}
    }
    data["tools"] = {"punch": {"profile": [[0, half], [60, half]], "contact": "shear", "m": 0.005}}
    data["stages"] = [{"name": "upset", "tools": {"punch": {"stroke": 0.2, "direction": [0, -1]}}}]
    found = run_case(Case, data, tmp_path).history
    height, now = 2.0 * (half - 0.2), radius * np.sqrt(half / (half - 0.2))
    own = found["d(punch.force)/d(tools.punch.m)"][-1] / (np.pi * now**2) / flow
    assert own == pytest.approx(2.0 * now / (3.0 * np.sqrt(3.0) * height), rel=0.01)


@pytest.mark.parametrize(
    ("element", "friction", "by"),
    [
        (
            "hex8_fbar",
            {"contact": "coulomb", "mu": 0.1},
            {"materials.steel.young": 200e3, "tools.punch.mu": 0.1, "stages.0.tools.punch.stroke": 0.8},
        ),
        ("hex8_fbar", {"contact": "shear", "m": 0.2}, {"tools.punch.m": 0.2, "workpiece.mesh.size.0": 10.0}),
        ("tet4_mini", {"contact": "coulomb", "mu": 0.1}, {"materials.steel.hardening.K": 700.0}),
    ],
)
def test_block_in_space_has_the_derivatives_of_whole_runs(
    element: str, friction: dict[str, Any], by: dict[str, float], tmp_path: Path
) -> None:
    data = upset_block(element, friction)
    for key, columns in differentiate(SpaceCase, data, ["punch.force"], by, tmp_path).items():
        assert largest_error(*columns["punch.force"]) < 1e-6, key


@pytest.mark.parametrize(
    ("kind", "data", "by"),
    [
        (Case, upset_between_floating_tools(), {"tools.low.spring.preload": 2e3}),
        (SpaceCase, upset_with_floating_tools(), {"stages.0.tools.punch.force": 1.8e5}),
    ],
    ids=["plane", "space"],
)
def test_tools_that_float_have_the_derivatives_of_whole_runs(
    kind: type[Case | SpaceCase], data: dict[str, Any], by: dict[str, float], tmp_path: Path
) -> None:
    of = ["punch.stroke", "low.stroke"]
    for key, columns in differentiate(kind, data, of, by, tmp_path).items():
        for name, (own, other) in columns.items():
            assert largest_error(own, other) < 1e-6, (key, name)


@pytest.mark.parametrize(
    ("kind", "data", "by"),
    [
        (Case, upset_hot(), {"materials.steel.thermal.conductivity": 30.0, "materials.steel.heating.exponent": 0.8}),
        (SpaceCase, upset_hot_block(), {"tools.punch.heat.conductance": 5.0}),
    ],
    ids=["plane", "space"],
)
def test_hot_forming_has_the_derivatives_of_whole_runs(
    kind: type[Case | SpaceCase], data: dict[str, Any], by: dict[str, float], tmp_path: Path
) -> None:
    """Forces, places and temperatures of steel that softens as it warms, staggered with its heat."""
    apart = {key: 3e-4 if key.endswith("exponent") else 1e-3 for key in by}
    of = ["punch.force", "core.temperature", "rim.x"]
    for key, columns in differentiate(kind, data, of, by, tmp_path, apart=apart).items():
        for name, (own, other) in columns.items():
            assert largest_error(own, other) < 1e-6, (key, name)


@pytest.mark.parametrize(
    ("press", "by"),
    [
        ({"kind": "crank", "stroke": 200.0, "rpm": 60.0, "rod_ratio": 0.1}, {"presses.press.rpm": 60.0}),
        ({"kind": "hydraulic", "velocity": 50.0, "power": 3.0}, {"presses.press.power": 3.0}),
    ],
)
def test_presses_have_the_derivatives_of_whole_runs(
    press: dict[str, Any], by: dict[str, float], tmp_path: Path
) -> None:
    found = differentiate(Case, upset_in_press(press), ["punch.force", "ram_speed"], by, tmp_path)
    for key, columns in found.items():
        for name, (own, other) in columns.items():
            assert largest_error(own, other) < 1e-6, (key, name)


@pytest.mark.validation
def test_strip_that_springs_back_has_the_derivatives_of_whole_runs(tmp_path: Path) -> None:
    hardening = {"law": "swift", "K": 500.0, "e0": 0.005, "n": 0.2}
    by = {
        "stages.0.rotation.0.angle": 20.0,
        "materials.steel.hardening.n": 0.2,
        "workpiece.section.thickness": 1.0,
    }
    for key, columns in differentiate(ShellCase, bend_strip(hardening), ["tip.z"], by, tmp_path).items():
        assert largest_error(*columns["tip.z"]) < 1e-6, key


@pytest.mark.parametrize("degrees", [7.0, 12.0])
def test_curvature_left_by_springback_follows_bending_by_the_closed_form(degrees: float, tmp_path: Path) -> None:
    """d left / d bent = 1 - (elastic / bent)^3 of a strip that does not harden, elastic = 2 flow / (E thickness).

    51 layers yield one after the other, and leave 1 % of it.
    """
    flow, young, length = 300.0, 200e3, 20.0
    data = bend_strip({"law": "linear", "yield_stress": flow, "modulus": 0.0}, angle=degrees, points=51)
    data["boundary"] = {
        "root": {"set": "left", "fix": ["x", "ry", "rz"]},
        "corner": {"set": "bottom_left", "fix": ["z"]},
        "middle": {"set": "bottom", "hold": "symmetry_y"},
    }
    data |= {"points": {"tip": [length, 0, 0]}, "gradients": {"of": ["tip.z"], "by": ["stages.0.rotation.0.angle"]}}
    found = run_case(ShellCase, data, tmp_path).history
    bent, elastic = np.radians(degrees) / length, 2.0 * flow / young
    height = abs(found["tip.z"][-1])
    left = brentq(lambda k: (1.0 - np.cos(k * length)) / k - height, 1e-6, bent)
    by_left = (length * np.sin(left * length) - height) / left
    own = abs(found["d(tip.z)/d(stages.0.rotation.0.angle)"][-1]) / by_left * np.degrees(length)
    assert own == pytest.approx(1.0 - (elastic / bent) ** 3, abs=0.015)


@pytest.mark.parametrize(
    ("data", "by", "rows"),
    [
        (bend_over_die(), {"blank.thickness": 1.0}, 28),
        pytest.param(
            draw_under_holder(),
            {"tools.die.mu": 0.1, "stages.0.tools.holder.force": 800.0},
            22,
            marks=pytest.mark.validation,
        ),
    ],
    ids=["bent", "held"],
)
def test_stamping_has_the_derivatives_of_whole_runs_through_springback(
    data: dict[str, Any], by: dict[str, float], rows: int, tmp_path: Path
) -> None:
    """Force, shape after release, thickness, draw-in and energies; other numbers in validation/test_gradients.py.

    Runs of other thickness are so near that no node comes to a tool between them.
    """
    apart = {key: 2e-5 if key == "blank.thickness" else 1e-3 for key in by}
    of = ["punch.force", "tip.x", "tip.z", "wall.thickness", "plastic_work", "external_work"]
    of += [f"{name}.draw_in" for name in data.get("draw_in", ())]
    for key, columns in differentiate(StampingCase, data, of, by, tmp_path, apart=apart).items():
        for name, (own, other) in columns.items():
            assert own.shape == (rows,)
            assert largest_error(own, other) < 1e-6, (key, name)


@pytest.mark.validation
def test_hot_stamping_has_the_derivatives_of_whole_runs_through_dwells(tmp_path: Path) -> None:
    """Force, temperatures and shape; other numbers in validation/test_gradients.py.

    Forces round, so that runs farther apart tell more of them; temperatures have a corner where a node begins to touch.
    """
    key = "heat.surroundings.emissivity"
    for apart, of in ((3e-3, ["punch.force", "tip.z"]), (1e-3, ["temperature_mean", "wall.temperature"])):
        folder = tmp_path / f"{apart:g}"
        folder.mkdir()
        found = differentiate(StampingCase, stamp_hot(), of, {key: 0.8}, folder, apart={key: apart})
        for name, (own, other) in found[key].items():
            assert largest_error(own, other) < 1e-6, name


@pytest.mark.validation
def test_line_of_operations_has_the_derivatives_of_whole_runs_through_trimming(tmp_path: Path) -> None:
    """Forces of both operations, and energies; other numbers in validation/test_gradients.py."""
    of = ["bend_punch.force", "again_punch.force", "elastic_energy", "external_work"]
    by = {"materials.steel.hardening.K": 565.0}
    found = differentiate(StampingCase, bend_twice(), of, by, tmp_path, apart=dict.fromkeys(by, 1e-4))
    for name, (own, other) in found["materials.steel.hardening.K"].items():
        assert own[-1] != 0.0 or name.endswith("force")
        assert largest_error(own, other) < 1e-6, name


@pytest.mark.parametrize(
    ("kind", "data", "of", "by"),
    [
        (
            Case,
            with_inertia(upset_cylinder(points={"rim": [9.5, 0.5]}, solver=EVEN), 5e-5),
            "rim.x",
            {"materials.steel.density": 7.85e-9, "solver.damping": 1000.0},
        ),
        (
            ShellCase,
            with_inertia(bend_strip({"law": "swift", "K": 565.0, "e0": 0.007, "n": 0.26}), 2e-3),
            "tip.z",
            {"stages.0.duration": 2e-3},
        ),
    ],
    ids=["solid", "shell"],
)
def test_runs_with_inertia_have_the_derivatives_of_whole_runs(
    kind: type[Case | ShellCase], data: dict[str, Any], of: str, by: dict[str, float], tmp_path: Path
) -> None:
    for key, columns in differentiate(kind, data, [of], by, tmp_path).items():
        assert largest_error(*columns[of]) < 1e-6, key


HAMMER = {"kind": "hammer", "energy": 0.06, "velocity": 6e3, "efficiency": 0.8}
HYDRAULIC = {"kind": "hydraulic", "velocity": 100.0, "force": 1.4e5}


@pytest.mark.parametrize(
    ("data", "by"),
    [
        (upset_until(HAMMER, blows=2), {"presses.press.energy": 0.06, "tools.punch.m": 0.2}),
        (upset_until(HYDRAULIC), {"presses.press.force": 1.4e5, "materials.steel.hardening.K": 700.0}),
    ],
    ids=["blows", "limit of force"],
)
def test_stages_that_energy_or_force_ends_have_the_derivatives_of_whole_runs(
    data: dict[str, Any], by: dict[str, float], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Whole runs end nearer to what ends them than they need to, and take increments as long as they like."""
    monkeypatch.setattr(ram, "SPENT", 1e-9)
    monkeypatch.setattr(ram, "UNSURE", 1e9)
    for key, columns in differentiate(Case, data, ["punch.stroke", "rim.x"], by, tmp_path).items():
        for name, (own, other) in columns.items():
            assert abs(other[-1]) > 0.0, (key, name)
            assert largest_error(own, other) < 1e-6, (key, name)


@pytest.mark.parametrize("ends", ["energy", "force"])
def test_stroke_depends_on_energy_and_limit_of_force_by_the_closed_form(ends: str, tmp_path: Path) -> None:
    """Of a cylinder without friction and hardening: s V ln(h0 / h) = eta E, and F = s V / h."""
    flow, height, volume = 300.0, 30.0, np.pi * 10.0**2 * 30.0
    data = upset_until(HAMMER | {"energy": 0.4} if ends == "energy" else HYDRAULIC | {"force": 1.05e5})
    steel = {
        "magnitudes": "any",
        "young": 2e6,
        "poisson": 0.3,
        "hardening": {"law": "linear", "yield_stress": flow, "modulus": 0.0},
    }
    number, by = f"presses.press.{ends}", "materials.steel.hardening.yield_stress"
    data |= {"materials": {"steel": steel}, "gradients": {"by": [number, by], "of": ["punch.stroke"]}}
    data["tools"]["punch"] = {"profile": [[0, 15], [30, 15]], "contact": "frictionless"}
    data["stages"][0]["tools"]["punch"]["stroke"] = 5.0
    history = run_case(Case, data, tmp_path).history
    if ends == "energy":
        taken = 0.8 * 0.4e6
        now = height * np.exp(-taken / (flow * volume))
        wanted = {number: 0.5 * now * 0.8e6 / (flow * volume), by: -0.5 * now * taken / (flow**2 * volume)}
    else:
        now = flow * volume / 1.05e5
        wanted = {number: 0.5 * now / 1.05e5, by: -0.5 * volume / 1.05e5}
    assert history["punch.stroke"][-1] == pytest.approx(0.5 * (height - now), rel=5e-3)
    for key, value in wanted.items():
        assert history[name_derivative("punch.stroke", key)][-1] == pytest.approx(value, rel=2e-3), key


@pytest.mark.parametrize("dimension", [2, 3])
def test_dependence_of_friction_on_area_is_in_the_tangent(dimension: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """So a neighbour is evaluated twice an increment, in the plane, where it was three times."""
    data = upset_cylinder() if dimension == 2 else upset_block("hex8_fbar", {"contact": "shear", "m": 0.2})
    asked = {"gradients": {"by": ["tools.punch.m"]}, "solver": {"initial_increment": 0.1, "max_increment": 0.1}}
    model = build_model((Case if dimension == 2 else SpaceCase).model_validate({**data, **asked}))
    found = count_evaluations(begin(model, threads=1))
    tools = PlaneTools if dimension == 2 else SpaceTools
    monkeypatch.setattr(tools, "find_area_blocks", Led.find_area_blocks)
    assert found < count_evaluations(begin(model, threads=1))
    assert dimension == 3 or found == 8


def count_evaluations(recording: Any) -> int:
    """Return how often a neighbour's cells are evaluated in four increments."""
    mechanics, count = recording.derivatives.sides[-1].procedure.mechanics, 0
    evaluate = mechanics.evaluate

    def counted(*given: Any, **named: Any) -> Any:
        nonlocal count
        count += 1
        return evaluate(*given, **named)

    mechanics.evaluate = counted
    for report in recording.run.procedure.advance():
        if report.number == 4:
            break
    return count
