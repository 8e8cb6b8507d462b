# SPDX-License-Identifier: Apache-2.0
"""Temperature is a field: every integration point answers at the temperature given to it, in every family."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from presswork.case import Case, ShellCase, build_model
from presswork.case.space.schema import SpaceCase
from presswork.explicit.input_checks import ExplicitError
from presswork.explicit.options import ShellOptions
from presswork.explicit.shells import ExplicitShells
from presswork.explicit.solid_material import SolidMaterial
from presswork.explicit.solids import ExplicitSolids
from presswork.implicit.stepping import ImplicitProcedure
from presswork.law.elastic_plastic import make_plane_law, make_sheet_law, make_solid_law
from presswork.model import Model
from tests.consistency.test_matrix import BASE, HEATING, error_of_tangent, shell_case, solid_case, space_case

DT = 0.02
TABLE: dict[str, Any] = {
    **BASE,
    "rate": {"law": "cowper_symonds", "D": 40, "q": 5},
    "heating": HEATING,
    "density": "2700 kg/m^3",
}
HILL = {"yield_function": {"law": "hill1948", "r00": 0.8, "r45": 0.4, "r90": 0.55}}
TREATMENTS: dict[str, Any] = {
    "stabilized": {},
    "warped": {"hourglass": "stiffness"},
    "mitc": {"element": "shell4_mitc_plus"},
}
SQUARE = np.array([[0, 0, 0], [5, 0, 0], [5, 5, 0], [0, 5, 0]], dtype=float)


def implicit_model(family: str) -> Model:
    if family == "space":
        return build_model(SpaceCase.model_validate(space_case(TABLE)))
    if family == "shells":
        return build_model(ShellCase.model_validate(shell_case(TABLE)))
    return build_model(Case.model_validate(solid_case(TABLE, "implicit plane strain")))


@pytest.mark.parametrize("family", ["plane", "space", "shells"])
def test_every_point_of_an_implicit_cell_answers_at_its_own_temperature(family: str) -> None:
    """A cell is stretched evenly twice, between which its points are heated: each has the stress of its own law."""
    model = implicit_model(family)
    mechanics = ImplicitProcedure(model).mechanics
    make = {"plane": make_plane_law, "space": make_solid_law, "shells": make_sheet_law}[family]
    law = make(model.materials[0])
    components, freedoms = {"plane": (4, 2), "space": (6, 3), "shells": (3, 6)}[family]
    state = mechanics.at_rest()
    n = state.cells.eqps[0].size
    stress, history = np.zeros((n, components)), np.zeros((n, law.history_size))
    points, top = model.mesh.points, float(model.mesh.points[:, 0].max())
    low = float(points[:, 0].min())
    for hotter in (0.0, 150.0):
        degrees = 40 + hotter + np.linspace(0, 200, n)
        trial = state.duplicate()
        trial.cells.temperature[0][:] = degrees.reshape(state.cells.eqps[0].shape)
        increment = np.zeros((len(points), freedoms))
        length = top - low + state.nodes.displacement[:, 0].max()
        increment[:, 0] = 0.02 * length * (points[:, 0] - low) / (top - low)
        found = mechanics.evaluate(state, trial, increment, with_stiffness=False, dt=DT)
        assert isinstance(found, np.ndarray)
        trial.nodes.displacement = state.nodes.displacement + increment
        strain = np.zeros((n, components))
        strain[:, 0] = np.log(1.02)
        stress, history, *_ = law.update(strain, stress, history, dt=DT, temperature=degrees)
        np.testing.assert_allclose(trial.cells.stress[0].reshape(n, components), stress, rtol=1e-7, atol=1e-6)
        state = trial
    assert np.ptp(stress[:, 0]) > 30  # MPa: the points do differ
    shown = mechanics.temperature_at_points(state, 0) if family != "shells" else None
    if shown is not None:
        np.testing.assert_allclose(shown, degrees + history[:, 1])


@pytest.mark.parametrize("family", ["plane", "space", "shells"])
def test_the_tangent_holds_where_temperature_varies_over_the_cell(family: str) -> None:
    model = implicit_model(family)
    freedoms = {"plane": 2, "space": 3, "shells": 6}[family]
    error, plastic = error_of_tangent(model, freedoms, 0.02, hottest=400.0)
    assert plastic > 0.005
    assert error < 2e-6


@pytest.mark.parametrize("general", [False, True], ids=["closed_form", "general"])
def test_every_cell_of_explicit_solids_answers_at_its_own_temperature(general: bool) -> None:
    case = solid_case({**TABLE, **(HILL if general else {})}, "explicit solids")
    case["workpiece"]["mesh"]["cells"] = [3, 1]
    model = build_model(Case.model_validate(case))
    data, speed = model.materials[0], 100.0
    degrees = np.array([40.0, 200.0, 400.0])

    def start() -> ExplicitSolids:
        run = ExplicitSolids(model.mesh, [SolidMaterial.from_model(data)], axisymmetric=False)
        run.fix("all", "u", 0.0)
        run.fix("all", "v", speed * model.mesh.points[:, 1])
        run.dt = 2e-6
        return run

    run = start()
    run.prescribed_temperature = degrees
    run.advance(100)
    law = make_plane_law(data)
    stress, history = np.zeros((3, 4)), np.zeros((3, law.history_size))
    heights = 1 + speed * run.dt * np.arange(101)
    for change in np.diff(np.log(heights)):
        strain = np.tile([0.0, change, 0.0, 0.0], (3, 1))
        stress, history, *_ = law.update(strain, stress, history, dt=run.dt, temperature=degrees, tangent=False)
    np.testing.assert_allclose(run.stress, stress, rtol=1e-5, atol=1e-4)
    assert np.ptp(stress[:, 1]) > 20
    np.testing.assert_allclose(run.temperature, degrees + history[:, 1], rtol=1e-6)
    other = start()
    other.restore(run.dump())
    for each in (run, other):
        each.advance(20)
    assert run.stress.tobytes() == other.stress.tobytes()


@pytest.mark.parametrize("treatment", TREATMENTS)
@pytest.mark.parametrize("precision", ["double", "single"])
def test_every_layer_of_explicit_shells_answers_at_its_own_temperature(treatment: str, precision: Any) -> None:
    model = build_model(ShellCase.model_validate(shell_case(TABLE)))
    law, profile = make_sheet_law(model.materials[0]), np.array([40.0, 150.0, 350.0])
    options = ShellOptions(n_points=3, **TREATMENTS[treatment])

    def start() -> ExplicitShells:
        run = ExplicitShells(SQUARE, [[0, 1, 2, 3]], 1.0, law, 2.7e-9, options=options, precision=precision)
        for node, x in enumerate(SQUARE):
            run.fix([node], "u", 200.0 * x[0])
            run.fix([node], "vwpqr")
        run.dt = 1e-6
        return run

    run = start()
    run.prescribed_temperature = profile
    run.advance(200)
    stress, history = np.zeros((3, 3)), np.zeros((3, law.history_size))
    for change in np.diff(np.log(1 + 200.0 * run.dt * np.arange(201))):
        strain = np.tile([change, 0.0, 0.0], (3, 1))
        stress, history, *_ = law.update(strain, stress, history, dt=run.dt, temperature=profile, tangent=False)
    np.testing.assert_allclose(run.stress[0], stress, rtol=3e-3, atol=0.1)
    assert np.ptp(stress[:, 0]) > 30
    other = start()
    other.restore(run.dump())
    for each in (run, other):
        each.advance(20)
    assert run.stress.tobytes() == other.stress.tobytes()
    with pytest.raises(ExplicitError, match=r"prescribed_temperature has shape \(2,\)"):
        run.prescribed_temperature = [20.0, 30.0]
