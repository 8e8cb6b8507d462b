# SPDX-License-Identifier: Apache-2.0
"""The explicit loop's von Mises update against update_sheet, which has another formulation and another solver."""

import numpy as np
import pytest

from presswork import _core

YOUNG, POISSON = 70e3, 0.33
MISES = _core.YieldFunction.hill1948([0.5, 0.5, 0.5, 1.5, 1.5, 1.5])
SMOOTH = {
    "linear": [200.0, 300.0],
    "swift": [565.0, 0.007, 0.26],
    "voce": [140.0, 330.0, 12.4],
    "linear_voce": [140.0, 330.0, 12.4, 80.0],
    "swift_voce": [0.5, 565.0, 0.007, 0.26, 140.0, 330.0, 12.4],
}
ROUGH = {
    "ludwik": [140.0, 300.0, 0.4],
    "hockett_sherby": [140.0, 330.0, 12.4, 0.8],
    "monotone_table": [0.0, 200.0, 2000.0, 0.05, 280.0, 1000.0, 0.5, 400.0, 100.0],
    "table": [0.0, 200.0, 0.05, 300.0, 0.5, 400.0],
}
"""Laws with a kink or an infinite slope, which a cubic follows but roughly in the one interval that holds it."""
TOLERANCE = {"ludwik": 2e-6, "hockett_sherby": 2e-6, "monotone_table": 2e-6, "table": 2e-3}


def make_law(name: str) -> _core.SheetLaw:
    parameters = (SMOOTH | ROUGH)[name]
    return _core.SheetLaw(YOUNG, POISSON, MISES, _core.HardeningLaw[name], parameters)


def compare(name: str, size: float, rtol: float, *, single: bool = False) -> float:
    """Five increments of random strain by both; the share of plastic points."""
    law, rng, n = make_law(name), np.random.default_rng(1), 2003
    fast = _core.TabulatedMises(law)
    stress, history = np.zeros((n, 3)), np.zeros((n, 1))
    plastic = np.zeros(n, dtype=bool)
    for _ in range(5):
        strain = rng.standard_normal((n, 3)) * size * rng.uniform(0, 1, (n, 1))
        one, eqps, across = fast.update(strain, stress, history[:, 0], single=single)
        stress, after, thickness, _, failed = law.update(strain, stress, history)
        assert not failed.any()
        flow = law.flow_stress(after[:, 0])[0][:, None]
        np.testing.assert_allclose(one / flow, stress / flow, rtol=0, atol=rtol)
        np.testing.assert_allclose(eqps, after[:, 0], rtol=rtol, atol=rtol * 200.0 / YOUNG)
        np.testing.assert_allclose(across, thickness, rtol=rtol, atol=rtol * size)
        plastic |= after[:, 0] > history[:, 0]
        history = after
    return float(plastic.mean())


@pytest.mark.parametrize("name", SMOOTH)
@pytest.mark.parametrize("size", [1e-4, 2e-3, 3e-2, 0.5])
def test_it_gives_what_update_sheet_gives(name: str, size: float) -> None:
    """To 2e-8 of the flow stress: table 1e-8, equation 5e-10; from an explicit step's strain to 100 times yield."""
    assert compare(name, size, 2e-8) >= (0.0 if size < 1e-3 else 0.3)


@pytest.mark.parametrize("name", SMOOTH)
@pytest.mark.parametrize("size", [1e-4, 2e-3, 3e-2, 0.5])
def test_single_precision_gives_it_to_a_few_units_in_the_last_place(name: str, size: float) -> None:
    """To 2e-6 of the flow stress: the equation's tolerance is 1e-6, a float's unit 6e-8."""
    assert compare(name, size, 2e-6, single=True) >= (0.0 if size < 1e-3 else 0.3)


@pytest.mark.parametrize("name", ROUGH)
def test_a_kink_in_the_curve_costs_little(name: str) -> None:
    assert compare(name, 5e-3, TOLERANCE[name]) > 0.3


@pytest.mark.parametrize("name", SMOOTH)
def test_the_table_says_how_near_it_is(name: str) -> None:
    fast = _core.TabulatedMises(make_law(name))
    assert fast.table_error <= 1e-8
    assert fast.table_rows < 2000


def test_zero_strain_changes_nothing() -> None:
    law = make_law("swift")
    fast = _core.TabulatedMises(law)
    strain = np.random.default_rng(2).standard_normal((9, 3)) * 0.01
    stress, eqps, _ = fast.update(strain, np.zeros((9, 3)), np.zeros(9))
    again, same, across = fast.update(0 * strain, stress, eqps)
    np.testing.assert_allclose(again, stress, rtol=1e-9, atol=1e-7)
    np.testing.assert_allclose(same, eqps, rtol=1e-8, atol=1e-12)
    np.testing.assert_allclose(across, 0.0, atol=1e-12)


def test_other_laws_are_refused() -> None:
    rate = _core.SheetLaw(
        YOUNG, POISSON, MISES, _core.HardeningLaw.linear, [200.0, 0.0], rate=_core.RateLaw.cowper_symonds,
        rate_parameters={"D": 40.0, "q": 5.0},
    )  # fmt: skip
    with pytest.raises(ValueError, match="von Mises"):
        _core.TabulatedMises(rate)
