# SPDX-License-Identifier: Apache-2.0
"""Recrystallisation and growth against Johnson, Mehl, Avrami and Kolmogorov's closed form, in one step and in two."""

from __future__ import annotations

import numpy as np
import pytest

from presswork import build_model, read_case, run_model
from presswork.case.errors import CaseError
from presswork.evolution.contract import PointChange
from presswork.evolution.grain import GAS, GrainLaw
from presswork.model import DynamicRecrystallisation, Grain, GrainGrowth, PowerLaw, Recrystallisation

Q = 312e3
CRITICAL = PowerLaw(A=5e-4, grain=0.3, rate=0.17, energy=0.17 * Q)
HALF = PowerLaw(A=2.5e-3, grain=0.3, rate=0.15, energy=0.15 * Q)
NEW_SIZE = PowerLaw(A=1.8e3, rate=-0.15, energy=-0.15 * Q)
STATIC_TIME = PowerLaw(A=1e-16, grain=2.0, strain=-2.0, energy=260e3)
STATIC_SIZE = PowerLaw(A=0.25, grain=0.67, strain=-1.0)
DYNAMIC = DynamicRecrystallisation(critical_strain=CRITICAL, half_strain=HALF, size=NEW_SIZE, exponent=2.0)
STATIC = Recrystallisation(half_time=STATIC_TIME, size=STATIC_SIZE, exponent=1.5)
LAW = Grain(initial=80.0, dynamic=DYNAMIC, static=STATIC, metadynamic=STATIC)


def value(law: PowerLaw, grain: float, strain: float, rate: float, celsius: float) -> float:
    kelvin = celsius + 273.15
    return law.A * grain**law.grain * strain**law.strain * rate**law.rate * np.exp(law.energy / (GAS * kelvin))


def fraction(over: float, exponent: float) -> float:
    return 1.0 - 0.5 ** (over**exponent)


def go(law: GrainLaw, steps, state=None) -> dict[str, np.ndarray]:
    """Take one point through steps of (strain, duration, temperature, increments)."""
    state = state or {name: np.array([start]) for name, start in law.at_rest().items()}
    stress = np.zeros((1, 4))
    for strain, duration, celsius, n in steps:
        for _ in range(n):
            warm, zero = np.array([celsius]), np.zeros(1)
            change = PointChange(stress, stress, zero, np.array([strain / n]), duration / n, warm, warm)
            state = law.advance(state, change)
    return state


@pytest.mark.parametrize("increments", [1, 7, 100])
def test_dynamic_recrystallisation_is_avramis_for_any_increments(increments: int) -> None:
    found = go(GrainLaw(LAW), [(0.8, 0.8, 1100.0, increments)])
    critical, half = (value(law, 80.0, 1.0, 1.0, 1100.0) for law in (CRITICAL, HALF))
    assert 0.1 < critical < 0.5
    exact = fraction((0.8 - critical) / half, 2.0)
    assert 0.2 < exact < 0.95
    assert found["recrystallised_fraction"][0] == pytest.approx(exact, rel=1e-10)
    size = value(NEW_SIZE, 80.0, 1.0, 1.0, 1100.0)
    assert found["grain_size"][0] == pytest.approx(exact * size + (1.0 - exact) * 80.0, rel=1e-10)


@pytest.mark.parametrize("increments", [1, 5, 50])
def test_static_recrystallisation_is_avramis_for_any_increments(increments: int) -> None:
    found = go(GrainLaw(LAW), [(0.1, 0.1, 1000.0, 4), (0.0, 2.0, 1000.0, increments)])
    exact = fraction(2.0 / value(STATIC_TIME, 80.0, 0.1, 1.0, 1000.0), 1.5)
    assert 0.1 < exact < 0.9
    assert found["recrystallised_fraction"][0] == pytest.approx(exact, rel=1e-10)
    size = value(STATIC_SIZE, 80.0, 0.1, 1.0, 1000.0)
    assert found["grain_size"][0] == pytest.approx(exact * size + (1.0 - exact) * 80.0, rel=1e-10)


def test_a_pause_at_two_temperatures_adds_up() -> None:
    """Scheil's rule in closed form: (t1/h1 + t2/h2)^k, h1 and h2 the times of the first half at each temperature."""
    law = GrainLaw(LAW)
    found = go(law, [(0.1, 0.1, 1000.0, 1), (0.0, 1.0, 1000.0, 3), (0.0, 1.5, 950.0, 4)])
    h1, h2 = (value(STATIC_TIME, 80.0, 0.1, 1.0, celsius) for celsius in (1000.0, 950.0))
    assert found["recrystallised_fraction"][0] == pytest.approx(fraction(1.0 / h1 + 1.5 / h2, 1.5), rel=1e-10)


def test_a_second_pass_begins_with_the_mean_grain_and_the_retained_strain() -> None:
    law = GrainLaw(LAW)
    found = go(law, [(0.1, 0.1, 1000.0, 1), (0.0, 1.0, 1000.0, 3), (0.1, 0.1, 1000.0, 5), (0.0, 1.0, 1000.0, 2)])
    first = fraction(1.0 / value(STATIC_TIME, 80.0, 0.1, 1.0, 1000.0), 1.5)
    grain = first * value(STATIC_SIZE, 80.0, 0.1, 1.0, 1000.0) + (1.0 - first) * 80.0
    strain = (1.0 - first) * 0.1 + 0.1
    second = fraction(1.0 / value(STATIC_TIME, grain, strain, 1.0, 1000.0), 1.5)
    size = second * value(STATIC_SIZE, grain, strain, 1.0, 1000.0) + (1.0 - second) * grain
    assert found["recrystallised_fraction"][0] == pytest.approx(second, rel=1e-10)
    assert found["grain_size"][0] == pytest.approx(size, rel=1e-10)
    assert found["total_plastic_strain"][0] == pytest.approx(0.2)


@pytest.mark.parametrize("increments", [1, 20])
def test_grains_grow_as_the_law_has_it(increments: int) -> None:
    growth = GrainGrowth(A=3.87e32, exponent=10.0, energy=400e3)
    found = go(GrainLaw(Grain(initial=50.0, growth=growth)), [(0.0, 60.0, 1200.0, increments)])
    exact = (50.0**10 + 3.87e32 * 60.0 * np.exp(-400e3 / (GAS * 1473.15))) ** 0.1
    assert exact > 60.0
    assert found["grain_size"][0] == pytest.approx(exact, rel=1e-10)


def test_metadynamic_follows_where_recrystallisation_has_begun() -> None:
    meta = Recrystallisation(half_time=PowerLaw(A=1.1, rate=-0.8), size=PowerLaw(A=30.0, rate=-0.1), exponent=1.0)
    law = GrainLaw(Grain(initial=80.0, dynamic=DYNAMIC, static=STATIC, metadynamic=meta))
    formed = go(law, [(0.8, 0.4, 1100.0, 3)])
    found = go(law, [(0.0, 0.3, 1100.0, 4)], formed)
    x = fraction(0.3 / (1.1 * 2.0**-0.8), 1.0)
    dynamic = formed["recrystallised_fraction"][0]
    assert 0.1 < dynamic < 0.95
    assert found["recrystallised_fraction"][0] == pytest.approx(1.0 - (1.0 - dynamic) * (1.0 - x), rel=1e-10)
    assert found["grain_size"][0] == pytest.approx(
        x * 30.0 * 2.0**-0.1 + (1.0 - x) * formed["grain_size"][0], rel=1e-10
    )


CASE = """
title = "two blows with a pause"
analysis = "axisymmetric"
[workpiece]
material = "steel"
mesh = {size = [10, 15], cells = [2, 3]}
[materials.steel]
young = 100e3
poisson = 0.3
hardening = {law = "linear", yield_stress = 60, modulus = 200}
[materials.steel.grain]
initial = 80
{TEMPERATURE}
static.half_time = {A = 1e-16, grain = 2, strain = -2, energy = 260e3}
static.size = {A = 0.25, grain = 0.67, strain = -1}
static.exponent = 1.5
softens = {SOFTENS}
[tools.punch]
profile = [[0, 15], [30, 15]]
contact = "frictionless"
[boundary.axis]
set = "left"
fix = ["x"]
[boundary.middle]
set = "bottom"
fix = ["y"]
[[stages]]
name = "blow"
{DURATION}
tools.punch = {stroke = 1.4274, direction = [0, -1]}
[[stages]]
name = "pause"
duration = 2
tools.punch = {stroke = 0.0001, direction = [0, -1]}
[[stages]]
name = "second"
duration = 0.1
tools.punch = {stroke = 1.2, direction = [0, -1]}
[solver]
initial_increment = 0.1
max_increment = 0.1
[output]
steps = 1
"""


def read(folder, temperature="temperature = 1000", duration="duration = 0.1", softens="false"):
    path = folder / "blows.toml"
    text = CASE.replace("{TEMPERATURE}", temperature).replace("{DURATION}", duration).replace("{SOFTENS}", softens)
    path.write_text(text)
    return read_case(path)


def test_two_blows_from_the_case_file(tmp_path) -> None:
    """ln(15/13.5726) = 0.1: the fraction after the pause is Avrami's; the second blow keeps what is left of the strain.

    Where what is recrystallised no longer hardens, the second blow begins at the flow stress of that strain.
    """
    found = {}
    for softens in ("false", "true"):
        model = build_model(read(tmp_path, softens=softens))
        found[softens] = run_model(model, tmp_path / softens, threads=1).result
        fractions = found[softens].field("recrystallised_fraction", step=2)
        strain = found[softens].field("total_plastic_strain", step=1)
        exact = fraction(2.0 / value(STATIC_TIME, 80.0, float(strain.mean()), 1.0, 1000.0), 1.5)
        np.testing.assert_allclose(fractions, exact, rtol=2e-3)
        assert found[softens].field("grain_size", step=3).max() < 80.0
        total = found[softens].field("total_plastic_strain", step=3)
        np.testing.assert_allclose(total, np.log(15.0 / 12.3725), rtol=0.02)
    hard, soft = (found[softens].field("effective_stress", step=3).mean() for softens in ("false", "true"))
    assert hard == pytest.approx(60.0 + 200.0 * total.mean(), rel=5e-3)
    kept = found["true"].field("total_plastic_strain", step=3).mean() - strain.mean() * exact
    assert soft == pytest.approx(60.0 + 200.0 * kept, rel=0.01)


@pytest.mark.parametrize(
    ("change", "key"),
    [
        ({"temperature": ""}, "materials.steel.grain.temperature"),
        ({"duration": ""}, "stages.0.duration"),
        ({"temperature": "temperature = 1000\ndynamic = {}"}, "critical_strain"),
        ({"temperature": "temperature = 1000\nmetadynamic.half_time = {A = 1}\nmetadynamic.size = {A = 1}"}, "dynamic"),
        ({"temperature": "temperature = 1000\ngrowth = {A = 1, exponent = 7}"}, "energy"),
    ],
)
def test_faulty_grain_laws_are_refused(tmp_path, change, key) -> None:
    with pytest.raises(CaseError) as error:
        build_model(read(tmp_path, **change))
    assert any(key in problem.key for problem in error.value.problems)


def test_z_needs_its_energy(tmp_path) -> None:
    path = tmp_path / "blows.toml"
    read(tmp_path)
    path.write_text(path.read_text().replace("strain = -2, energy = 260e3", "zener = -0.2"))
    with pytest.raises(CaseError, match="deformation_energy"):
        build_model(read_case(path))
