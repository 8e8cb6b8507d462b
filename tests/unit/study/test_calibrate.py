# SPDX-License-Identifier: Apache-2.0
"""The fit of friction on curves that are known, and the reading of measured points."""

import numpy as np
import pytest

from presswork import CaseError
from presswork.study import CalibrationCurves, MeasuredRings, fit_friction, integrate_ring, read_measured

FRICTION = np.array([0, 0.05, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5, 0.7, 1.0])
REDUCTIONS = np.linspace(0.1, 0.5, 9)


@pytest.fixture(scope="module")
def curves():
    steps = np.linspace(0, 0.5, 21)
    return CalibrationCurves(FRICTION, steps, np.array([integrate_ring(m, steps)[0] for m in FRICTION]))


def points(m, noise=0.0, reductions=REDUCTIONS, seed=0):
    bore, _ = integrate_ring(m, reductions)
    return MeasuredRings(reductions, bore + np.random.default_rng(seed).normal(0, noise, len(bore)))


@pytest.mark.parametrize("m", [0.03, 0.08, 0.12, 0.25, 0.45, 0.6, 0.85])
def test_fit_recovers_friction_between_the_curves(curves, m):
    assert fit_friction(curves, points(m)).friction == pytest.approx(m, abs=3e-3)


@pytest.mark.validation
def test_interval_holds_the_true_friction_19_times_in_20(curves):
    fits = [fit_friction(curves, points(0.12, 0.01, seed=seed)) for seed in range(300)]
    hits = sum(fit.interval[0] <= 0.12 <= fit.interval[1] for fit in fits)
    assert 0.92 < hits / 300 < 0.98
    assert np.mean([fit.scatter for fit in fits]) == pytest.approx(0.01, rel=0.1)


def test_fit_says_when_it_runs_against_either_end(curves):
    low, high = points(0.0), points(1.0)
    above = fit_friction(curves, MeasuredRings(low.height_reduction, low.bore_ratio + 0.05))
    below = fit_friction(curves, MeasuredRings(high.height_reduction, high.bore_ratio - 0.05))
    assert above.friction == pytest.approx(0.0, abs=1e-3)
    assert below.friction == pytest.approx(1.0, abs=1e-3)
    for fit, side in ((above, "below it"), (below, "above it")):
        assert "against the end of the range" in fit.warnings[0]
        assert side in fit.warnings[0]


def test_fit_says_when_the_points_are_few(curves):
    one = fit_friction(curves, points(0.2, reductions=REDUCTIONS[-1:]))
    assert one.friction == pytest.approx(0.2, abs=3e-3)
    assert np.isnan(one.interval).all()
    assert "no interval" in one.warnings[0]
    two = fit_friction(curves, points(0.12, 0.002, reductions=REDUCTIONS[-2:]))
    assert "2 points are few" in two.warnings[-1]


def test_fit_refuses_points_beyond_the_curves(curves):
    with pytest.raises(CaseError, match=r"60\.0 % reduction lies beyond the 50\.0 %"):
        fit_friction(curves, MeasuredRings(np.array([0.6]), np.array([1.0])))


def test_measured_points_in_every_unit_are_the_same(tmp_path):
    texts = {
        "a.csv": "# ring tests\nheight_reduction,bore_ratio\n0.25,1.1\n\n0.5,0.9\n",
        "b.csv": "name;bore_diameter_mm;height_reduction_percent\nA;19.8;25\nB;16.2;50\n",
    }
    for name, text in texts.items():
        (tmp_path / name).write_text(text)
        measured = read_measured(tmp_path / name, 18.0)
        np.testing.assert_allclose(measured.height_reduction, [0.25, 0.5])
        np.testing.assert_allclose(measured.bore_ratio, [1.1, 0.9])


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "empty file"),
        ("height_reduction,bore_ratio\n", "no measured point"),
        ("height_reduction,bore\n0.5,0.9\n", "no column bore_ratio or bore_diameter_mm"),
        ("height_reduction,height_reduction_percent,bore_ratio\n0.5,50,0.9\n", "the same quantity twice"),
        ("height_reduction,bore_ratio\n0.5,x\n", "line 2, bore_ratio = .*expected a number"),
        ("height_reduction,bore_ratio\n0.5\n", "line 2, bore_ratio"),
        ("height_reduction,bore_ratio\n50,0.9\n", "height_reduction_percent"),
        ("height_reduction,bore_ratio\n0.5,16.2\n", "bore_diameter_mm"),
        ("height_reduction,bore_ratio\n0.5,nan\n", "between 0 and 5"),
        ("height_reduction,bore_ratio\n0,1\n", "between 0 and 1"),
    ],
)
def test_measured_points_that_make_no_sense_are_refused_with_the_remedy(tmp_path, text, message):
    (tmp_path / "m.csv").write_text(text)
    with pytest.raises(CaseError, match=message):
        read_measured(tmp_path / "m.csv", 18.0)


def test_missing_measured_file_is_said(tmp_path):
    with pytest.raises(CaseError, match="no such file"):
        read_measured(tmp_path / "m.csv", 18.0)
