# SPDX-License-Identifier: Apache-2.0
"""Yield functions against published parameter sets, and against the formulas of Hill 1948 and Barlat & Lian 1989.

tests/data/yld2000.json holds Yld2000-2d sets with stresses and r-values of an independent implementation.
"""

from __future__ import annotations

import json
import math

import numpy as np
import pytest

from presswork import _core
from presswork.case.material.yield_function import Barlat1989, Hill1948
from presswork.material.predict import predict_biaxial, predict_plane_strain, predict_shear, predict_tension
from tests.problems.plane_solids import DATA

SETS = {name: data for name, data in json.loads((DATA / "yld2000.json").read_text()).items() if name[0] != "_"}
EVERY_15_DEGREES = np.arange(0.0, 91.0, 15.0)
R_VALUES = [(1.79, 1.51, 2.27), (0.8, 0.37, 0.54), (1.0, 1.0, 1.0), (0.21, 1.58, 0.69)]


def published_function(data: dict) -> _core.YieldFunction:
    if "alpha" in data:
        return _core.YieldFunction.yld2000(data["alpha"], data["a"])
    return Hill1948(r00=1.79, r45=1.51, r90=2.27).build()


@pytest.mark.parametrize("name", SETS)
def test_published_sets_give_their_stresses_and_r_values_every_15_degrees(name):
    data = SETS[name]
    tension = predict_tension(published_function(data), np.array(data.get("angles", EVERY_15_DEGREES)))
    np.testing.assert_allclose(tension.stress, data["sigma"], rtol=1e-8)
    np.testing.assert_allclose(tension.r, data["r"], rtol=1e-7)


@pytest.mark.parametrize("name", SETS)
def test_published_sets_give_their_biaxial_plane_strain_and_shear_points(name):
    data = SETS[name]
    function = published_function(data)
    assert predict_biaxial(function) == pytest.approx((data["sb"], data["rb"]), rel=1e-7)
    assert predict_plane_strain(function, across=1) == pytest.approx(data["planestrainRD"], rel=1e-7)
    assert predict_plane_strain(function, across=0) == pytest.approx(data["planestrainTD"], rel=1e-7)
    assert predict_shear(function) == pytest.approx(data["shear"], rel=1e-8)


@pytest.mark.parametrize(("r00", "r45", "r90"), R_VALUES)
def test_hill_1948_gives_its_closed_form_of_r_and_stress(r00, r45, r90):
    """Hill 1950, ch. XII: r = (H + (2N - F - G - 4H) s²c²) / (F s² + G c²), and the stress of the same angle."""
    hill = Hill1948(r00=r00, r45=r45, r90=r90)
    F, G, H, _, _, N = hill.hill_parameters()
    tension = predict_tension(hill.build(), EVERY_15_DEGREES)
    s2, c2 = np.sin(np.radians(EVERY_15_DEGREES)) ** 2, np.cos(np.radians(EVERY_15_DEGREES)) ** 2
    r = (H + (2 * N - F - G - 4 * H) * s2 * c2) / (F * s2 + G * c2)
    stress = 1 / np.sqrt(F * s2 + G * c2 + H + (2 * N - F - G - 4 * H) * s2 * c2)
    np.testing.assert_allclose(tension.r, r, rtol=1e-12)
    np.testing.assert_allclose(tension.stress, stress, rtol=1e-12)
    np.testing.assert_allclose(tension.r[[0, 3, 6]], [r00, r45, r90], rtol=1e-12)


def test_hill_1948_from_stresses_gives_them_back():
    function = Hill1948(stress_45=1.05, stress_90=0.97, stress_biaxial=1.1).build()
    np.testing.assert_allclose(predict_tension(function, np.array([0.0, 45.0, 90.0])).stress, [1, 1.05, 0.97])
    assert predict_biaxial(function)[0] == pytest.approx(1.1)


@pytest.mark.parametrize("exponent", [6, 8])
@pytest.mark.parametrize(("r00", "r45", "r90"), R_VALUES)
def test_barlat_1989_is_its_formula_and_gives_back_the_r_values(r00, r45, r90, exponent):
    """f = a|K1+K2|^M + a|K1-K2|^M + c|2K2|^M = 2 q^M, K1 = (xx + h yy)/2, K2² = ((xx - h yy)/2)² + p² xy²."""
    barlat = Barlat1989(r00=r00, r45=r45, r90=r90, exponent=exponent)
    a, c, h, p = barlat.coefficients()
    assert c == pytest.approx(2 * math.sqrt(r00 / (1 + r00) * r90 / (1 + r90)))
    x, y, z = np.random.default_rng(1).standard_normal((3, 50))
    k1, k2 = (x + h * y) / 2, np.sqrt(((x - h * y) / 2) ** 2 + p**2 * z**2)
    phi = a * abs(k1 + k2) ** exponent + a * abs(k1 - k2) ** exponent + c * abs(2 * k2) ** exponent
    value = barlat.build().evaluate(np.stack([x, y, z], axis=1))[0]
    np.testing.assert_allclose(value, (phi / 2) ** (1 / exponent), rtol=1e-12)
    tension = predict_tension(barlat.build(), np.array([0.0, 45.0, 90.0]))
    np.testing.assert_allclose(tension.r, [r00, r45, r90], rtol=1e-9)


@pytest.mark.parametrize(("exponent", "plane_strain"), [(6, 1.1167), (8, 1.0894)])
def test_isotropic_plane_strain_is_that_of_hosford(exponent, plane_strain):
    """Hosford 1972: sigma = (2^a / (2^(a-1) + 1))^(1/a) at half the stress across."""
    exact = (2**exponent / (2 ** (exponent - 1) + 1)) ** (1 / exponent)
    assert exact == pytest.approx(plane_strain, abs=5e-5)
    for function in (
        _core.YieldFunction.yld2000([1.0] * 8, exponent),
        Barlat1989(r00=1.0, r45=1.0, r90=1.0, exponent=exponent).build(),
    ):
        assert predict_plane_strain(function, across=1) == pytest.approx((exact, 0.5), rel=1e-9)
