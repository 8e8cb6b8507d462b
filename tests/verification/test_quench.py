# SPDX-License-Identifier: Apache-2.0
"""Quenching: a long cylinder against a computed table, and closed forms of phases and transformation plasticity."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from presswork import _core, model
from presswork.law.elastic_plastic import make_plane_law, make_solid_law
from presswork.law.phase_mixture import PhaseMixture
from presswork.model import FloatArray
from tests.problems.quenched_cylinder import cylinder, find_profile, read_table, run

K = 1.3889e-4
"""Greenwood and Johnson: 5/6 of a change of volume of 2.5 % over 150 MPa [1/MPa]."""


@pytest.mark.parametrize(("which", "off"), [("thermal", 0.02), ("martensite", 0.035), ("trip", 0.05)])
def test_a_long_cylinder_has_the_stress_of_the_table(which: str, off: float) -> None:
    table = read_table(which)
    inside = table[:, 0] < 0.97  # the mean of the last cell is no value at the surface
    found = find_profile(run(cylinder(which)), table[:, 0])
    largest = float(np.abs(table[:, 1:]).max())
    np.testing.assert_allclose(found[inside], table[inside, 1:], atol=off * largest)


def test_martensite_throughout_leaves_no_stress_without_yield() -> None:
    procedure = run(cylinder("elastic"))
    assert np.ptp(procedure.state.cells.temperature[0]) < 1e-2
    assert np.abs(procedure.state.cells.stress[0]).max() < 0.5


@pytest.mark.parametrize("which", ["thermal", "trip"])
def test_cells_of_first_order_do_not_flow_where_growth_varies_over_them(which: str) -> None:
    """A corner that is quenched: the work of a free body is nothing, and no more flows than its strains ask for."""
    data = cylinder(which)
    data["workpiece"]["mesh"] = {"size": [12.0, 12.0], "cells": [6, 6]}
    water = data["stages"][0]["convection"][0]
    data["stages"][0] |= {"duration": 20.0, "convection": [water, water | {"set": "top"}]}
    data["heat"]["max_change"] = 15.0
    procedure = run(data)
    assert abs(procedure.energy_balance()["error_percent"]) < 5.0
    assert procedure.state.cells.eqps[0].max() < 0.03


def steel(*, yields: bool, trip: float = 0.0) -> model.Material:
    """Return a steel whose martensite is longer, harder, and forms with transformation plasticity."""
    rows = np.array([[0.0, 200.0], [1000.0, 50.0]]), np.array([[0.0, 1500.0], [1000.0, 500.0]])
    one = np.array([[0.0, 22e-6]]), np.array([[0.0, 12e-6]])
    austenite = model.Phase(expansion=one[0], yield_stress=rows[0] if yields else None)
    martensite = model.Phase(
        expansion=one[1], strain=0.009, trip=trip, yield_stress=rows[1] if yields else None
    )  # fmt: skip
    return model.Material(
        "steel",
        200e3,
        0.3,
        model.Hardening("linear", np.array([100.0, 500.0])) if yields else model.never_yield(200e3),
        heating=model.Heating(start=850.0),
        transformation=model.Transformation(
            martensite_start=330.0, mechanics=model.PhaseMechanics((austenite, *[martensite] * 4))
        ),
    )


def mix(material: model.Material, fraction: FloatArray, temperature: FloatArray) -> FloatArray:
    """Return the mixture (n, 3) of fractions of martensite (n,)."""
    assert material.phases is not None
    none = np.zeros_like(fraction)
    return PhaseMixture(material, material.phases).at(np.stack([none, none, none, fraction]), temperature)


@pytest.mark.parametrize(("make", "components"), [(make_plane_law, 4), (make_solid_law, 6)])
def test_a_rod_under_constant_stress_grows_by_k_times_the_stress(make: Any, components: int) -> None:
    """By its free growth, and K s at the end of a whole transformation."""
    material, s, steps = steel(yields=False, trip=K), 20.0, 50
    law = make(material)
    history, stress = np.zeros((1, law.history_size)), np.zeros((1, components))
    fraction = np.linspace(0.0, 1.0, steps + 1)
    given = mix(material, fraction, np.full(steps + 1, 20.0))
    given[:, 0] -= given[0, 0]
    stress[0, 0], total = s, np.zeros(components)
    for row in given[1:]:
        # strain by which the stress stays: the law is linear in it
        zero, _, _, tangent, _ = law.update(np.zeros((1, components)), stress, history, mixture=row[None])
        strain = np.linalg.solve(tangent[0], stress[0] - zero[0])
        stress, history, _, _, failed = law.update(strain[None], stress, history, mixture=row[None])
        assert not failed.any()
        total += strain
    np.testing.assert_allclose(stress[0], np.eye(components)[0] * s, atol=1e-9)
    assert total[0] - given[-1, 0] == pytest.approx(K * s, rel=1e-9)
    assert total[1] - given[-1, 0] == pytest.approx(-0.5 * K * s, rel=1e-9)
    assert given[-1, 0] == pytest.approx(0.009, rel=1e-12)


@pytest.mark.parametrize(("make", "components"), [(make_plane_law, 4), (make_solid_law, 6)])
def test_tangent_is_right_with_phases_and_transformation_plasticity(make: Any, components: int) -> None:
    material = steel(yields=True, trip=K)
    law = make(material)
    rng = np.random.default_rng(11)
    n = 60
    before, after = np.sort(rng.uniform(0.0, 1.0, (2, n)), axis=0)
    history = np.zeros((n, law.history_size))
    mixture_n, mixture = (mix(material, f, rng.uniform(20, 300, n)) for f in (before, after))
    history[:, 1:3] = mixture_n[:, :2]
    stress, strain = 150 * rng.standard_normal((n, components)), 4e-3 * rng.standard_normal((n, components))
    strain[:15] *= 0.01
    new, kept, _, tangent, failed = law.update(strain, stress, history, mixture=mixture)
    exact = law.differentiate(strain, stress, history, mixture=mixture)
    assert not failed.any()
    assert (kept[:, 0] > 0).any()
    assert (kept[:, 0] == 0).any()
    np.testing.assert_allclose(kept[:, 1:3], mixture[:, :2])
    assert np.abs(tangent - exact).max() < 1e-7 * np.abs(exact).max()
    step = 1e-7 * rng.standard_normal((n, components))
    moved = [law.update(strain + sign * step, stress, history, mixture=mixture)[0] for sign in (1, -1)]
    change = np.einsum("nij,nj->ni", tangent, step)
    steady = np.abs(0.5 * (moved[0] - moved[1]) - change).max(axis=1) < 1e-4 * np.abs(change).max()
    assert steady.mean() > 0.9  # others cross the yield surface
    flow = law.flow_stress(np.ascontiguousarray(kept[:, 0]))[0] * mixture[:, 2]
    deviator = new.copy()
    deviator[:, :3] -= new[:, :3].mean(axis=1, keepdims=True)
    square = (deviator[:, :3] ** 2).sum(axis=1) + 2 * (deviator[:, 3:] ** 2).sum(axis=1)
    yields = kept[:, 0] > 0
    np.testing.assert_allclose(np.sqrt(1.5 * square)[yields], flow[yields], rtol=1e-8)


def test_a_law_without_a_mixture_goes_on_as_before() -> None:
    law = make_plane_law(steel(yields=False))
    history = np.zeros((1, law.history_size))
    history[0, 1:3] = 0.004, 1e-5
    strain = np.array([[1e-4, 0.0, 0.0, 0.0]])
    stress, kept, *_ = law.update(strain, np.zeros((1, 4)), history)
    np.testing.assert_allclose(kept, history)
    assert stress[0, 0] == pytest.approx(1e-4 * 200e3 * 0.7 / (1.3 * 0.4))


def test_phases_are_for_solids_without_back_stress() -> None:
    with pytest.raises(ValueError, match="phases are for solids"):
        _core.SheetLaw(
            200e3, 0.3, _core.YieldFunction.hill1948([0.5, 0.5, 0.5, 1.5, 1.5, 1.5]), _core.HardeningLaw.linear,
            [100.0, 0.0], phases=True,
        )  # fmt: skip
