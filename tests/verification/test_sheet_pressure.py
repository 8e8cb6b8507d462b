# SPDX-License-Identifier: Apache-2.0
"""Pressure on a sheet between tools: bulges against membrane theory, explicit against implicit, energies."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from presswork import Result
from tests.problems.bulges import OIL, measure_bulge, read_membrane, vary_bulge
from tests.regression.whole_runs import run_stamping


def run_bulge(folder: Path, *changes: tuple[str, object]) -> Result:
    return run_stamping(vary_bulge(*changes), folder)


@pytest.mark.parametrize(("n", "p", "highest"), [(0.5, 1.5, 0.6), (0.2, 1.86, 0.5)])
def test_a_bulge_follows_membrane_theory(tmp_path: Path, n: float, p: float, highest: float) -> None:
    """Pressure and thickness of the pole within 0.6 % (own integration, 80 elements, no elasticity) as the pole rises;
    the energies close within 0.05 %.
    """
    table = read_membrane(n)
    rows = (table.height > 0.3) & (table.height < highest)
    changes = [("materials.sheet.hardening.n", n), ("stages.0.pressure.oil.p", p)]
    bulge = run_bulge(tmp_path / "out", *changes)
    pressure, pole = measure_bulge(bulge, table.height[rows])
    np.testing.assert_allclose(pressure, table.pressure[rows], rtol=0.006)
    np.testing.assert_allclose(pole, table.pole[rows], rtol=0.006)
    assert not bulge.summary["sheet_pressures"]["oil"]["passed"]
    assert abs(bulge.history["energy_error_percent"][-1]) < 0.05


def test_explicit_and_implicit_bulge_alike(tmp_path: Path) -> None:
    """Pressure at the same height and thickness of the pole within 1 %; explicit energies close within 1e-3 %."""
    heights = np.array([0.45, 0.5, 0.55, 0.6])
    implicit = run_bulge(tmp_path / "implicit")
    explicit = run_bulge(tmp_path / "explicit", ("procedure", "explicit"), ("stages.0.duration", 0.02))
    for one, other in zip(measure_bulge(explicit, heights), measure_bulge(implicit, heights), strict=True):
        np.testing.assert_allclose(one, other, rtol=0.01)
    history = explicit.history
    assert np.abs(history["energy_error_percent"]).max() < 1e-3
    last = history["kinetic_energy"][-1] / history["internal_energy"][-1]
    assert last < 1e-3
    for run in (implicit, explicit):
        work = np.trapezoid(run.history["pressure.oil.p"], run.history["pressure.oil.volume"])
        external = run.history["external_energy" if run is explicit else "external_work"][-1]
        assert 4.0 * external == pytest.approx(work, rel=5e-3), "work is the pressure times the volume, of the whole"


BY_VOLUME = (
    ("blank.element_size", 2.5),
    ("materials.sheet.hardening.n", 0.2),
    ("pressure.oil", OIL),
    ("stages.0.pressure.oil", {"inflow": "160 cm^3"}),
)


def test_a_fluid_takes_a_bulge_past_the_maximum_of_its_pressure(tmp_path: Path) -> None:
    """The maximum within 0.3 % of membrane theory's 0.95279 K t0/a, at a height of 0.611 a within 3 %; pressure and
    thickness of the pole on both sides of it within 0.3 %; the energies close within 0.05 %.
    """
    table = read_membrane(0.2)
    rows = (table.height > 0.3) & (table.height < 0.7)
    bulge = run_bulge(tmp_path / "out", *BY_VOLUME)
    pressure, pole = measure_bulge(bulge, table.height[rows])
    np.testing.assert_allclose(pressure, table.pressure[rows], rtol=0.003)
    np.testing.assert_allclose(pole, table.pole[rows], rtol=0.003)
    height, every = bulge.history["pressure.oil.height"], bulge.history["pressure.oil.p"] / 2.0
    assert every.max() == pytest.approx(0.95279, rel=0.003)
    assert height[np.argmax(every)] == pytest.approx(0.611 * 50.0, rel=0.03)
    assert height[-1] > 34.0
    assert every[-1] < 0.99 * every.max()
    largest = bulge.summary["sheet_pressures"]["oil"]
    assert largest["passed"]
    assert largest["height_mm"] == pytest.approx(0.611 * 50.0, rel=0.03)
    assert abs(bulge.history["energy_error_percent"][-1]) < 0.05


@pytest.mark.validation
def test_explicit_and_implicit_bulge_by_volume_alike(tmp_path: Path) -> None:
    """Pressure and pole thickness within 1 % up to the maximum, pressure within 1 % beyond it, too."""
    heights = np.array([0.4, 0.45, 0.5, 0.55, 0.6, 0.65])
    implicit = run_bulge(tmp_path / "implicit", *BY_VOLUME)
    by_cycles = (("procedure", "explicit"), ("stages.0.duration", 0.02), ("explicit", {"damping": 1000}))
    explicit = run_bulge(tmp_path / "explicit", *BY_VOLUME, *by_cycles)
    (p, t), (p_implicit, t_implicit) = (measure_bulge(run, heights) for run in (explicit, implicit))
    np.testing.assert_allclose(p, p_implicit, rtol=0.01)
    np.testing.assert_allclose(t[:-1], t_implicit[:-1], rtol=0.01)
    assert np.abs(explicit.history["energy_error_percent"]).max() < 1e-3
    assert explicit.history["damping_energy"][-1] < 0.005 * explicit.history["internal_energy"][-1]


@pytest.mark.parametrize("procedure", ["implicit", "explicit"])
def test_a_fluid_in_a_rigid_space_is_compressed_by_its_stiffness(tmp_path: Path, procedure: str) -> None:
    """p = K ln(1.005) = 9.9751 MPa where 0.5 % flow into a space whose walls rest."""
    changes = [
        ("procedure", procedure),
        ("boundary", {"walls": {"set": "all", "hold": "clamped"}}),
        ("pressure.oil", OIL),
        ("stages.0", {"name": "fill", "duration": 1e-3, "pressure": {"oil": {"inflow": 1000.0}}}),
        ("output.rows", 10),
    ]
    history = run_bulge(tmp_path / "out", *changes).history
    assert history["pressure.oil.p"][-1] == pytest.approx(9.9751, rel=1e-5)
    assert abs(history["pressure.oil.volume"][-1]) < 1e-6


def test_the_radius_at_the_pole_is_that_of_its_sphere(tmp_path: Path) -> None:
    """An elastic bulge is a sphere near its pole: p = 2 t stress/radius within 2 %."""
    bulge = run_bulge(tmp_path / "out", ("blank.element_size", 2.5))
    stress = bulge.field("stress_middle_xx")[0]
    history = bulge.history
    p = 2.0 * history["pressure.oil.thickness"][-1] * stress / history["pressure.oil.radius"][-1]
    assert p == pytest.approx(history["pressure.oil.p"][-1], rel=0.02)
