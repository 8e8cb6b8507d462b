# SPDX-License-Identifier: Apache-2.0
"""Welded blanks against closed forms: strips in series (force balance of Hollomon's law), mass of zones."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from presswork import CaseError, build_model
from presswork.case.shell.schema import ShellCase
from presswork.case.stamping.schema import StampingCase
from presswork.model import FloatArray
from presswork.process.begin import begin
from tests.problems.welded_strips import STEEL, N, make_strips


def pull(case: Any) -> tuple[FloatArray, FloatArray, Any]:
    """Return mean thickness strains of the thin and of the thick strip, and the run."""
    model = build_model(case)
    run = begin(model, threads=1)
    for _ in run.advance():
        pass
    strain = run.sheet_fields(with_surface=False)["thickness_strain"]
    x = model.mesh.points[model.cells].mean(axis=1)[:, 0]
    return strain[x < 0.0], strain[x > 0.0], run


@pytest.mark.parametrize("procedure", ["implicit", "explicit"])
@pytest.mark.parametrize(("thicker", "strain"), [(1.2, 0.035271), (1.5, 0.010196)])
def test_strips_in_series_share_the_force_of_the_thin_one_at_its_maximum(procedure, thicker, strain) -> None:
    """t e^n exp(-e) is the same in both: when the thin one is at e = n, the thick one is at `strain`."""
    assert thicker * strain**N * np.exp(-strain) == pytest.approx(N**N * np.exp(-N), rel=1e-4)
    thin, thick, _ = pull(make_strips(procedure, thicker, strain))
    assert -thick.mean() == pytest.approx(strain, rel=0.01)
    assert -thin.mean() == pytest.approx(N, rel=0.01)


def test_thinning_of_a_zone_counts_from_its_own_thickness() -> None:
    """The thick strip ends thicker than the blank began, and thinned all the same."""
    _, thick, run = pull(make_strips("explicit", 1.5, 0.010196))
    thickest = run.show().sheet["thickness"].max()
    assert thickest == pytest.approx(1.5 * np.exp(-0.010196), rel=1e-3)
    assert run.show().forming["thinning"].min() == pytest.approx(1.01, rel=0.02)
    assert thick.max() < 0.0


@pytest.mark.parametrize("procedure", ["implicit", "explicit"])
def test_strip_of_stronger_steel_strains_less(procedure) -> None:
    """K t e^n exp(-e) is the same in both: 1.2 times the strength does what 1.2 times the thickness does."""
    strong = {"young": "210 GPa", "poisson": 0.3, "density": 7.85e-9,
              "hardening": {"law": "swift", "K": 24, "n": N, "e0": 1e-6}}  # fmt: skip
    case = make_strips(procedure, 1.0, 0.035271)
    zone = {"name": "strong", "line": [[0, -1], [0, 1]], "side": "right", "material": "strong"}
    data = case.model_dump(exclude_unset=True)
    data["blank"]["zones"], data["materials"]["strong"] = [zone], strong
    thin, thick, _ = pull(type(case).model_validate(data))
    assert -thick.mean() == pytest.approx(0.035271, rel=0.01)
    assert -thin.mean() == pytest.approx(N, rel=0.01)


@pytest.mark.parametrize("shape", ["rectangle", "circle"])
@pytest.mark.parametrize("angle", [0.0, 30.0, 90.0])
def test_mass_of_zones_on_both_sides_of_a_line_is_that_of_their_areas(shape, angle) -> None:
    """A line through the middle halves any blank, wherever its grid runs; rotary inertia is no mass."""
    along = (np.cos(np.radians(angle)), np.sin(np.radians(angle)))
    size = {"size": [60, 40]} if shape == "rectangle" else {"diameter": 50}
    zone = {"name": "thick", "line": [[0, 0], [float(along[0]), float(along[1])]], "side": "left", "thickness": 1.5}
    case = make_strips("explicit", 1.5, 0.1)
    data = case.model_dump(exclude_unset=True)
    data["boundary"], data["stages"] = {}, [{"name": "wait", "duration": 1e-6}]
    data["blank"] = {"shape": shape, "element_size": 3, "thickness": 1.0, "material": "steel", "zones": [zone], **size}
    run = begin(build_model(type(case).model_validate(data)), threads=1)
    mesh = run.mesh
    corners = mesh.points[mesh.corners][..., :2]
    x, y = corners[..., 0], corners[..., 1]
    area = 0.5 * (x * np.roll(y, -1, axis=1) - np.roll(x, -1, axis=1) * y).sum()
    assert run.blank_mass == pytest.approx(7.85e-9 * 1.25 * area, rel=1e-9)  # type: ignore[attr-defined]
    if shape == "rectangle":
        assert area == pytest.approx(60 * 40, rel=1e-12)


def shell_strips(**changes: Any) -> ShellCase:
    """Return a strip of 20 mm by 4 mm as shells under loads; its right half is 1.2 mm thick, the left 1 mm."""
    zone = {"name": "thick", "line": [[10, 0], [10, 4]], "side": "right", "thickness": 1.2}
    workpiece = {"material": "steel", "element": "shell4_mitc", "section": {"thickness": 1.0},
                 "mesh": {"size": [20, 4], "cells": [10, 2]}, "zones": [zone]}  # fmt: skip
    return ShellCase(
        title="strips", analysis="shell", workpiece=workpiece | changes.pop("workpiece", {}),
        materials={"steel": {key: value for key, value in STEEL.items() if key != "density"}},
        boundary={"wide": {"set": "all", "fix": ["y", "z"]}, "left": {"set": "left", "fix": ["x"]}},
        stages=[{"name": "pull", "displacement": [{"set": "right", "component": "x", "value": 2.572}]}],
        solver={"initial_increment": 0.01, "max_increment": 0.05}, output={"steps": 1}, **changes,
    )  # fmt: skip


def test_shells_under_loads_take_zones_too() -> None:
    """10 (e^0.2 - 1) + 10 (e^0.035271 - 1) = 2.573 mm of pull lead to the same strains."""
    model = build_model(shell_strips())
    assert model.zones == ("", "thick")
    run = begin(model, threads=1)
    for _ in run.advance():
        pass
    x = model.mesh.points[model.cells].mean(axis=1)[:, 0]
    strain = run.sheet_fields(with_surface=False)["thickness_strain"]  # type: ignore[attr-defined]
    assert -strain[x > 10].mean() == pytest.approx(0.035271, rel=0.01)
    assert -strain[x < 10].mean() == pytest.approx(N, rel=0.01)


def test_bad_zones_of_shells_are_refused_at_their_keys() -> None:
    zone = {"name": "z", "line": [[10, 0], [10, 4]], "side": "right", "thickness": 1.2}
    for change, words in (
        ({"line": [[30, 0], [30, 4]]}, "workpiece.zones.0.line"),
        ({"material": "stel"}, "workpiece.zones.0.material"),
        ({"thickness": 1e-3}, "workpiece.zones.0.thickness"),
    ):
        with pytest.raises(CaseError, match=words.replace(".", r"\.")):
            build_model(shell_strips(workpiece={"zones": [zone | change]}))


@pytest.mark.parametrize("procedure", ["implicit", "explicit"])
def test_rolled_strip_bears_one_force_along_its_table(procedure) -> None:
    """t e^n exp(-e) is the same in all sections of a strip from 1 mm to 1.3 mm, below the maximum of the force."""
    data = make_strips(procedure, 1.0, 0.05).model_dump(exclude_unset=True)
    del data["blank"]["zones"]
    data["blank"] |= {"thickness": [[-10, 1.0], [10, 1.3]], "element_size": 1}
    data["stages"][0]["displacement"][0]["value"] = 1.2
    model = build_model(StampingCase.model_validate(data))
    run = begin(model, threads=1)
    for _ in run.advance():
        pass
    strain = -run.sheet_fields(with_surface=False)["thickness_strain"]  # type: ignore[attr-defined]
    force = model.mesh.blocks[0].thickness * strain**N * np.exp(-strain)
    assert strain.max() > 2.0 * strain.min()
    assert force == pytest.approx(force.mean(), rel=0.005)
