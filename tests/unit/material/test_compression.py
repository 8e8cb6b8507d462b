# SPDX-License-Identifier: Apache-2.0
"""Hot compression tests: reading, corrections for friction and heating, laws that come back from their own curves."""

import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from presswork.case import CaseError
from presswork.material.compression import (
    CompressionTest,
    correct,
    find_adiabatic_part,
    find_friction_factor,
    read_compression,
)
from presswork.material.identify_hot import HOT_LAWS, HotFit, evaluate, fit_hot, tabulate

HENSEL = {
    "A": 1500.0, "m1": -0.0027, "m2": -0.12, "m3": 0.1, "m4": -0.055, "m5": -2e-4, "m7": 0.15, "m8": 3e-5, "m9": 0.0,
}  # fmt: skip
SINH = {"A": 3e11, "alpha": 0.012, "n": 4.6, "Q": 312e3}
RATES, DEGREES = (0.01, 0.1, 1.0, 10.0), (900.0, 1000.0, 1100.0, 1200.0)
STRAIN = np.linspace(0.02, 0.8, 160)
CAPACITY = 7850e-12 * 650e6
"""[MPa/K]"""


def measure(law: str, parameters: dict[str, float], *, m: float = 0.0, heats: bool = False) -> list[CompressionTest]:
    """Return what tests of a specimen of 10 x 15 mm would measure, without noise."""
    tests = []
    for start in DEGREES:
        for rate in RATES:
            degrees = np.full_like(STRAIN, start)
            stress = evaluate(law, parameters, STRAIN, np.full_like(STRAIN, rate), degrees)
            for _ in range(60 if heats else 0):  # the stress heats the metal, which softens it
                steps = 0.5 * (stress[1:] + stress[:-1]) * np.diff(STRAIN)
                work = np.concatenate([[0.0], np.cumsum(steps)]) + stress[0] * STRAIN[0]
                degrees = start + find_adiabatic_part(rate) * 0.9 * work / CAPACITY
                stress = evaluate(law, parameters, STRAIN, np.full_like(STRAIN, rate), degrees)
            ratio = 5.0 / 15.0 * np.exp(1.5 * STRAIN)
            force = stress * (1.0 + 2.0 * m * ratio / (3.0 * math.sqrt(3.0)))
            tests.append(CompressionTest(rate, start, STRAIN, force, np.full_like(STRAIN, start), 5.0 / 15.0, m))
    return tests


@pytest.mark.parametrize(("law", "parameters"), [("hensel_spittel", HENSEL), ("sinh_arrhenius", SINH)])
@pytest.mark.parametrize("m", [0.0, 0.3])
@pytest.mark.parametrize("heats", [False, True])
def test_curves_without_noise_give_the_parameters_back(law: str, parameters: Any, m: float, heats: bool) -> None:
    tests = correct(measure(law, parameters, m=m, heats=heats), CAPACITY if heats else None)
    fit = fit_hot(tests, law)
    assert fit.relative < 1e-9
    for key, value in parameters.items():
        assert fit.parameters[key] == pytest.approx(value, rel=1e-6, abs=1e-12), key


def test_friction_left_in_the_curves_shows_in_the_parameters() -> None:
    tests = measure("hensel_spittel", HENSEL, m=0.3)
    spoilt = fit_hot(
        [CompressionTest(t.rate, t.start, t.strain, t.stress, t.temperature) for t in tests], "hensel_spittel"
    )
    assert abs(spoilt.parameters["m7"] - HENSEL["m7"]) > 0.05


def test_the_table_is_isothermal() -> None:
    tests = correct(measure("hensel_spittel", HENSEL, m=0.2, heats=True), CAPACITY)
    fit = fit_hot(tests, "hensel_spittel")
    rows = tabulate(tests, fit)
    strain, rate, degrees, stress = rows.T
    assert len(rows) == 15 * len(RATES) * len(DEGREES)
    # between measured points the curve is drawn straight
    assert stress == pytest.approx(evaluate("hensel_spittel", HENSEL, strain, rate, degrees), rel=2e-3)


def test_barrel_gives_the_friction_factor_of_ebrahimi_and_najafizadeh() -> None:
    height, diameter, final = 15.0, 10.0, 7.5
    radius = 5.0 * math.sqrt(2.0)
    for m in (0.1, 0.4, 0.8):
        # b of their formula for this m, and the barrel of a top that the volume allows
        x = m * final / radius
        b = x * 4.0 / math.sqrt(3.0) / (1.0 + 2.0 * x / (3.0 * math.sqrt(3.0)))
        bulge = b / 4.0 * radius * (height - final) / final
        # top and barrel with R_top^2 = 3 R^2 - 2 R_barrel^2, R_barrel - R_top = bulge
        barrel = (bulge + math.sqrt(9.0 * radius**2 - 2.0 * bulge**2)) / 3.0
        assert find_friction_factor(height, diameter, final, 2 * barrel) == pytest.approx(m, rel=1e-12)
        assert find_friction_factor(height, diameter, final, 2 * barrel, 2 * (barrel - bulge)) == pytest.approx(m)
    with pytest.raises(ValueError, match="not wider than the top"):
        find_friction_factor(height, diameter, final, 2 * radius, 2 * radius + 1)
    with pytest.raises(ValueError, match="more than sticking"):
        find_friction_factor(height, diameter, final, 2 * radius * 1.2)


def test_heat_stays_by_the_rate() -> None:
    assert [find_adiabatic_part(rate) for rate in (1e-4, 1e-3, 1.0, 50.0)] == [0.0, 0.0, 1.0, 1.0]
    assert find_adiabatic_part(math.sqrt(1e-3)) == pytest.approx(0.5)


def write(path: Path, head: str, rows: list[str]) -> Path:
    path.write_text("# hot tests\n" + "\n".join([head, *rows]) + "\n")
    return path


def test_a_file_is_read_by_tests(tmp_path: Path) -> None:
    rows = [f"{e},{s},{r},1000,15,10,0.2" for r, s in ((1, 100), (0.1, 80)) for e in (0.3, 0.1, 0.2, 0.4)]
    tests = read_compression(write(tmp_path / "t.csv", "strain,stress,rate,temperature,height,diameter,m", rows))
    assert [(t.rate, t.start, t.m, t.slenderness) for t in tests] == [(0.1, 1000, 0.2, 1 / 3), (1, 1000, 0.2, 1 / 3)]
    assert tests[0].strain.tolist() == [0.1, 0.2, 0.3, 0.4]


HEAD = "strain,stress,rate,temperature"
FOUR = ["0.1,100,1,1000", "0.2,110,1,1000", "0.3,120,1,1000", "0.4,120,1,1000"]
BAD = [
    ("strain,stress,speed,temperature", FOUR, "no column rate"),
    (HEAD, [*FOUR, "0.5,-3,1,1000"], 'line 7, stress = "-3": expected a number > 0'),
    (HEAD, [*FOUR, "0.5,x,1,1000"], "line 7, stress"),
    (HEAD, FOUR[:1], "points with a strain > 0: 1; give at least 2"),
    (HEAD, [*FOUR, "0.4,121,1,1000"], "two points of the same strain"),
    (HEAD, [*FOUR, "40,121,1,1000"], "strain to 40; give true strains, not per cent"),
    (HEAD + ",m", [row + ",0.2" for row in FOUR], "friction needs the specimen"),
    (HEAD + ",height,diameter,m", [row + ",15,10,2" for row in FOUR], "m = 2; a friction factor lies between 0 and 1"),
    (HEAD + ",height,diameter,barrel_diameter", [row + ",15,10,15" for row in FOUR], "a barrel needs final_height"),
    (HEAD + ",height", [f"{row},{15 + i}" for i, row in enumerate(FOUR)], "height is not the same in all its lines"),
]


@pytest.mark.parametrize(("head", "rows", "message"), BAD)
def test_bad_files_are_refused_with_the_line(head: str, rows: list[str], message: str, tmp_path: Path) -> None:
    with pytest.raises(CaseError) as caught:
        read_compression(write(tmp_path / "bad.csv", head, rows))
    assert message in str(caught.value)


def test_a_row_at_rest_where_a_curve_begins_is_taken(tmp_path: Path) -> None:
    path = tmp_path / "tests.csv"
    rows = ["0,0,1,900", *(f"{e},{100 + 50 * e},1,900" for e in (0.05, 0.1, 0.2, 0.3))]
    path.write_text("\n".join(["strain,stress,rate,temperature", *rows]))
    (test,) = read_compression(path)
    np.testing.assert_array_equal(test.strain, [0.05, 0.1, 0.2, 0.3])


@pytest.mark.parametrize("law", HOT_LAWS)
def test_curves_that_end_before_flow_are_refused(law: str) -> None:
    short = [replace(t, strain=t.strain * 0.01) for t in measure("hensel_spittel", HENSEL)]
    with pytest.raises(CaseError, match=r"the test at 900 degrees C and .* 1/s: strains end at .*; give the curve to"):
        fit_hot(short, law)


FEW = {"A": 1500.0, "m1": -0.0027, "m2": -0.12, "m3": 0.1, "m5": -2e-4}
PAIRS = ((0.01, 900.0), (1.0, 900.0), (0.01, 1100.0), (1.0, 1100.0))


def measure_few(pairs: Sequence[tuple[float, float]], strains: Sequence[float]) -> list[CompressionTest]:
    """Return tests of few points at pairs of rate and temperature, of a law of few constants."""
    e = np.array(strains)
    columns = [(rate, start, e, np.full_like(e, rate), np.full_like(e, start)) for rate, start in pairs]
    return [CompressionTest(r, t, e, evaluate("hensel_spittel", FEW, e, rs, ts), ts) for r, t, e, rs, ts in columns]


@pytest.mark.parametrize(
    ("pairs", "strains", "left_out"),
    [
        (PAIRS[:3], (0.1, 0.3), ("m4", "m7", "m8")),
        (PAIRS, (0.1, 0.3), ("m4", "m7")),
        (PAIRS, (0.1, 0.2, 0.3), ("m4",)),
        (PAIRS, (0.1, 0.2, 0.3, 0.4), ()),
    ],
)
def test_few_points_determine_a_law_of_fewer_constants(
    pairs: Sequence[tuple[float, float]], strains: Sequence[float], left_out: tuple[str, ...]
) -> None:
    fit = fit_hot(measure_few(pairs, strains), "hensel_spittel")
    assert fit.left_out == left_out
    for key, value in FEW.items():
        assert fit.parameters[key] == pytest.approx(value, rel=1e-6)


def test_heating_in_the_test_tells_no_constant() -> None:
    tests = correct(measure_few(PAIRS[:3], (0.1, 0.3)), CAPACITY)
    assert fit_hot(tests, "hensel_spittel").left_out == ("m4", "m7", "m8")


def test_three_pairs_of_rate_and_temperature_make_no_sinh_law() -> None:
    with pytest.raises(CaseError, match="3 pairs of rate and temperature do not determine its 4 constants"):
        fit_hot(measure_few(PAIRS[:3], (0.1, 0.3)), "sinh_arrhenius")


def test_tests_without_strains_in_common_make_no_table() -> None:
    tests = [*measure_few(PAIRS[:2], (0.1, 0.2)), *measure_few(PAIRS[2:], (0.3, 0.4))]
    assert not len(tabulate(tests, fit_hot(tests, "hensel_spittel")))


def test_one_rate_does_not_make_a_law() -> None:
    tests = [t for t in measure("hensel_spittel", HENSEL) if t.rate == 1.0]
    with pytest.raises(CaseError, match="all tests have one rate, 1 1/s; give tests at two at least"):
        fit_hot(tests, "hensel_spittel")
    two = [t for t in measure("hensel_spittel", HENSEL) if t.rate <= 0.1 and t.start <= 1000.0]
    assert isinstance(fit_hot(two, "hensel_spittel"), HotFit)
    with pytest.raises(CaseError, match="do not determine 8 parameters"):
        fit_hot(two, "hensel_spittel", ("m1", "m2", "m3", "m4", "m5", "m7", "m8", "m9"))


def test_hot_tests_of_machines_are_read_in_any_form(tmp_path: Path) -> None:
    """Decimal commas, semicolons, per cent, GPa, a head of several lines, and a row of units give the same tests."""
    rows = [(0.1, 120.0, 0.01, 900.0), (0.3, 130.0, 0.01, 900.0), (0.1, 170.5, 1.0, 900.0), (0.3, 190.0, 1.0, 900.0)]
    plain = "strain,stress,rate,temperature\n" + "".join(f"{a},{b},{c},{d}\n" for a, b, c, d in rows)
    odd = "Pr\u00fcfer;M\u00fcller\nstrain;stress [GPa];rate;temperature\n%;;1/s;\u00b0C\n"
    odd += "".join(f"{100 * a:g};{b / 1000:g};{c:g};{d:g}\n".replace(".", ",") for a, b, c, d in rows)
    (tmp_path / "plain.csv").write_text(plain, "utf-8")
    (tmp_path / "odd.csv").write_text(odd, "latin-1")
    one, other = (read_compression(tmp_path / name) for name in ("plain.csv", "odd.csv"))
    for a, b in zip(one, other, strict=True):
        assert (a.rate, a.start) == (b.rate, b.start)
        np.testing.assert_allclose(b.strain, a.strain, rtol=1e-12)
        np.testing.assert_allclose(b.stress, a.stress, rtol=1e-12)
