# SPDX-License-Identifier: Apache-2.0
"""Life of dies: numbers of the formulas, and of a die under a run."""

from __future__ import annotations

import numpy as np
import pytest

from presswork.case.plane.die_body import DieBody
from presswork.dies.life import find_life, judge_life
from presswork.dies.study import study_die
from presswork.dies.table import describe
from presswork.model import Fatigue
from tests.problems.die_bodies import BODY, upset

STEEL = Fatigue(strength=2400.0, strength_exponent=-0.08, ductility=0.6, ductility_exponent=-0.7)
KEYS = {"strength": 2400.0, "strength_exponent": -0.08, "ductility": 0.6, "ductility_exponent": -0.7}
YOUNG = 210e3


def test_cycles_of_strain_amplitudes_without_a_mean_stress() -> None:
    found = find_life(np.array([0.004, 0.006, 0.01]), STEEL, YOUNG)
    np.testing.assert_allclose(found, [2.9691e5, 7593.5, 738.92], rtol=5e-5)


def test_a_largest_stress_shortens_the_life() -> None:
    (found,) = find_life(np.array([0.004]), STEEL, YOUNG, np.array([1200.0]))
    assert found == pytest.approx(36635.0, rel=5e-5)


def test_what_is_pressed_never_cracks() -> None:
    found = find_life(np.array([0.01, 1e-6]), STEEL, YOUNG, np.array([-500.0, 10.0]))
    assert np.isinf(found).all()


def test_the_life_of_a_die_is_that_of_its_worst_node(tmp_path) -> None:
    result = upset(tmp_path / "run")
    body = DieBody.model_validate(BODY | {"fatigue": KEYS | {"strength": 400.0}}).build()
    study = study_die(result, "punch", body, at=(1.0,))
    (life,) = judge_life(study)
    assert life is not None
    (now,) = study.instants
    node = int(np.argmin(np.linalg.norm(study.structure.points - life.place, axis=1)))
    x, y, z, shear = now.answer.stress[node]
    tension = max(z, 0.5 * (x + y) + np.hypot(0.5 * (x - y), shear))
    swing = np.sqrt(0.5 * ((x - y) ** 2 + (y - z) ** 2 + (z - x) ** 2) + 3.0 * shear**2)
    worn = 400.0 * (2.0 * life.value) ** -0.08, 0.6 * (2.0 * life.value) ** -0.7
    assert tension * 0.5 * swing / YOUNG == pytest.approx(worn[0] * (worn[0] / YOUNG + worn[1]), rel=1e-9)
    assert any("core parts until a crack begins:" in line for line in describe(study))
    assert judge_life(study_die(result, "punch", DieBody.model_validate(BODY).build())) == [None]
