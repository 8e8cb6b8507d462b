# SPDX-License-Identifier: Apache-2.0
"""Identification gives back what tests were made from, and refuses tests that say nothing."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from presswork import _core
from presswork.case.errors import CaseError
from presswork.case.material.yld2000_fit import YieldData, fit_yld2000
from presswork.material.identify import LAWS, compare_flow, find_yield_stress, fit_hardening, fit_r_value
from presswork.material.identify_yld2000 import read_yield_data
from presswork.material.predict import predict_tension
from presswork.material.tensile import read_tensile

SETS = json.loads((Path(__file__).parents[2] / "data" / "yld2000.json").read_text())
YOUNG, POISSON = 206e3, 0.3
TRUE = {
    "swift": [565.0, 0.0071, 0.2589],
    "ludwik": [150.0, 450.0, 0.45],
    "voce": [180.0, 400.0, 9.0],
    "hockett_sherby": [150.0, 520.0, 3.0, 0.6],
    "linear_voce": [180.0, 380.0, 14.0, 120.0],
    "swift_voce": [0.5, 600.0, 0.01, 0.2, 200.0, 420.0, 12.0],
}


def flow(law: str, p: np.ndarray) -> np.ndarray:
    function = _core.YieldFunction.hill1948([0.5, 0.5, 0.5, 1.5, 1.5, 1.5])
    return _core.SheetLaw(1e5, 0.3, function, _core.HardeningLaw[law], TRUE[law]).flow_stress(p)[0]


def write_test(
    path: Path, law: str, *, columns: str = "engineering", r: float | None = 1.79, noise: float = 0.0
) -> Path:
    """A tensile test to a plastic strain of 0.5, beyond the uniform elongation."""
    p = np.linspace(0.0, 0.5, 200)
    stress = flow(law, p) * (1 + noise * np.random.default_rng(1).standard_normal(200))
    strain = p + stress / YOUNG
    width = None if r is None else -r / (1 + r) * p - POISSON * stress / YOUNG
    factor = 100.0 if columns.endswith("percent") else 1.0
    if columns.startswith("engineering"):
        names = columns.replace("engineering", "engineering_strain"), "engineering_stress"
        stress, strain = stress * np.exp(-strain), factor * np.expm1(strain)
        width = None if width is None else factor * np.expm1(width)
    else:
        names = columns, "stress"
        strain, width = factor * strain, None if width is None else factor * width
    table, head = [strain, stress], list(names)
    if width is not None:
        table.append(width)
        head.append(f"width_{names[0]}")
    np.savetxt(path, np.column_stack(table), delimiter=",", header=",".join(head), comments="")
    return path


@pytest.mark.parametrize("law", LAWS)
def test_fit_finds_the_law_that_the_test_was_made_from(tmp_path: Path, law: str) -> None:
    test = read_tensile(write_test(tmp_path / "t.csv", law)).tests[0]
    fit = fit_hardening(test, law, YOUNG)
    assert fit.relative < 1e-5
    p = np.linspace(0.002, fit.largest_strain, 50)
    np.testing.assert_allclose(fit.stress(p), flow(law, p), rtol=1e-4)
    if law in ("swift", "voce"):
        np.testing.assert_allclose(list(fit.parameters.values()), TRUE[law], rtol=1e-3)


@pytest.mark.parametrize("columns", ["strain", "strain_percent", "engineering", "engineering_percent"])
def test_all_kinds_of_columns_say_the_same(tmp_path: Path, columns: str) -> None:
    test = read_tensile(write_test(tmp_path / "t.csv", "swift", columns=columns)).tests[0]
    assert test.strain[-1] == pytest.approx(0.2589, abs=0.01), "cut at the highest force, by Considere at e = n - e0"
    assert fit_r_value(test, YOUNG, POISSON) == pytest.approx(1.79, rel=1e-3)
    assert fit_hardening(test, "swift", YOUNG).parameters["K"] == pytest.approx(565.0, rel=1e-3)
    assert find_yield_stress(test, YOUNG) == pytest.approx(565.0 * 0.0091**0.2589, rel=2e-3)


def test_criterion_prefers_the_simple_law_of_two_that_fit_noise_alike(tmp_path: Path) -> None:
    test = read_tensile(write_test(tmp_path / "t.csv", "swift", noise=0.003)).tests[0]
    simple, rich = (fit_hardening(test, law, YOUNG) for law in ("swift", "swift_voce"))
    assert rich.scatter <= simple.scatter
    assert simple.criterion < rich.criterion


def test_without_width_there_is_no_r_value(tmp_path: Path) -> None:
    assert fit_r_value(read_tensile(write_test(tmp_path / "t.csv", "swift", r=None)).tests[0], YOUNG, POISSON) is None


def test_directions_are_told_apart(tmp_path: Path) -> None:
    path = tmp_path / "t.csv"
    rows = [f"{a},{e},{100 + a + 1000 * e}" for e in np.linspace(0.01, 0.1, 8) for a in (45, 0, 90)]
    path.write_text("angle,strain,stress\n" + "\n".join(rows), encoding="utf-8")
    tests = read_tensile(path).tests
    assert [test.angle for test in tests] == [0.0, 45.0, 90.0]
    assert [test.stress[0] for test in tests] == pytest.approx([110.0, 155.0, 200.0])


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", ["empty file"]),
        ("strain,power\n1,2\n", ["no columns of strain and stress", "columns: power, strain"]),
        ("strain,stress\n0.1,a\n", ["line 2, stress", "expected a number"]),
        ("strain,stress\n0.1,200\n", ["1 points", "at least five"]),
        ("strain,stress\n" + "".join(f"{i},{200 * 2.8**i}\n" for i in range(8)), ["strain to 7", "_percent"]),
        ("strain,stress\n" + "".join(f"{i / 100},{0.2 + i / 100}\n" for i in range(8)), ["of no metal", "in MPa"]),
        ("strain,strain_percent,stress\n1,2,3\n", ["given twice"]),
    ],
)
def test_faults_of_a_tensile_file_are_named(tmp_path: Path, text: str, words: list[str]) -> None:
    path = tmp_path / "t.csv"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(CaseError) as caught:
        read_tensile(path)
    for word in words:
        assert word in str(caught.value), str(caught.value)


def test_a_width_that_grows_is_refused(tmp_path: Path) -> None:
    with pytest.raises(CaseError, match="r-value of"):
        fit_r_value(read_tensile(write_test(tmp_path / "t.csv", "swift", r=-0.3)).tests[0], YOUNG, POISSON)


def test_too_few_points_for_a_law_say_so(tmp_path: Path) -> None:
    path = tmp_path / "t.csv"
    path.write_text("strain,stress\n" + "".join(f"{0.02 * i},{200 + 10 * i}\n" for i in range(1, 7)), encoding="utf-8")
    with pytest.raises(CaseError, match="too few for swift_voce"):
        fit_hardening(read_tensile(path).tests[0], "swift_voce", YOUNG)


ALL = np.arange(0.0, 91.0, 15.0)
USUAL = [0, 3, 6]


@pytest.mark.parametrize("chosen", [USUAL, range(7)])
@pytest.mark.parametrize("name", [name for name in SETS if "alpha" in SETS[name]])
def test_yld2000_is_identified_from_the_data_of_published_sets(name: str, chosen: list[int]) -> None:
    """From the usual eight and from all sixteen: where the data are a function's own, both find it."""
    data = SETS[name]
    s, r = (np.array(data[key])[list(chosen)] for key in ("sigma", "r"))
    fitted = fit_yld2000(YieldData(ALL[list(chosen)], s, r, data["sb"], data["rb"]), data["a"])
    np.testing.assert_allclose(fitted.alpha, data["alpha"], atol=1e-6)
    assert max(fitted.worst()) < 1e-6


def test_yld2000_refuses_data_that_are_no_metals() -> None:
    usual = ALL[USUAL]
    with pytest.raises(CaseError, match="r at 45 degrees = -1"):
        fit_yld2000(YieldData(usual, np.ones(3), np.array([1.0, -1.0, 1.0]), 1, 1), 8)
    with pytest.raises(CaseError, match="no parameters give"):
        fit_yld2000(YieldData(usual, np.ones(3), np.ones(3), 4, 1), 8)
    with pytest.raises(CaseError, match="7 data for its eight parameters"):
        fit_yld2000(YieldData(usual, np.ones(3), np.ones(3), 1), 8)
    with pytest.raises(CaseError, match="r_weight"):
        fit_yld2000(YieldData(usual, np.ones(3), np.ones(3), 1, 1), 8, r_weight=0.0)


AA6016 = YieldData(
    ALL,
    np.array([1.0, 0.944, 0.913, 0.908, 0.898, 0.928, 0.983]),
    np.array([0.526, 0.344, 0.301, 0.253, 0.294, 0.393, 0.601]),
    1.0,
    1.0,
)
"""ESAFORM 2021: sixteen data for eight parameters."""


def test_all_angles_are_met_better_than_by_the_usual_eight() -> None:
    fitted = fit_yld2000(AA6016, 8)
    eight = fit_yld2000(YieldData(ALL[USUAL], AA6016.stress[USUAL], AA6016.r[USUAL], 1.0, 1.0), 8)

    def miss(alpha: tuple[float, ...]) -> float:
        function = _core.YieldFunction.yld2000(list(alpha), 8)
        found = predict_tension(function, ALL)
        slope = found.r / (1 + found.r) - AA6016.r / (1 + AA6016.r)
        return float(((AA6016.stress / found.stress - 1) ** 2 + slope**2).sum())

    assert miss(fitted.alpha) < 0.5 * miss(eight.alpha)
    heavy = fit_yld2000(AA6016, 8, r_weight=5.0)
    assert heavy.worst()[1] < fitted.worst()[1]
    assert heavy.worst()[0] > fitted.worst()[0]


def test_yield_data_are_read_with_gaps_and_the_biaxial_line(tmp_path: Path) -> None:
    path = tmp_path / "data.csv"
    path.write_text("angle,stress,r\n0,1,0.526\n15,,0.344\n45,0.908,\nbiaxial,1.01,0.98\n", encoding="utf-8")
    data = read_yield_data(path)
    np.testing.assert_array_equal(data.angle, [0, 15, 45])
    np.testing.assert_array_equal(data.r, [0.526, 0.344, np.nan])
    assert (data.biaxial, data.r_biaxial, data.count()) == (1.01, 0.98, 6)
    path.write_text("angle,stress\n0,one\nfifteen,1\n,1\n", encoding="utf-8")
    with pytest.raises(CaseError, match=r"(?s)line 2, stress.*line 3, angle.*line 4, angle"):
        read_yield_data(path)
    path.write_text("direction,stress\n0,1\n", encoding="utf-8")
    with pytest.raises(CaseError, match="no columns of yield data"):
        read_yield_data(path)


def test_stress_by_direction_is_compared_at_the_same_plastic_work(tmp_path: Path) -> None:
    """A test that is 0.9 of another in stress, and so strained more at the same work, is 0.9 of a power law there."""
    p = np.linspace(0.0, 0.2, 200)
    rows = ["angle,strain,stress"]
    for angle, ratio in ((0, 1.0), (45, 0.9)):
        stress = ratio * flow("swift", ratio * p)  # of the strain that does the same work
        rows += [f"{angle},{e + s / YOUNG},{s}" for e, s in zip(p, stress, strict=True)]
    (tmp_path / "t.csv").write_text("\n".join(rows), encoding="utf-8")
    along, across = read_tensile(tmp_path / "t.csv").tests
    assert compare_flow(across, along, YOUNG) == pytest.approx(0.9, rel=1e-3)
