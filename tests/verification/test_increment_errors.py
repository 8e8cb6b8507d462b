# SPDX-License-Identifier: Apache-2.0
"""Increments follow their error: relaxation and creep of Norton bars by closed forms, at default settings."""

import copy
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from presswork import Case
from presswork.case import build_model
from presswork.case.shell.schema import ShellCase
from presswork.case.space.schema import SpaceCase
from presswork.case.stamping.schema import Implicit
from presswork.fields.shell_fields import sheet_effective_stress
from presswork.fields.solid_fields import effective_stress
from presswork.implicit.stepping import ImplicitProcedure
from presswork.model import Model, SolverSettings, Umat
from presswork.state import State
from tests.problems.sliding_arches import beams

YOUNG, POISSON, STRESS = 150e3, 0.3, 300.0
TIMES = np.array([0.01, 0.1, 1.0, 10.0, 100.0])
MIDDLES = {"x": {"set": "left", "fix": ["x"]}, "y": {"set": "bottom", "fix": ["y"]}}
SHEET = {"material": "m", "element": "shell4_mitc", "section": {"thickness": 1, "points": 3}}
PLANE = {"material": "m", "mesh": {"size": [1, 1], "cells": [1, 1]}}
CUBE = {"material": "m", "element": "hex8_fbar", "mesh": {"size": [1, 1, 1], "cells": [1, 1, 1]}}
FAMILIES: dict[str, Any] = {
    "axisymmetric": (Case, "top", "y", {"analysis": "axisymmetric", "workpiece": PLANE, "boundary": MIDDLES}),
    "plane": (  # held on all sides, so that the shear modulus takes the part of E/3
        Case, "top", "y", {"analysis": "plane_strain", "workpiece": PLANE,
                           "boundary": {**MIDDLES, "side": {"set": "right", "fix": ["x"]}}},
    ),
    "space": (
        SpaceCase, "right", "x", {"analysis": "solid", "workpiece": CUBE,
                                  "boundary": {**MIDDLES, "z": {"set": "back", "fix": ["z"]}}},
    ),
    "shell": (
        ShellCase, "right", "x", {"analysis": "shell", "workpiece": {**SHEET, "mesh": PLANE["mesh"]},
                                  "boundary": {**MIDDLES, "z": {"set": "all", "fix": ["z"]}}},
    ),
}  # fmt: skip


def norton(power: float, factor: float) -> dict[str, Any]:
    """Return the keys of a material that flows at the rate factor q^power [1/s]."""
    window = {"strain_window": [0, 5], "rate_window": [1e-12, 1e6], "temperature_window": [900, 1100]}
    hardening = {"law": "norton_hoff", "K": factor ** (-1 / power), "m": 1 / power, **window}
    return {"young": YOUNG, "poisson": POISSON, "heating": {"start": 1000}, "hardening": hardening}


def stretched_bar(
    family: str, power: float, factor: float, solver: dict[str, Any] | None = None, **material: Any
) -> Model:
    """Return a bar that is stretched in 1e-4 s and held for 100 s; with further keys of its material."""
    kind, end, component, keys = FAMILIES[family]
    pulls = [(1e-4, STRESS / YOUNG), (100.0, 1e-12)]
    stages = [
        {"name": name, "duration": time, "displacement": [{"set": end, "component": component, "value": value}]}
        for name, (time, value) in zip(("draw", "hold"), pulls, strict=True)
    ]
    data = {**copy.deepcopy(keys), "title": "bar", "materials": {"m": norton(power, factor) | material}}
    data |= {"stages": stages}
    return build_model(kind.model_validate({**data, "output": {"steps": 1}, "solver": solver or {}}))


def measure(state: State) -> float:
    """Return the effective stress of the first point [MPa]."""
    stress = state.cells.stress[0][0, 0]
    return float(sheet_effective_stress(stress) if len(stress) == 3 else effective_stress(stress))


def relax(procedure: ImplicitProcedure) -> tuple[np.ndarray, np.ndarray]:
    """Return times since the hold began [s] and stresses [MPa], from its beginning on."""
    times, stresses, begun = [0.0], [0.0], 0.0
    for report in procedure.advance():
        if report.stage == "draw":
            begun, stresses[0] = report.time, measure(procedure.state)
        else:
            times.append(report.time - begun)
            stresses.append(measure(procedure.state))
    return np.array(times), np.array(stresses)


@pytest.mark.parametrize(("power", "factor"), [(3.0, 1e-9), (5.0, 1e-13), (8.0, 2e-22)])
@pytest.mark.parametrize("family", FAMILIES)
def test_a_held_norton_bar_relaxes_as_the_closed_form_says(family: str, power: float, factor: float) -> None:
    """q^(1-n) = q0^(1-n) + (n-1) E A t, from 0.01 to 100 s."""
    times, stresses = relax(ImplicitProcedure(stretched_bar(family, power, factor), threads=1))
    modulus = 1.5 * YOUNG / (1 + POISSON) if family == "plane" else YOUNG
    exact = (stresses[0] ** (1 - power) + (power - 1) * modulus * factor * TIMES) ** (1 / (1 - power))
    assert np.interp(TIMES, times, stresses) == pytest.approx(exact, rel=0.01)
    assert len(times) < 160


@pytest.mark.parametrize("family", FAMILIES)
def test_a_norton_bar_of_a_user_law_relaxes_as_the_closed_form_says(family: str, umat_norton: Path) -> None:
    power, factor = 5.0, 1e-13
    bar = stretched_bar(family, power, factor)
    law = Umat(str(umat_norton), (YOUNG, POISSON, factor, power), 1)
    material = replace(bar.materials[0], hardening=None, heating=None, umat=law)
    times, stresses = relax(ImplicitProcedure(replace(bar, materials=(material,)), threads=1))
    modulus = 1.5 * YOUNG / (1 + POISSON) if family == "plane" else YOUNG
    exact = (stresses[0] ** (1 - power) + (power - 1) * modulus * factor * TIMES) ** (1 / (1 - power))
    assert np.interp(TIMES, times, stresses) == pytest.approx(exact, rel=0.01)


def test_a_hot_bar_relaxes_by_its_modulus_at_this_temperature() -> None:
    """40 % of the modulus at 20 degrees C: q^(1-n) = q0^(1-n) + (n-1) 0.4 E A t."""
    power, factor = 5.0, 1e-13
    bar = stretched_bar("axisymmetric", power, factor, young_factor=[[20, 1], [1000, 0.4]])
    times, stresses = relax(ImplicitProcedure(bar, threads=1))
    exact = (stresses[0] ** (1 - power) + (power - 1) * 0.4 * YOUNG * factor * TIMES) ** (1 / (1 - power))
    assert np.interp(TIMES, times, stresses) == pytest.approx(exact, rel=0.01)


def test_a_held_bar_bears_at_its_ends_what_it_bears_inside() -> None:
    procedure = ImplicitProcedure(stretched_bar("space", 5.0, 1e-13), threads=1)
    relax(procedure)
    held = float(procedure.state.nodes.reaction[procedure.model.mesh.node_sets["right"], 0].sum())
    assert held == pytest.approx(measure(procedure.state), rel=0.01)


def test_a_smaller_tolerance_takes_more_increments_and_comes_closer() -> None:
    off, counts = [], []
    for tolerance in (0.02, 0.002):
        solver = {"increment_tolerance": tolerance}
        times, stresses = relax(ImplicitProcedure(stretched_bar("axisymmetric", 5.0, 1e-13, solver), threads=1))
        exact = (stresses[0] ** -4.0 + 4.0 * YOUNG * 1e-13 * times[-1]) ** -0.25
        middle = (stresses[0] ** -4.0 + 4.0 * YOUNG * 1e-13 * times[1:]) ** -0.25
        off.append(float(np.abs(stresses[1:] / middle - 1.0).max()))
        counts.append(len(times))
        assert stresses[-1] == pytest.approx(exact, rel=0.01)
    assert off[1] < 0.2 * off[0]
    assert counts[1] > 2 * counts[0]


def test_a_bar_under_a_growing_load_creeps_as_the_closed_form_says() -> None:
    """A load that grows evenly for T seconds: A q^n T/(n + 1)."""
    power, duration, strain = 5.0, 100.0, 0.003
    factor = strain * (power + 1) / (duration * STRESS**power)
    keys = FAMILIES["axisymmetric"][3]
    load = {"name": "load", "duration": duration, "edge_force": [{"set": "top", "value": [0, STRESS]}]}
    data = {**copy.deepcopy(keys), "title": "bar", "materials": {"m": norton(power, factor)}, "stages": [load]}
    procedure = ImplicitProcedure(build_model(Case.model_validate(data)), threads=1)
    list(procedure.advance())
    exact = factor * measure(procedure.state) ** power * duration / (power + 1)
    assert float(procedure.state.cells.eqps[0].mean()) == pytest.approx(exact, rel=0.01)


def test_stampings_have_the_same_tolerance() -> None:
    assert Implicit().increment_tolerance == SolverSettings().increment_tolerance


def necking_bar(**solver: float) -> Model:
    """Return a quarter of Simo's bar on few cells, 1.8 % thinner in its middle, to be pulled by 13 mm."""
    hardening = {"law": "linear_voce", "yield_stress": 450, "saturation_stress": 715, "rate": 16.93, "modulus": 129.24}
    data = {
        "title": "neck",
        "analysis": "axisymmetric",
        "workpiece": {"material": "m", "mesh": {"size": [6.413, 26.667], "cells": [5, 12]}},
        "materials": {"m": {"young": 206.9e3, "poisson": 0.29, "hardening": hardening}},
        "boundary": MIDDLES,
        "stages": [{"name": "pull", "displacement": [{"set": "top", "component": "y", "value": 6.5}]}],
        "output": {"steps": 1},
        "solver": solver,
    }
    model = build_model(Case.model_validate(data))
    points = model.mesh.points.copy()
    points[:, 0] *= 1.0 - 0.018 * (1.0 - points[:, 1] / 26.667)
    return replace(model, mesh=replace(model.mesh, points=points))


def measure_neck(**solver: float) -> float:
    """Return the radius of the neck [mm]."""
    procedure = ImplicitProcedure(necking_bar(**solver), threads=1)
    list(procedure.advance())
    corner = procedure.model.mesh.node_sets["bottom_right"]
    return float((procedure.model.mesh.points + procedure.state.nodes.displacement)[corner, 0].item())


def test_a_neck_is_as_thin_as_with_short_increments() -> None:
    """The limit is extrapolated: the error is of first order in the length of increments."""
    coarse, fine = (measure_neck(increment_tolerance=0.9, initial_increment=i, max_increment=i) for i in (0.004, 0.002))
    limit = 2 * fine - coarse
    assert measure_neck() == pytest.approx(limit, rel=0.01)
    assert measure_neck(increment_tolerance=0.9) < 0.985 * limit


def test_an_upsetting_takes_no_more_increments_for_accuracy() -> None:
    counts, swift = [], {"law": "swift", "K": 600, "e0": 0.01, "n": 0.2}
    for tolerance in (0.005, 0.9):
        data = {
            "title": "upsetting", "analysis": "axisymmetric", "boundary": MIDDLES,
            "workpiece": {"material": "m", "mesh": {"size": [10, 15], "cells": [6, 6]}},
            "materials": {"m": {"young": 2e5, "poisson": 0.3, "hardening": swift}},
            "tools": {"punch": {"profile": [[0, 15], [40, 15]], "contact": "shear", "m": 0.3}},
            "stages": [{"name": "press", "tools": {"punch": {"move": [0, -8]}}}],
            "output": {"steps": 1}, "solver": {"increment_tolerance": tolerance},
        }  # fmt: skip
        counts.append(sum(1 for _ in ImplicitProcedure(build_model(Case.model_validate(data)), threads=1).advance()))
    assert counts[0] == counts[1]


def test_beams_that_unload_at_a_hinge_take_no_short_increments() -> None:
    """Two arches slide past each other: the load falls, and ever less of them flows, but nothing runs ahead."""
    counts = [
        sum(1 for _ in ImplicitProcedure(beams(0.0, SolverSettings(**keys), cells=(24, 2)), threads=1).advance())
        for keys in ({"symmetric": False}, {"symmetric": False, "increment_tolerance": 0.9})
    ]
    assert counts[0] < 1.2 * counts[1]
