# SPDX-License-Identifier: Apache-2.0
"""Heat in a sheet against closed forms: through the thickness, in the plane, by radiation, with latent heat."""

import numpy as np
import pytest

from presswork.body.sheet_heat import SheetConduction
from presswork.evolution.kinetics import Kinetics
from presswork.interaction.heat.heat_films import Film, RadiationFilm, ToolFilm
from presswork.model import FloatArray, Radiation, Thermal, Transformation
from tests.problems.heat import fit_order, radiate

DENSITY, SPECIFIC_HEAT, THICKNESS = 7830e-12, 650e6, 1.5
KELVIN = 273.15
BETWEEN_DIES = {0.5: 719.39, 1.0: 573.44, 2.0: 373.22, 4.0: 181.76}
"""Middle of a sheet of 1.5 mm, 900 to 75 degrees C, 2000 W/(m2 K) on both sides, by time: the series' closed form."""


def steel(conductivity: float) -> Thermal:
    return Thermal(
        density=DENSITY,
        conductivity=np.array([[0.0, conductivity]]),
        specific_heat=np.array([[0.0, SPECIFIC_HEAT]]),
    )


def flat(
    nx: int, ny: int, length: float, levels: int, kinetics: Kinetics | None = None, conductivity: float = 25.0
) -> SheetConduction:
    """Return a flat sheet, as wide as an element is long times ny."""
    x, y = np.meshgrid(np.linspace(0, length, nx + 1), np.linspace(0, ny * length / nx, ny + 1), indexing="ij")
    points = np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)])
    number = np.arange(x.size, dtype=np.int32).reshape(x.shape)
    cells = np.stack([number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]], axis=-1).reshape(-1, 4)
    return SheetConduction(points, cells, steel(conductivity), THICKNESS, levels, kinetics)


class Face:
    """A film of all nodes on a face."""

    def __init__(self, film: Film, level: int) -> None:
        self.kind, self.level, self._film = film.kind, level, film.at(0.0)

    def evaluate(self, temperature: FloatArray) -> tuple[FloatArray, FloatArray]:
        return self._film.evaluate(temperature)


def dies(sheet: SheetConduction, conductance: float = 2.0) -> list[Face]:
    nodes = np.arange(sheet.n_points, dtype=np.int32)
    film = ToolFilm(nodes, sheet.area * conductance, 75.0)
    return [Face(film, level) for level in (0, -1)]


def quench(levels: int, steps: int) -> tuple[FloatArray, float]:
    """Return the errors in the middle at the times of BETWEEN_DIES [K], and the balance of heat."""
    sheet = flat(2, 2, 4.0, levels)
    start = np.full((levels, sheet.n_points), 900.0)
    temperature, fractions, dt, given, errors = start, np.zeros((4, *start.shape)), 4.0 / steps, 0.0, []
    for step in range(1, steps + 1):
        found = sheet.step(temperature, fractions, dt, dies(sheet), np.zeros_like(start))
        assert found is not None
        temperature, given = found.temperature, given + dt * found.power["tools"]
        time = 4.0 * step / steps
        if time in BETWEEN_DIES:
            errors.append(float(temperature[levels // 2].mean()) - BETWEEN_DIES[time])
    stored = float((sheet.content(temperature) - sheet.content(start)).sum())
    return np.array(errors), abs(stored / given - 1.0)


def test_sheet_between_dies() -> None:
    errors, balance = quench(9, 1280)
    assert np.abs(errors).max() < 0.3
    assert balance < 1e-12


def test_five_levels_are_within_a_kelvin() -> None:
    errors, _ = quench(5, 1280)
    assert np.abs(errors).max() < 0.8


def test_sheet_between_dies_converges_in_time() -> None:
    errors = [np.abs(quench(33, steps)[0]).max() for steps in (40, 80, 160)]
    assert fit_order([4.0, 2.0, 1.0], errors) == pytest.approx([1.0, 1.0], abs=0.1)


def test_sheet_between_dies_converges_in_levels() -> None:
    fine = quench(65, 320)[0][0]
    errors = [abs(quench(levels, 320)[0][0] - fine) for levels in (3, 5, 9)]
    assert fit_order([4.0, 2.0, 1.0], errors) == pytest.approx([2.0, 2.0], abs=0.15)


def spread(nx: int, steps: int) -> float:
    """Return the error of a cosine along a strip of 40 mm after 10 s [K]; its amplitude was 100 K."""
    sheet = flat(nx, 1, 40.0, 2)
    x = np.linspace(0, 40, nx + 1).repeat(2)
    temperature = np.tile(500.0 + 100.0 * np.cos(np.pi * x / 40.0), (2, 1))
    fractions = np.zeros((4, *temperature.shape))
    for _ in range(steps):
        found = sheet.step(temperature, fractions, 10.0 / steps, [], np.zeros_like(temperature))
        assert found is not None
        temperature = found.temperature
    decay = np.exp(-25.0 / (DENSITY * SPECIFIC_HEAT) * (np.pi / 40.0) ** 2 * 10.0)
    return float(np.abs(temperature - 500.0 - 100.0 * decay * np.cos(np.pi * x / 40.0)).max())


def test_conduction_in_the_plane_converges() -> None:
    assert spread(80, 400) < 0.05
    errors = [spread(nx, 2000) for nx in (5, 10, 20)]
    assert fit_order([4.0, 2.0, 1.0], errors) == pytest.approx([2.0, 2.0], abs=0.25)


def test_conduction_in_the_plane_keeps_heat_and_knows_no_overshoot() -> None:
    sheet = flat(40, 2, 40.0, 3)
    temperature = np.where(np.arange(sheet.n_points) < sheet.n_points // 2, 900.0, 100.0)[None].repeat(3, axis=0)
    before = sheet.content(temperature).sum()
    for dt in (1e-6, 1e-2, 1.0, 100.0):
        found = sheet.step(temperature, np.zeros((4, *temperature.shape)), dt, [], np.zeros_like(temperature))
        assert found is not None
        temperature = found.temperature
        assert temperature.min() >= 100.0 - 1e-3
        assert temperature.max() <= 900.0 + 1e-3
    assert sheet.content(temperature).sum() == pytest.approx(before, rel=1e-12)


def test_sheet_that_radiates_follows_the_closed_form() -> None:
    """Even temperature: rho c t dT/dt = -2 eps sigma (T^4 - Ta^4)."""
    sheet, levels = flat(2, 2, 4.0, 5, conductivity=2500.0), 5
    entry = Radiation("", 0.8, np.array([[0.0, 25.0]]))
    films = [Face(RadiationFilm(entry, sheet.area), level) for level in (0, -1)]
    temperature = np.full((levels, sheet.n_points), 950.0)
    for _ in range(3000):
        found = sheet.step(temperature, np.zeros((4, *temperature.shape)), 0.002, films, np.zeros_like(temperature))
        assert found is not None
        temperature = found.temperature
    time = radiate(950.0 + KELVIN, 25.0 + KELVIN, 2 * 0.8 * 5.670374419e-11 / (DENSITY * SPECIFIC_HEAT * THICKNESS))
    assert time(sheet.mean(temperature) + KELVIN) == pytest.approx(6.0, rel=1e-3)


def test_latent_heat_of_martensite_is_that_of_its_fraction() -> None:
    """Heat given away = m c (T0 - T) + m L M, with M by Koistinen and Marburger at the end."""
    latent = 82e9
    kinetics = Kinetics(Transformation(martensite_start=410.0, latent_heat=(0.0, 0.0, 0.0, latent)))
    sheet = flat(2, 2, 4.0, 5, kinetics)
    start = np.full((5, sheet.n_points), 600.0)
    temperature, fractions, given = start, np.zeros((4, *start.shape)), 0.0
    for _ in range(200):
        found = sheet.step(temperature, fractions, 0.05, dies(sheet), np.zeros_like(start))
        assert found is not None
        temperature, fractions, given = found.temperature, found.fractions, given + 0.05 * found.power["tools"]
    assert fractions[3] == pytest.approx(1.0 - np.exp(-0.011 * (410.0 - temperature)))
    mass = float(sheet.mass.sum())
    martensite = sheet.mean(fractions[3])
    wanted = mass * SPECIFIC_HEAT * (600.0 - sheet.mean(temperature)) + mass * latent * martensite
    assert -given == pytest.approx(wanted, rel=1e-10)
    assert martensite > 0.95
