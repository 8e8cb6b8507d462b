# SPDX-License-Identifier: Apache-2.0
"""Taylor bar: mesh study of both elements, of hourglass control, and of what a wall that does not pull changes."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from presswork import build_model
from presswork.case.space.schema import SpaceCase
from presswork.process.begin import begin
from tests.problems.explicit_solids import measure_taylor_bar, taylor_bar
from tests.verification.test_explicit_in_space import compare_taylor_bars

pytestmark = pytest.mark.validation


@cache
def strike(element: str, n: int, *, tied: bool = True, fraction: float = 0.05) -> dict[str, float]:
    run = taylor_bar(element, n, 10 * n, tied=tied, fraction=fraction)
    run.run_to(80e-6)
    found = measure_taylor_bar(run)
    balance = run.energies()
    assert abs(balance.error_percent) < 0.02
    print(element, n, "tied" if tied else "wall", fraction, {k: round(v, 3) for k, v in found.items()})
    return found


def test_taylor_bar_of_tetrahedra_is_that_of_axisymmetry() -> None:
    compare_taylor_bars("tet4_nodal")


@pytest.mark.parametrize("element", ["quad4_1pt", "tri3"])
def test_taylor_bar_converges_under_refinement(element: str) -> None:
    """5, 10, 20 cells over the radius: each change smaller than the last."""
    runs = [strike(element, n) for n in (5, 10, 20)]
    for name in ("length", "diameter", "strain", "temperature"):
        coarse, middle, fine = (run[name] for run in runs)
        assert abs(fine - middle) < abs(middle - coarse)


def test_both_elements_converge_to_one_bar() -> None:
    """At 20 cells over the radius diameter, length and strain agree within 0.1, 0.01 and 0.2 %."""
    quads, triangles = strike("quad4_1pt", 20), strike("tri3", 20)
    assert triangles["diameter"] == pytest.approx(quads["diameter"], rel=0.001)
    assert triangles["length"] == pytest.approx(quads["length"], rel=1e-4)
    assert triangles["strain"] == pytest.approx(quads["strain"], rel=0.002)


def test_hourglass_control_rules_the_foot_of_a_coarse_mesh() -> None:
    """Fractions of 0.05 to 1 take the diameter on 5 x 50 past the published 11.15 to 11.16."""
    diameters = [strike("quad4_1pt", 5, fraction=f)["diameter"] for f in (0.05, 0.3, 1.0)]
    assert diameters[0] > diameters[1] > diameters[2]
    assert diameters[0] > 11.155 > diameters[2]


def test_a_wall_that_does_not_pull_lets_the_foot_dimple_and_the_bar_fly_off() -> None:
    """The foot's centre leaves the wall at 1 us and closes again by 3 us: more strain; after 45 us the bar is off."""
    run = taylor_bar("quad4_1pt", 5, 50, tied=False)
    foot = run.mesh.node_sets["bottom"]
    centre = run.mesh.node_sets["bottom_left"]
    run.run_to(2e-6)
    assert run.position[centre, 1] > 0.05
    run.run_to(10e-6)
    assert np.abs(run.position[foot, 1]).max() < 1e-6
    run.run_to(80e-6)
    assert (run.position[foot, 1] > 0.5).all()
    free, tied = measure_taylor_bar(run), strike("quad4_1pt", 5)
    assert free["strain"] > 1.05 * tied["strain"]


def strike_in_space(**remesh: object) -> tuple[dict[str, float], list[str]]:
    """Return what is measured of a quarter of a bar of tetrahedra after 80 us, and what the log says of new meshes."""
    steel = {
        "young": "206.9 GPa", "poisson": 0.3, "density": "7830 kg/m^3",
        "hardening": {"law": "ludwik", "yield_stress": 806, "K": 614, "n": 0.168},
        "rate": {"law": "johnson_cook", "C": 0.0089, "reference_rate": 1},
        "heating": {"melting": 1540, "exponent": 1.1, "heat_capacity": "460 J/(kg*K)"},
    }  # fmt: skip
    mesh = {"kind": "cylinder", "radius": 3.2, "height": 32.4, "angle": 90, "cells": [4, 4, 32]}
    case = SpaceCase(
        title="a steel cylinder strikes an anvil at 287 m/s",
        analysis="solid",
        procedure="explicit",
        workpiece={"material": "steel", "element": "tet4_nodal", "velocity": [0, 0, "-287 m/s"], "mesh": mesh},
        materials={"steel": steel},
        tools={"anvil": {"shape": "plane", "normal": [0, 0, 1], "contact": "frictionless"}},
        boundary={"x": {"set": "left", "fix": ["x"]}, "y": {"set": "bottom", "fix": ["y"]}},
        stages=[{"name": "impact", "duration": "80 us"}],
        output={"steps": 1, "rows": 160},
        remesh=remesh,
    )
    run, notes = begin(build_model(case), 1), []
    for report in run.advance():
        row = run.row(report)
        notes += [line for line in run.log_lines(report) if "remesh" in line]
    found = {
        "length": row["z_max"] - row["z_min"],
        "foot": row["x_max"],
        "strain": float(run.solids.equivalent_plastic_strain.max()),
        "damage": row["damage_cockcroft_latham_max"],
    }
    print(found, *notes, sep="\n")
    return found, notes


def test_a_bar_of_tetrahedra_on_new_meshes_is_that_on_one() -> None:
    pytest.importorskip("mmgpy", reason="new meshes in space are made by mmgpy")
    (one, _), (new, notes) = strike_in_space(enabled=False), strike_in_space(every=0.25, size=1.0, smallest_size=0.5)
    assert len(notes) >= 3
    for name, within in (("length", 0.002), ("foot", 0.005), ("strain", 0.05), ("damage", 0.05)):
        assert new[name] == pytest.approx(one[name], rel=within), name
