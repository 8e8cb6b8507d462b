# SPDX-License-Identifier: Apache-2.0
"""Yoshida and Uemori's law in tension and compression: closed forms of its parts, and TRIP1180 over two cycles.

For one stress component, s the sense of flow, a = B + R - Y (Yoshida & Uemori, Int. J. Plasticity 18 (2002) 661):
    d theta = C (a s - sqrt(a |theta|) sign theta) dp,  d beta = m (b s - beta) dp,  stress = s Y + theta + beta
    d R = m (Rsat - R) dp,  d r = h |d beta|,  d q = (1 - h) d beta  while beta lies on |beta - q| = r and leaves it
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from presswork import _core
from presswork.material import find_sheet
from tests.problems.plane_solids import fit_rate
from tests.problems.sheet_paths import VON_MISES, pull

YOUNG = 197e3


def make_law(parameters: dict[str, float], young_saturated: float = 0.0, young_rate: float = 0.0) -> _core.SheetLaw:
    return _core.SheetLaw(
        YOUNG, 0.33, VON_MISES, _core.HardeningLaw.linear, [parameters["Y"], 0.0],
        yoshida_uemori=_core.YoshidaUemori(**parameters), young_saturated=young_saturated, young_rate=young_rate,
    )  # fmt: skip


def test_the_transient_meets_its_closed_form_forward_and_back():
    """Without motion of the bounding surface: y + ln(1 - y) = -C p/2 with theta = a y^2, and y - ln(1 + y) back."""
    given = {"Y": 400.0, "B": 600.0, "C": 300.0, "m": 1e-12, "b": 1e-6, "Rsat": 1e-6, "h": 0.5}
    a, C = 200.0, 300.0
    forward, back = np.linspace(0, 0.012, 4001)[1:], np.linspace(0.012, 0.0, 4001)[1:]
    stress, p, _ = pull(make_law(given), np.concatenate([forward, back]))

    def grow(p):
        return a * brentq(lambda y: y + np.log1p(-y) + C * p / 2, 0.0, 1 - 1e-16) ** 2

    picked = np.flatnonzero(p[:4000] > 2e-4)[::400]
    exact = np.array([400.0 + grow(p[i]) for i in picked])
    np.testing.assert_allclose(stress[picked], exact, atol=0.15)
    top = np.sqrt(grow(p[3999]) / a)  # theta falls from a top^2 to 0: 2 (y - ln(1 + y)) goes down by C (p - p_top)
    falling = np.flatnonzero((p > p[3999] + 2e-4) & (stress > -400.0))
    compared = 0
    for i in falling[:: max(1, len(falling) // 6)]:
        left = (top - np.log1p(top)) - C * (p[i] - p[3999]) / 2
        if left > 1e-3:
            y = brentq(lambda y, left=left: y - np.log1p(y) - left, 0.0, 1.0)
            assert stress[i] == pytest.approx(-400.0 + a * y**2, abs=0.3)
            compared += 1
    assert compared >= 3


def test_monotonic_flow_follows_the_bounding_surface():
    """Once theta is at its end: stress = B + (Rsat + b)(1 - exp(-m p)), Yoshida & Uemori's equation of the bound."""
    given = {"Y": 400.0, "B": 600.0, "C": 2e4, "m": 12.0, "b": 80.0, "Rsat": 150.0, "h": 0.5}
    stress, p, _ = pull(make_law(given), np.linspace(0, 0.2, 2001)[1:])
    late = p > 0.01
    bound = 600.0 + 230.0 * (1 - np.exp(-12.0 * p[late]))
    np.testing.assert_allclose(stress[late], bound, atol=1.5)
    np.testing.assert_allclose(np.diff(bound - stress[late]), 0.0, atol=0.02)


def integrate(given: dict[str, float], young: float, saturated: float, rate: float, turns: list[float]):
    """Integrate the rate equations by Runge-Kutta to 1e-10; return strain and stress by branch."""
    Y, B, C, m, b, Rsat, h = (given[k] for k in ("Y", "B", "C", "m", "b", "Rsat", "h"))

    def modulus(p):
        return saturated + (young - saturated) * np.exp(-rate * p)

    def rates(p, z, s, growing):
        theta, beta, R, _, _, _ = z
        a = B + R - Y
        d_theta = C * (a * s - np.sqrt(a * abs(theta)) * np.sign(theta))
        d_beta = m * (b * s - beta)
        d_R, d_q, d_r = (m * (Rsat - R), (1 - h) * d_beta, h * abs(d_beta)) if growing else (0.0, 0.0, 0.0)
        return [d_theta, d_beta, d_R, d_q, d_r, (d_theta + d_beta) / modulus(p) + s]

    z, p, stress = np.zeros(6), 0.0, 0.0
    branches = []
    for target in turns:
        s = 1.0 if target > z[5] else -1.0
        z[5] += (s * Y + z[0] + z[1] - stress) / modulus(p)
        rows = []
        growing = abs(z[1] - z[3]) >= z[4] - 1e-12 and s * (z[1] - z[3]) >= 0

        def arrive(p, z, s, growing, target=target):
            return z[5] - target

        def touch(p, z, s, growing):
            return 1.0 if growing else s * (z[1] - z[3]) - z[4]

        arrive.terminal = touch.terminal = True
        while True:
            part = solve_ivp(
                rates, (p, p + 1.0), z, args=(s, growing), events=(arrive, touch), rtol=1e-10, atol=1e-10, max_step=1e-4
            )
            rows.append(np.array([part.y[5], s * Y + part.y[0] + part.y[1]]))
            z, p = part.y[:, -1].copy(), part.t[-1]
            if len(part.t_events[0]):
                break
            growing = True
        stress = s * Y + z[0] + z[1]
        branches.append(np.concatenate(rows, axis=1))
    return branches


def test_two_cycles_of_trip1180_converge_to_the_rate_equations():
    """The library's labelled set, tension 5 %, compression to -5 %, and the same again."""
    sheet = find_sheet("trip1180").material
    given = {"Y": 929.49, "B": 1087.7, "C": 1340.0, "m": 18.379, "b": 99.038, "h": 0.13404, "Rsat": 208.85}
    assert {k: getattr(sheet.kinematic, k) for k in given if k != "Y"} == {k: v for k, v in given.items() if k != "Y"}
    law = make_law(given, 178e3, 57.02)
    turns = [0.05, -0.05, 0.05, -0.05]
    branches = integrate(given, YOUNG, 178e3, 57.02, turns)
    bound = 1087.7 + (208.85 + 99.038) * (1 - np.exp(-18.379 * (0.05 - branches[0][1, -1] / 184e3)))
    assert 0.0 < bound - branches[0][1, -1] < 4.0
    errors, counts = [], np.array([100, 200, 400])
    for n in counts:
        strains = [np.linspace(start, end, n + 1)[1:] for start, end in zip([0.0, *turns], turns, strict=False)]
        stress = pull(law, np.concatenate(strains))[0].reshape(4, n)
        worst = 0.0
        for (strain, exact), mine, there in zip(branches, stress, strains, strict=True):
            order = np.argsort(strain)
            late = slice(n // 5, None)
            worst = max(worst, np.abs(mine[late] - np.interp(there[late], strain[order], exact[order])).max())
        errors.append(worst)
    assert fit_rate(1 / counts, np.array(errors)).rate == pytest.approx(1.0, abs=0.25)
    assert errors[-1] < 3.0, "MPa, of stresses to 1350"
