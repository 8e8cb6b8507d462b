# SPDX-License-Identifier: Apache-2.0
"""Solids with strain rate, temperature, Hill's yield function and back stresses, against closed forms.

A bar in tension (axisymmetric, one cell): the axes of stretch do not turn, so that increments of ln h add up, and what
backward Euler makes of each law is one scalar equation an increment, solved here anew.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import brentq

from presswork import build_model
from presswork.case import read_case
from presswork.examples import copy_example
from presswork.model import (
    Hardening,
    Heating,
    Kinematic,
    Material,
    PrescribedDisplacement,
    Rate,
    Stage,
    Support,
    YieldFunction,
)
from presswork.recorder import run_model
from tests.problems.plane_solids import block_mesh, fit_rate, fixed_increments, make_model, run
from tests.regression.whole_runs import run_in_two_parts

YOUNG, POISSON, DENSITY = 200e3, 0.3, 7.85e-9
LENGTH = 10.0
EVERYTHING = """[materials.steel]
young = "206 GPa"
poisson = 0.3
density = "7850 kg/m^3"
yield_function = {law = "hill1948", r00 = 1.79, r45 = 1.51, r90 = 2.27}
hardening = {law = "swift", K = 565.32, e0 = 0.007117, n = 0.2589}
rate = {law = "cowper_symonds", D = 40, q = 5}
heating = {melting = 1500, exponent = 1.0, heat_capacity = "460 J/(kg*K)"}
kinematic = {law = "chaboche", C = [2000], gamma = [20]}

"""
SWIFT = Hardening("swift", np.array([565.32, 0.007117, 0.2589]))


def pull(material, strain, n, *, duration=1.0, analysis="axisymmetric", stages=1):
    """Stretch a bar by a log strain in n increments a stage, to and fro with several stages; return the procedure."""
    mesh = block_mesh("quad4", (1, 1), origin=(0.0, 0.0), size=(LENGTH, LENGTH))
    supports = (Support("left", (True, False)), Support("bottom", (False, True)))
    stroke = LENGTH * np.expm1(strain)
    motions = [
        Stage(
            f"{i}", duration=duration, prescribed=(PrescribedDisplacement("top", 1, stroke if i % 2 == 0 else -stroke),)
        )
        for i in range(stages)
    ]
    model = make_model(mesh, material, analysis=analysis, supports=supports, stages=motions, solver=fixed_increments(n))
    return run(model)[0]


def axial_stress(procedure):
    stress = procedure.state.cells.stress[0]
    assert np.allclose(stress[..., [0, 2, 3]], 0.0, atol=1e-6)
    assert np.ptp(stress[..., 1]) < 1e-6
    return float(stress[0, 0, 1])


@pytest.mark.parametrize(
    ("rate", "factor"),
    [
        (Rate("cowper_symonds", {"D": 40.4, "q": 5.0}), lambda r: 1 + (r / 40.4) ** 0.2),
        (Rate("johnson_cook", {"C": 0.02, "reference_rate": 1e-3}), lambda r: 1 + 0.02 * np.log(r / 1e-3)),
        (Rate("logarithmic", {"C": 0.02, "reference_rate": 1e-3}), lambda r: 1 + 0.02 * np.log(1 + r / 1e-3)),
    ],
)
def test_strain_rate_raises_the_flow_stress_of_a_solid(rate, factor):
    n, duration, strain = 20, 0.1, 0.2
    procedure = pull(Material("m", YOUNG, POISSON, SWIFT, rate=rate), strain, n, duration=duration)
    heights = LENGTH + LENGTH * np.expm1(strain) * np.arange(n + 1) / n
    p = p_n = 0.0
    for e in np.log(heights[1:] / LENGTH):

        def miss(p, e=e, p_n=p_n):
            speed = max(p - p_n, 1e-30) / (duration / n)
            return YOUNG * (e - p) - 565.32 * (0.007117 + p) ** 0.2589 * factor(speed)

        p = p_n = brentq(miss, p_n, e, xtol=1e-15)
    assert axial_stress(procedure) == pytest.approx(YOUNG * (strain - p), rel=1e-6)
    slow = axial_stress(pull(Material("m", YOUNG, POISSON, SWIFT), strain, n))
    assert axial_stress(procedure) > 1.05 * slow


def test_a_hot_solid_is_softer_by_johnson_and_cooks_factor():
    heating = Heating(melting=1500.0, exponent=0.8, start=600.0)
    hot = Material("m", YOUNG, POISSON, SWIFT, heating=heating)
    factor = 1 - ((600 - 20) / (1500 - 20)) ** 0.8
    stress = axial_stress(pull(hot, 0.2, 5))
    p = 0.2 - stress / YOUNG
    assert stress == pytest.approx(factor * 565.32 * (0.007117 + p) ** 0.2589, rel=1e-7)


def test_plastic_work_heats_and_softens_a_solid():
    """Constant flow stress s0, softening linear in T: ds/dp = -s k s0/(Tm - Tr), so s falls exponentially in p."""
    s0, capacity = 500.0, 4.6e8
    heating = Heating(melting=1520.0, exponent=1.0, heat_capacity=capacity)
    material = Material("m", YOUNG, POISSON, Hardening("linear", np.array([s0, 0.0])), heating=heating, density=DENSITY)
    k = 0.9 / (DENSITY * capacity)
    errors = []
    for n in (10, 20, 40):
        procedure = pull(material, 0.5, n)
        stress, p = axial_stress(procedure), float(procedure.state.cells.eqps[0][0, 0])
        exact = s0 * np.exp(-k * s0 * p / 1500.0)
        rise = float(procedure.state.cells.history[0][0, 0, 0])
        assert stress == pytest.approx(s0 * (1 - rise / 1500.0), rel=1e-9)
        errors.append(abs(stress / exact - 1))
    assert rise == pytest.approx(1500.0 * (1 - np.exp(-k * s0 * p / 1500.0)), rel=2e-3)
    assert fit_rate([10, 20, 40], errors).rate == pytest.approx(-1.0, abs=0.1)


def test_back_stresses_of_a_solid_saturate_and_reverse():
    """s = Y + a in tension; turned round a moves on by the same rule with the other sign (Chaboche 1986)."""
    Y, C, gamma, n, strain = 300.0, 8000.0, 40.0, 20, 0.05
    material = Material(
        "m",
        YOUNG,
        POISSON,
        Hardening("linear", np.array([Y, 0.0])),
        kinematic=Kinematic("chaboche", {"C": (C,), "gamma": (gamma,)}),
    )
    procedure = pull(material, strain, n, stages=2)
    stroke = np.expm1(strain) * np.arange(n + 1) / n
    path = np.concatenate([np.log1p(stroke), np.log1p(stroke[::-1][1:])])
    stress = back = 0.0
    for de in np.diff(path):
        sign = np.sign(stress + YOUNG * de - back)

        def miss(dp, de=de, stress=stress, back=back, sign=sign):
            after = (back + sign * C * dp) / (1 + gamma * dp)
            return sign * (stress + YOUNG * (de - sign * dp) - after) - Y

        dp = brentq(miss, 0.0, abs(de) + 1e-3, xtol=1e-16) if miss(0.0) > 0 else 0.0
        back = (back + sign * C * dp) / (1 + gamma * dp)
        stress += YOUNG * (de - sign * dp)
    assert axial_stress(procedure) == pytest.approx(stress, rel=1e-6)
    assert stress < -Y


@pytest.mark.parametrize("r", [(1.79, 1.51, 2.27), (0.6, 0.5, 0.8)])
def test_hill_1948_in_plane_strain_meets_its_limit_stress(r):
    """Tension along y where z is held: s_z = F s_y/(F + G), s_y^2 (F + H - F^2/(F + G)) = Y^2."""
    H = r[0] / (1 + r[0])
    G, F, Y = 1 - H, H / r[2], 300.0
    N = (r[1] + 0.5) * (F + G)
    hill = YieldFunction("hill1948", (F, G, H, 1.5, 1.5, N))
    material = Material("m", YOUNG, POISSON, Hardening("linear", np.array([Y, 0.0])), yield_function=hill)
    stress = pull(material, 0.05, 10, analysis="plane_strain").state.cells.stress[0]
    limit = Y / np.sqrt(F + H - F**2 / (F + G))
    np.testing.assert_allclose(stress[..., 1], limit, rtol=1e-5)
    np.testing.assert_allclose(stress[..., 2], F / (F + G) * limit, rtol=1e-4)
    np.testing.assert_allclose(stress[..., [0, 3]], 0.0, atol=1e-5 * limit)


def test_a_resumed_run_with_every_law_gives_the_same_bits(tmp_path):
    text = copy_example("upsetting_q4", tmp_path / "case").read_text(encoding="utf-8")
    head, rest = text.split("[materials.steel]")
    case = tmp_path / "case.toml"
    case.write_text(head + EVERYTHING + rest[rest.index("[tools.punch]") :].replace("stroke = 9.0", "stroke = 3.0"))
    model = build_model(read_case(case, ["workpiece.mesh.cells=[3,3]", "stages.0.duration=1.0"]))
    whole = run_model(model, tmp_path / "whole", threads=1).result

    parts = run_in_two_parts(model, tmp_path / "parts", lambda progress: progress.fraction > 0.3)
    np.testing.assert_array_equal(parts.history["punch.force"], whole.history["punch.force"])
    np.testing.assert_array_equal(parts.field("temperature", step=-1), whole.field("temperature", step=-1))
    assert parts.field("temperature", step=-1).max() > 50.0
    assert abs(whole.summary["energy"]["error_percent"]) < 0.5


def test_threads_do_not_change_the_bits_of_the_general_law():
    material = Material(
        "m",
        YOUNG,
        POISSON,
        SWIFT,
        rate=Rate("logarithmic", {"C": 0.02, "reference_rate": 1e-3}),
        kinematic=Kinematic("chaboche", {"C": (2e3,), "gamma": (20.0,)}),
    )
    mesh = block_mesh("quad4", (9, 9), origin=(0.0, 0.0), size=(LENGTH, LENGTH))
    supports = (Support("left", (True, False)), Support("bottom", (True, True)))
    motion = [PrescribedDisplacement("top", 1, -2.0)]
    model = make_model(mesh, material, supports=supports, prescribed=motion, solver=fixed_increments(3))
    one, two = (run(model, threads=threads)[0].state for threads in (1, 2))
    np.testing.assert_array_equal(one.cells.stress[0], two.cells.stress[0])
    np.testing.assert_array_equal(one.cells.history[0], two.cells.history[0])
