# SPDX-License-Identifier: Apache-2.0
"""Porous metals in explicit dynamics and in space, against the implicit procedure in the plane and in axisymmetry."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from presswork import build_model, read_case, run_model
from presswork.case.errors import CaseError
from presswork.explicit.arrays import SolidArrays
from presswork.explicit.input_checks import ExplicitError
from presswork.law.history import POROSITY
from presswork.mesh.make.box import node_volumes
from presswork.process.explicit.begin_forming import begin_explicit_forming
from tests.regression.whole_runs import assert_same_bits, run_in_two_parts, run_to_end
from tests.verification.test_gtn import NECK, notch, pull_notched, read

DENSITY = 'density = "7800 kg/m^3"'


def find_porosity(solids):
    """Return the porosity of the cells of the first block (n_cells,)."""
    return solids.kept[0].of(POROSITY, solids.points[0])[:, 0]


def read_explicit(folder, *, duration: float = 3e-4, element: str = "quad4_1pt", rows: int = 50, **given):
    """Return the case of test_gtn.read, computed by explicit dynamics in `duration` [s], a fifth of it a ramp."""
    text = read(folder, **given).source.read_text()
    text = text.replace("analysis =", 'procedure = "explicit"\nanalysis =', 1).replace("quad4_fbar", element)
    text = text.replace("poisson = 0.3", f"poisson = 0.3\n{DENSITY}")
    text = text.replace('name = "pull"', f'name = "pull"\nduration = {duration}\nramp = {0.2 * duration}')
    start, end = text.index("[solver]"), text.index("[output]")
    path = folder / "explicit.toml"
    path.write_text(text[:start] + text[end:].replace("[output]", f"[output]\nrows = {rows}"))
    return read_case(path)


@pytest.mark.parametrize("analysis", ["axisymmetric", "plane_strain"])
@pytest.mark.parametrize("element", ["quad4_1pt", "tri3"])
def test_pores_of_an_explicit_bar_grow_as_in_the_implicit_one(tmp_path, analysis: str, element: str) -> None:
    implicit = run_model(build_model(read(tmp_path, analysis, porosity=0.01)), tmp_path / "implicit", threads=1).result
    case = read_explicit(tmp_path, element=element, analysis=analysis, porosity=0.01)
    explicit = run_model(build_model(case), tmp_path / "explicit", threads=1).result
    exact = implicit.field("porosity")[0]
    assert exact > 0.0107
    np.testing.assert_allclose(explicit.field("porosity"), exact, rtol=5e-4)
    force = [result.history["top.force_y"][-1] for result in (implicit, explicit)]
    assert force[1] == pytest.approx(force[0], rel=1e-3)
    energy = explicit.summary["energy"]
    assert energy["internal"] + energy["kinetic"] == pytest.approx(energy["external"], rel=1e-5)


@pytest.mark.validation
def test_an_explicit_notched_strip_softens_as_the_implicit_one(tmp_path) -> None:
    """To an elongation of 0.8 mm, where the notch carries 5 % less than at its most; porosity averaged once a row."""
    implicit = pull_notched(tmp_path, "[8, 12]", 1.0)
    case = read_explicit(tmp_path, analysis="plane_strain", cells="[8, 12]", porosity=0.01, rows=100)
    path = case.source
    path.write_text(path.read_text().replace("value = 0.4", "value = 0.8"))
    model = build_model(read_case(path))
    history = run_model(replace(model, mesh=notch(model.mesh)), tmp_path / "out", threads=1).result.history
    force = np.interp([0.2, 0.4, 0.5, 0.6, 0.7, 0.8], history["top.displacement_y"], history["top.force_y"])
    np.testing.assert_allclose(force, implicit, rtol=0.03)
    np.testing.assert_allclose(force[:5], implicit[:5], rtol=0.012)


def test_an_explicit_porous_bar_goes_on_where_it_stopped(tmp_path) -> None:
    model = build_model(read_explicit(tmp_path, duration=1e-4))
    whole = run_to_end(model, tmp_path / "whole")
    parts = run_in_two_parts(model, tmp_path / "cut", 12, threads=(1, 2))
    assert_same_bits(parts.folder, whole.folder)


def test_new_meshes_of_an_explicit_bar_keep_its_pores(tmp_path) -> None:
    """A bar that necks, on its first mesh and on new ones: force and the largest porosity within 3 %."""
    found = []
    for number, more in enumerate(("", "[remesh]\nevery = 0.25\nsize = 0.7\n")):
        given = read_explicit(tmp_path, duration=6e-4, cells="[6, 9]", porosity=0.02, more=NECK + more).source
        case = read_case(given, ["stages.0.displacement.0.value=1.2"])
        outcome = run_model(build_model(case), tmp_path / str(number), threads=1)
        assert outcome.status == "completed", outcome.reason
        result = outcome.result
        porosity = result.field("porosity")
        found.append((result.history["top.force_y"][-1], porosity.max(), porosity.mean()))
    assert result.summary["remeshes"] >= 3
    assert found[0][1] > 0.023
    np.testing.assert_allclose(found[1], found[0], rtol=0.03)


def test_a_hot_matrix_is_softer_in_explicit_dynamics_too(tmp_path) -> None:
    """Halfway to melting the stress is that of half the flow stress, cold."""
    heating = "heating = {reference = 20, melting = 1520, exponent = 1, start = 770}"
    hot = read_explicit(tmp_path, porosity=0.01).source
    hot.write_text(hot.read_text().replace("poisson = 0.3", f"poisson = 0.3\n{heating}"))
    results = [run_model(build_model(read_case(hot)), tmp_path / "hot", threads=1).result]
    cold = read_explicit(tmp_path, porosity=0.01).source
    cold.write_text(cold.read_text().replace("K = 800", "K = 400"))
    results.append(run_model(build_model(read_case(cold)), tmp_path / "cold", threads=1).result)
    for name in ("effective_stress", "porosity"):
        np.testing.assert_allclose(results[0].field(name), results[1].field(name), rtol=1e-9)


IN_SPACE = """
title = "a porous bar is pulled in space"
analysis = "solid"
[workpiece]
material = "steel"
element = "{ELEMENT}"
{MESH}
[materials.steel]
young = 200e3
poisson = 0.3
hardening = {law = "swift", K = 800, e0 = 0.01, n = 0.15}
gtn = {porosity = 0.01, length = 3, coalescence = 0.05, failure = 0.2}
[boundary.x]
set = "left"
fix = ["x"]
[boundary.y]
set = "bottom"
fix = ["y"]
[boundary.z]
set = "back"
fix = ["z"]
[[stages]]
name = "pull"
displacement = [{set = "front", component = "z", value = 0.4}]
[solver]
initial_increment = 0.01
max_increment = 0.02
"""
BOX = 'mesh = {kind = "box", size = [4, 4, 6], cells = [2, 2, 3]}'


def write_in_space(folder: Path, element: str = "hex8_fbar") -> Path:
    """Return the path of a case of a bar 4 x 4 x 6 mm."""
    path = folder / "space.toml"
    path.write_text(IN_SPACE.replace("{ELEMENT}", element).replace("{MESH}", BOX))
    return path


@pytest.mark.parametrize("element", ["hex8_fbar", pytest.param("tet10", marks=pytest.mark.validation)])
def test_pores_of_a_bar_in_space_grow_as_in_axisymmetry(tmp_path, element: str) -> None:
    round_bar = run_model(build_model(read(tmp_path, porosity=0.01)), tmp_path / "round", threads=1).result
    square = run_model(build_model(read_case(write_in_space(tmp_path, element))), tmp_path / "square", threads=1).result
    np.testing.assert_allclose(square.field("porosity"), round_bar.field("porosity")[0], rtol=1e-4)
    stress = round_bar.history["top.force_y"][-1] / (16.0 * np.pi)
    assert square.history["front.force_z"][-1] / 16.0 == pytest.approx(stress, rel=1e-4)


def write_explicit_in_space(folder: Path, element: str = "hex8_1pt", duration: float = 3e-4) -> Path:
    """Return the path of the bar of write_in_space, computed by explicit dynamics in `duration` [s]."""
    text = write_in_space(folder, element).read_text()
    text = text[: text.index("[solver]")].replace("analysis =", 'procedure = "explicit"\nanalysis =')
    text = text.replace("poisson = 0.3", f"poisson = 0.3\n{DENSITY}")
    path = folder / "explicit.toml"
    text = text.replace('name = "pull"', f'name = "pull"\nduration = {duration}\nramp = {0.2 * duration}')
    path.write_text(text + "[output]\nrows = 50\n")
    return path


@pytest.mark.parametrize(
    "element",
    ["tet4_nodal", *(pytest.param(name, marks=pytest.mark.validation) for name in ("hex8_1pt", "hex8_fbar"))],
)
def test_pores_of_an_explicit_bar_in_space_grow_as_in_the_implicit_one(tmp_path, element: str) -> None:
    """Porosity and force of the implicit procedure, and the balance of the metal's volume."""
    implicit = run_model(build_model(read_case(write_in_space(tmp_path))), tmp_path / "implicit", threads=1).result
    model = build_model(read_case(write_explicit_in_space(tmp_path, element)))
    explicit = run_model(model, tmp_path / "explicit", threads=1).result
    porosity, exact = explicit.field("porosity"), implicit.field("porosity")[0]
    assert exact > 0.0107
    np.testing.assert_allclose(porosity, exact, rtol=5e-4)
    force = [result.history["front.force_z"][-1] for result in (implicit, explicit)]
    assert force[1] == pytest.approx(force[0], rel=1e-3)
    volume = node_volumes(explicit.points(), model.mesh.blocks[0].connectivity).sum()
    elastic = explicit.field("stress")[:, :3].sum(axis=1).mean() * (1.0 - 2.0 * 0.3) / 200e3
    assert porosity.mean() == pytest.approx(1.0 - 0.99 / (volume / 96.0 * np.exp(-elastic)), rel=1e-4)
    energy = explicit.summary["energy"]
    assert energy["internal"] + energy["hourglass"] + energy["kinetic"] == pytest.approx(energy["external"], rel=1e-3)


def test_pores_in_space_are_averaged_over_their_length(tmp_path) -> None:
    """Cells of two porosities grow by the same mean where the length is that of the bar, each by its own below it."""
    grown = []
    for length in (30.0, 0.1):
        path = write_explicit_in_space(tmp_path)
        path.write_text(path.read_text().replace("length = 3", f"length = {length}"))
        run = begin_explicit_forming(build_model(read_case(path)))
        solids = run.solids
        state = solids.state_as_given()
        weak = solids.mesh.points[solids.mesh.blocks[0].connectivity].mean(axis=1)[:, 2] < 2.0
        state[SolidArrays].find_kept(0, POROSITY)[weak] = 0.02
        solids.take_state_as_given(state)
        run._compute_interval(0, 30)
        now = find_porosity(solids)
        grown.append([now[weak].mean() - 0.02, now[~weak].mean() - 0.01])
    assert grown[0][0] > 1e-5
    assert grown[0][0] == pytest.approx(grown[0][1], rel=0.02)
    assert grown[1][0] > 1.5 * grown[1][1]


@pytest.mark.validation
def test_an_explicit_porous_bar_in_space_goes_on_where_it_stopped(tmp_path) -> None:
    model = build_model(read_case(write_explicit_in_space(tmp_path, duration=1e-4)))
    whole = run_to_end(model, tmp_path / "whole")
    parts = run_in_two_parts(model, tmp_path / "cut", 12, threads=(1, 2))
    assert_same_bits(parts.folder, whole.folder)


@pytest.mark.validation
def test_new_meshes_of_an_explicit_bar_in_space_keep_its_pores(tmp_path) -> None:
    """On its first mesh and on three new ones: force, least, largest and mean porosity."""
    pytest.importorskip("mmgpy", reason="new meshes in space are made by mmgpy")
    found = []
    for number, more in enumerate(("enabled = false", "every = 0.25")):
        path = write_explicit_in_space(tmp_path, "tet4_nodal")
        text = path.read_text().replace("value = 0.4", "value = 1.0").replace("cells = [2, 2, 3]", "cells = [3, 3, 4]")
        path.write_text(text.replace("rows = 50", "rows = 20") + f"[remesh]\n{more}\n")
        result = run_model(build_model(read_case(path)), tmp_path / str(number), threads=1).result
        porosity = result.field("porosity")
        found.append((result.history["front.force_z"][-1], porosity.min(), porosity.max(), porosity.mean()))
    assert result.summary["remeshes"] == 3
    assert found[0][3] > 0.0115
    np.testing.assert_allclose(found[1], found[0], rtol=0.005)


def test_a_hot_matrix_is_softer_in_space_too(tmp_path) -> None:
    """Halfway to melting the stress is that of half the flow stress, cold."""
    found = []
    for old, new in (
        ("poisson = 0.3", "poisson = 0.3\nheating = {reference = 20, melting = 1520, exponent = 1, start = 770}"),
        ("K = 800", "K = 400"),
    ):
        path = write_explicit_in_space(tmp_path, duration=1e-4)
        path.write_text(path.read_text().replace(old, new))
        run = begin_explicit_forming(build_model(read_case(path)))
        for row in range(20):
            run._compute_interval(0, row)
        found.append((run.solids.stress[:, 2], find_porosity(run.solids)))
    assert found[0][0].min() > 100.0
    np.testing.assert_allclose(found[0], found[1], rtol=1e-9)


def test_devices_refuse_pores_in_space_by_name(tmp_path) -> None:
    model = build_model(read_case(write_explicit_in_space(tmp_path)))
    with pytest.raises(ExplicitError, match=r"'host' does not compute porous metals \(GTN\): take device"):
        begin_explicit_forming(replace(model, explicit=replace(model.explicit, device="host")))


@pytest.mark.parametrize(
    ("old", "new", "key"),
    [
        ('element = "hex8_fbar"', 'element = "tet4_mini"', "workpiece.element"),
        ('name = "pull"', 'name = "pull"\nduration = 1\n[heat]\ninitial_temperature = 20', "materials.steel.gtn"),
        ("poisson = 0.3", "poisson = 0.3\nrate = {law = 'cowper_symonds', D = 40, q = 5}", "materials.steel.rate"),
    ],
)
def test_pores_that_cannot_be_computed_in_space_are_refused(tmp_path, old: str, new: str, key: str) -> None:
    path = write_in_space(tmp_path)
    text = path.read_text()
    assert old in text
    if "[heat]" in new:
        text = text.replace(old, 'name = "pull"\nduration = 1') + "[heat]\ninitial_temperature = 20\n"
    else:
        text = text.replace(old, new)
    path.write_text(text)
    with pytest.raises(CaseError) as error:
        build_model(read_case(path))
    assert key in {problem.key for problem in error.value.problems}


def test_heat_of_an_explicit_porous_metal_is_refused(tmp_path) -> None:
    path = read_explicit(tmp_path).source
    path.write_text(path.read_text() + "[heat]\ninitial_temperature = 20\n")
    with pytest.raises(CaseError) as error:
        build_model(read_case(path))
    assert "materials.steel.gtn" in {problem.key for problem in error.value.problems}
