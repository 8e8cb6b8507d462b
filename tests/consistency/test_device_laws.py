# SPDX-License-Identifier: Apache-2.0
"""Every law of a sheet on the host build of the code for cards: the same run as by the loop of the CPU."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from presswork import _core
from presswork.case import ShellCase, build_model
from presswork.evolution.damage import DamageLaw
from presswork.explicit.device import Device
from presswork.explicit.shells import ExplicitError, ExplicitShells, ShellOptions
from presswork.explicit.space import Precision
from presswork.law.elastic_plastic import make_sheet_law
from presswork.law.umat import SheetLaw
from presswork.model import Damage, ExplicitElement
from tests.consistency.test_explicit_shells import halve, mesh, results
from tests.consistency.test_matrix import BASE, FEATURES, USER, shell_case

CYCLES, SHELLS_ALONG = 120, 8
AGREEMENT = {"double": 1e-9, "single": 1e-4}
"""Of the largest value: round-off, and what Newton's method leaves of a flow stress."""
LAWS = [name for name in FEATURES if name not in USER]


def law_of(feature: str) -> _core.SheetLaw:
    return make_sheet_law(build_model(ShellCase.model_validate(shell_case({**BASE, **FEATURES[feature]}))).materials[0])


def pull(
    device: Device,
    law: SheetLaw,
    precision: Precision = "double",
    *,
    damage: tuple[DamageLaw, ...] = (),
    **how: Any,
) -> ExplicitShells:
    """Pull a wavy sheet of quadrilaterals and triangles by 10 %, and bend it; the process is 3 times as slow."""
    points, cells = mesh(SHELLS_ALONG)
    options = ShellOptions(n_points=3, **how)
    shells = ExplicitShells(
        points,
        halve(cells),
        0.8,
        law,
        2.7e-9,
        damage=damage,
        heating=(20.0, bool(damage)),
        options=options,
        precision=precision,
        device=device,
    )
    shells.fix(np.flatnonzero(points[:, 0] == 0), "uvwpqr")
    shells.fix(np.flatnonzero(points[:, 0] == 48), "u", 20000.0)
    shells.force = np.tile([0.0, 0.0, 2.0, 0.0, 0.0, 0.0], (len(points), 1))
    shells.set_slower(3.0)
    return shells


def compare(runs: list[ExplicitShells], within: float) -> None:
    for expected, found in zip(*map(results, runs), strict=True):
        np.testing.assert_allclose(found, expected, rtol=0, atol=within * np.abs(expected).max())


@pytest.mark.parametrize("element", ["shell4_1pt", "shell4_mitc_plus"])
@pytest.mark.parametrize("feature", LAWS)
def test_every_law_of_a_sheet_runs_on_a_device(feature: str, element: ExplicitElement) -> None:
    """Motion, stress, history and thickness after plastic flow."""
    law = law_of(feature)
    runs = [pull(device, law, element=element) for device in ("cpu", "host")]
    for run in runs:
        run.advance(CYCLES)
    assert runs[0].equivalent_plastic_strain.max() > 0.01
    compare(runs, AGREEMENT["double"])


@pytest.mark.parametrize("feature", ["all of them", "hensel_spittel", "yld2000"])
def test_laws_in_single_precision_agree(feature: str) -> None:
    runs = [pull(device, law_of(feature), "single") for device in ("cpu", "host")]
    for run in runs:
        run.advance(CYCLES)
    compare(runs, AGREEMENT["single"])


def test_a_law_by_its_formula_agrees() -> None:
    runs = [pull(device, law_of("swift_voce"), tabulate=False) for device in ("cpu", "host")]
    for run in runs:
        run.advance(CYCLES)
    compare(runs, AGREEMENT["double"])


@pytest.mark.parametrize("element", ["shell4_1pt", "shell4_mitc_plus"])
@pytest.mark.parametrize("precision", ["double", "single"])
def test_layers_are_computed_at_their_own_temperatures(precision: Precision, element: ExplicitElement) -> None:
    runs = [pull(device, law_of("adiabatic heating"), precision, element=element) for device in ("cpu", "host")]
    for run in runs:
        run.prescribed_temperature = np.array([40.0, 150.0, 350.0])
        run.advance(CYCLES)
    assert np.ptp(runs[0].stress[:, :, 0], axis=1).max() > 30.0
    compare(runs, AGREEMENT[precision])


@pytest.mark.parametrize("element", ["shell4_1pt", "shell4_mitc_plus"])
@pytest.mark.parametrize("precision", ["double", "single"])
def test_damage_grows_as_by_the_loop_of_the_cpu(precision: Precision, element: ExplicitElement) -> None:
    """Criteria by the largest stress, by triaxiality, rate and temperature; two calls, and a dump between."""
    parameters = dict(zip(("d1", "d2", "d3", "d4", "d5"), (0.05, 3.44, -2.12, 0.002, 0.61), strict=True))
    parameters |= {"reference_rate": 1.0, "reference": 20.0, "melting": 1460.0}
    criteria = {"cockcroft_latham": {}, "rice_tracey": {"factor": 0.283, "exponent": 1.5}, "johnson_cook": parameters}
    damage = tuple(DamageLaw(Damage(name, own)) for name, own in criteria.items())
    law = law_of("adiabatic heating")
    runs = [pull(d, law, precision, element=element, damage=damage) for d in ("cpu", "host")]
    for run in runs:
        run.advance(CYCLES // 2)
        run.restore(run.dump())
        run.advance(CYCLES // 2)
    expected, found = (run.damage for run in runs)
    assert len(expected) == len(criteria)
    for name, values in expected.items():
        assert values.max() > 1e-3
        np.testing.assert_allclose(found[name], values, rtol=0, atol=AGREEMENT[precision] * values.max(), err_msg=name)


@pytest.mark.parametrize("element", ["shell4_1pt", "shell4_mitc_plus"])
def test_a_law_that_finds_no_stress_names_shell_and_cycle_as_the_loop_of_the_cpu(element: ExplicitElement) -> None:
    found = []
    for device in ("cpu", "host"):
        run = pull(device, law_of("hill1948"), element=element)
        run.fix([40], "u", 5e7)
        with pytest.raises(ExplicitError, match=r"the material law of shell \d+ has failed in cycle \d+ ") as stop:
            run.advance(100)
        found.append(str(stop.value))
    assert found[0] == found[1]
