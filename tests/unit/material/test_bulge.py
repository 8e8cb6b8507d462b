# SPDX-License-Identifier: Apache-2.0
"""Flow curves of bulge tests, from points made by the formulas of a sphere and a known law."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from presswork.case.errors import CaseError
from presswork.cli import app
from presswork.cli.fit.bulge import fit_bulge
from presswork.material.bulge import BulgeSizes, is_bulge_test, read_bulge

YOUNG, POISSON = 206e3, 0.3
K, E0, N = 530.0, 0.002, 0.21
THICKNESS, OPENING, EDGE = 1.2, 100.0, 8.0
SIZES = BulgeSizes(THICKNESS, OPENING, EDGE)


def swift(p: np.ndarray) -> np.ndarray:
    return np.asarray(K * (E0 + p) ** N)


def points(ratio: float = 1.0) -> dict[str, np.ndarray]:
    """A sphere that thins by Hill's formula; its stress is `ratio` times that in tension after the same work [MPa, mm].

    Work: ratio sigma d(strain) = sigma dp, so p = ratio times the plastic strain through the thickness.
    """
    height = np.geomspace(1.0, 45.0, 150)
    strain = 2.0 * np.log1p((2.0 * height / OPENING) ** 2)
    stress = np.full_like(strain, 200.0)
    for _ in range(50):
        plastic = strain - 2.0 * POISSON * stress / YOUNG
        stress = ratio * swift(np.maximum(ratio * plastic, 0.0))
    radius = ((0.5 * OPENING + EDGE) ** 2 + height**2 - 2.0 * height * EDGE) / (2.0 * height)
    pole = THICKNESS * np.exp(-strain)
    return {
        "pressure": 2.0 * pole * stress / radius, "height": height, "radius": radius, "thickness": pole,
        "stress": stress, "plastic": plastic,
    }  # fmt: skip


def write(path: Path, columns: dict[str, np.ndarray], titles: list[str], *, comma: bool = False) -> Path:
    rows = [[f"{value:.9g}" for value in row] for row in zip(*columns.values(), strict=True)]
    lines = ["Bulge test 4711", ";".join(titles), *(";".join(row) for row in rows)]
    path.write_text("\n".join(lines).replace(".", ",") if comma else "\n".join(lines))
    return path


def test_measured_radius_and_thickness_give_the_stress_of_a_sphere(tmp_path) -> None:
    made = points()
    columns = {name: made[name] for name in ("pressure", "height", "radius", "thickness")}
    columns["pressure"] = 10.0 * columns["pressure"]
    path = write(tmp_path / "b.csv", columns, ["Druck [bar]", "Höhe [mm]", "radius [mm]", "Dicke [mm]"], comma=True)
    assert is_bulge_test(path)
    found = read_bulge(path, BulgeSizes(THICKNESS), YOUNG, POISSON)
    np.testing.assert_allclose(found.stress, made["stress"], rtol=1e-7)
    np.testing.assert_allclose(found.plastic_strain, made["plastic"], atol=1e-7)
    assert found.notes == ()


def test_height_alone_is_read_by_the_formulas_of_a_sphere_and_of_hill(tmp_path) -> None:
    made = points()
    path = write(tmp_path / "b.csv", {n: made[n] for n in ("pressure", "height")}, ["pressure", "height"])
    found = read_bulge(path, SIZES, YOUNG, POISSON)
    np.testing.assert_allclose(found.stress, made["stress"], rtol=1e-7)
    assert len(found.notes) == 2


def test_strains_along_and_across_give_r(tmp_path) -> None:
    """In-plane strains hold 2 (1 - nu) sigma / E of elastic strain."""
    made = points()
    both = made["plastic"] + 2.0 * (1.0 - POISSON) * made["stress"] / YOUNG
    columns = {**{n: made[n] for n in ("pressure", "height", "radius")}, "e1": both / 1.9, "e2": 0.9 * both / 1.9}
    path = write(tmp_path / "b.csv", columns, ["pressure", "height", "radius", "strain_1", "strain_2"])
    found = read_bulge(path, BulgeSizes(THICKNESS), YOUNG, POISSON)
    assert found.biaxial_r == pytest.approx(0.9, rel=1e-6)
    np.testing.assert_allclose(found.plastic_strain, made["plastic"], atol=1e-7)


@pytest.mark.parametrize("ratio", [1.0, 1.08])
def test_a_tensile_test_beside_it_gives_the_biaxial_stress_and_the_law_in_tension(tmp_path, capsys, ratio) -> None:
    made = points(ratio)
    columns = {n: made[n] for n in ("pressure", "height", "radius", "thickness")}
    bulge = write(tmp_path / "b.csv", columns, ["pressure", "height", "radius", "thickness"])
    p = np.linspace(0.001, 0.2, 60)
    tension = {"strain": p + swift(p) / YOUNG, "stress": swift(p)}
    tensile = write(tmp_path / "t.csv", tension, ["true strain", "true stress [MPa]"])
    fit_bulge(bulge, [tensile], "swift", (YOUNG, POISSON), BulgeSizes(THICKNESS), None)
    printed = re.search(r"balanced biaxial stress = (\S+) of that", capsys.readouterr().out)
    assert printed is not None
    assert float(printed[1]) == pytest.approx(ratio, abs=0.002)
    law = tomllib.loads((tmp_path / "b.toml").read_text())["material"]["hardening"]
    assert law["K"] == pytest.approx(K, rel=0.01)
    assert law["n"] == pytest.approx(N, abs=0.003)


@pytest.mark.parametrize(
    ("sizes", "columns", "remedy"),
    [
        (BulgeSizes(), ["pressure", "height", "radius", "thickness"], "--thickness"),
        (BulgeSizes(THICKNESS), ["pressure", "height", "thickness"], "--die-radius"),
        (BulgeSizes(THICKNESS), ["pressure", "height", "radius"], "strain_1"),
        (BulgeSizes(0.1 * THICKNESS), ["pressure", "height", "radius", "thickness"], "before the test"),
    ],
)
def test_what_is_missing_or_cannot_be_is_refused_with_a_remedy(tmp_path, sizes, columns, remedy) -> None:
    made = points()
    path = write(tmp_path / "b.csv", {n: made[n] for n in columns}, columns)
    with pytest.raises(CaseError, match=remedy):
        read_bulge(path, sizes, YOUNG, POISSON)


def test_bar_taken_for_megapascals_is_refused_with_the_unit(tmp_path) -> None:
    made = points()
    columns = {name: made[name] for name in ("pressure", "height", "radius", "thickness")}
    path = write(tmp_path / "b.csv", {**columns, "pressure": 10.0 * columns["pressure"]}, list(columns))
    with pytest.raises(CaseError, match=r"1 bar is 0\.1 MPa"):
        read_bulge(path, BulgeSizes(THICKNESS), YOUNG, POISSON)


def test_a_cell_without_a_number_is_named_by_its_line(tmp_path) -> None:
    path = tmp_path / "b.csv"
    path.write_text("pressure,height,radius,thickness\n1,2,300,1\n1.5,x,200,0.9\n2,5,100,0.8\n")
    with pytest.raises(CaseError, match='line 3, height = "x": expected a number'):
        read_bulge(path, BulgeSizes(1.0), YOUNG, POISSON)


def test_two_bulge_tests_at_once_are_refused(tmp_path) -> None:
    made = points()
    columns = ["pressure", "height", "radius", "thickness"]
    files = [str(write(tmp_path / f"{i}.csv", {n: made[n] for n in columns}, columns)) for i in (1, 2)]
    refused = CliRunner().invoke(app, ["material", "fit", *files, "--young", "206 GPa", "--thickness", "1.2"])
    assert refused.exit_code == 2
    assert "one after the other" in refused.output
