# SPDX-License-Identifier: Apache-2.0
"""Laws from shared libraries in plane stress and in space, against the built-in laws and closed forms."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from presswork import _core
from presswork.body.shell_arrays import ShellArrays
from presswork.case import CaseError, ShellCase, StampingCase, build_model
from presswork.case.description import describe
from presswork.case.space.schema import SpaceCase
from presswork.explicit.input_checks import ExplicitError
from presswork.explicit.options import ShellOptions
from presswork.explicit.shells import ExplicitShells
from presswork.implicit.energy import Work
from presswork.implicit.stepping import ImplicitProcedure
from presswork.law.umat import compile_law, open_sheet_law
from presswork.recorder import run_model
from tests.problems.plane_solids import run
from tests.regression.test_stamping_runs import pull

YOUNG, POISSON, YIELD, MODULUS = 70e3, 0.33, 150.0, 300.0
DENSITY = 2.7e-9
LAWS = {
    "young": YOUNG,
    "poisson": POISSON,
    "hardening": {"law": "linear", "yield_stress": YIELD, "modulus": MODULUS},
    "density": "2700 kg/m^3",
}
SHELLS = [e.name for e in _core.elements() if e.family == _core.Family.shell and e.in_implicit]
SAME = 1e-8
SOLVER = {"initial_increment": 0.05, "max_increment": 0.05, "force_tolerance": 1e-10, "displacement_tolerance": 1e-8}


def user_table(library: Path) -> dict[str, Any]:
    props = [YOUNG, POISSON, YIELD, MODULUS]
    return {"umat": str(library), "props": props, "state_variables": 7, "plastic_strain": 1, "density": DENSITY}


def strip_case(table: dict[str, Any], element: str = "shell4_mitc") -> ShellCase:
    """A clamped strip that is bent, then pulled and twisted, far into the plastic range."""
    case = {
        "title": "strip",
        "analysis": "shell",
        "workpiece": {
            "material": "metal",
            "element": element,
            "section": {"thickness": 1, "points": 3},
            "mesh": {"size": [10, 5], "cells": [2, 1]},
        },
        "materials": {"metal": table},
        "boundary": {"end": {"set": "left", "hold": "clamped"}},
        "stages": [
            {"name": "bend", "displacement": [{"set": "right", "component": "z", "value": 1.0}]},
            {"name": "pull", "displacement": [{"set": "right", "component": "x", "value": 0.3},
                                              {"set": "right", "component": "y", "value": 0.1}]},
        ],
        "solver": SOLVER,
    }  # fmt: skip
    return ShellCase.model_validate(case)


def strip(table: dict[str, Any], element: str) -> Any:
    return build_model(strip_case(table, element))


@pytest.mark.parametrize("element", SHELLS)
def test_a_umat_of_von_mises_is_the_built_in_law_in_every_implicit_shell(element: str, umat_sheet: Path) -> None:
    """Forces, stiffness, layers and thickness are the same over four large increments: so iterations converge alike."""
    mechanics = [ImplicitProcedure(strip(table, element)).mechanics for table in (LAWS, user_table(umat_sheet))]
    states = [each.at_rest() for each in mechanics]
    rng, n = np.random.default_rng(1), len(states[0].nodes.displacement)
    for _ in range(4):
        increment = 0.03 * rng.standard_normal((n, 6)) * [1, 1, 1, 0.3, 0.3, 0.3]
        forces, matrices = [], []
        for k, each in enumerate(mechanics):
            trial = states[k].duplicate()
            found = each.evaluate(states[k], trial, increment, with_stiffness=True)
            assert isinstance(found, np.ndarray), str(found)
            forces.append(found)
            matrices.append(each._stiffness[0].copy())
            trial.nodes.displacement, trial.nodes.increment = states[k].nodes.displacement + increment, increment
            each.end_increment(states[k], trial, 0.0)
            states[k] = trial
        for own, user in (forces, matrices):
            np.testing.assert_allclose(user, own, rtol=0, atol=SAME * np.abs(own).max())
    a, b = states
    assert a.cells.eqps[0].max() > 0.02
    np.testing.assert_allclose(
        b.cells.stress[0], a.cells.stress[0], rtol=0, atol=SAME * np.abs(a.cells.stress[0]).max()
    )
    np.testing.assert_allclose(b.cells.eqps[0], a.cells.eqps[0], rtol=0, atol=SAME * a.cells.eqps[0].max())
    np.testing.assert_allclose(b[ShellArrays].thickness[0], a[ShellArrays].thickness[0], rtol=SAME)
    told = b.cells.history[0][..., 2:8]
    np.testing.assert_array_equal(told[0, 0, :, 1], [1, 2, 3])  # KSPT, from the bottom
    np.testing.assert_array_equal(told[:, 0, 0, 2], 1 + np.arange(len(told)))  # NOEL


def test_a_run_of_a_shell_with_a_umat_is_that_of_the_built_in_law(umat_sheet: Path) -> None:
    """Bent and pulled: displacement, reaction, energies and state variables."""
    (own, _), (user, _) = (run(strip(table, "shell4_mitc")) for table in (LAWS, user_table(umat_sheet)))
    a, b = own.state, user.state
    assert a.cells.eqps[0].max() > 0.02
    for name in ("displacement", "reaction"):
        x, y = getattr(a.nodes, name), getattr(b.nodes, name)
        np.testing.assert_allclose(y, x, rtol=0, atol=SAME * np.abs(x).max())
    fields = [each.mechanics.cell_fields(each.state) for each in (own, user)]
    assert set(fields[1]) - set(fields[0]) == {"state_variables"}
    np.testing.assert_allclose(fields[1]["state_variables"][:, 0], b.cells.eqps[0].mean(axis=1))
    # all work of a UMAT's stress is told with the plastic work
    stored = [each.mechanics.elastic_energy(each.state) + each.state[Work].plastic_work for each in (own, user)]
    assert stored[1] == pytest.approx(stored[0], rel=5e-3)  # the trapezoidal rule of both


EXPLICIT: dict[str, dict[str, Any]] = {
    "stabilized": {},
    "warped": {"hourglass": "stiffness"},
    "plain": {"hourglass": "viscous", "warping": False},
    "mitc": {"element": "shell4_mitc_plus"},
}


@pytest.mark.parametrize("nodes", [4, 3])
@pytest.mark.parametrize("treatment", EXPLICIT)
def test_a_umat_of_von_mises_is_the_built_in_law_in_explicit_shells(
    treatment: str, nodes: int, umat_sheet: Path
) -> None:
    points = np.array([[x, y, 0.3 * x * y / 25] for y in (0.0, 5.0, 9.0) for x in (0.0, 5.0, 11.0)])
    quads = np.array([[0, 1, 4, 3], [1, 2, 5, 4], [3, 4, 7, 6], [4, 5, 8, 7]])
    cells = quads if nodes == 4 else np.concatenate([quads[:, :3], quads[:, [0, 2, 3]]])
    velocity = 5e4 * np.random.default_rng(2).standard_normal((9, 6)) * [1, 1, 1, 0.2, 0.2, 0.2]
    runs = []
    for table in (LAWS, user_table(umat_sheet)):
        material = strip(table, "shell4_mitc").materials[0]
        options = ShellOptions(n_points=3, tabulate=False, **EXPLICIT[treatment])
        shells = ExplicitShells(points, cells, 1.0, open_sheet_law(material), DENSITY, options=options)
        shells.velocity = velocity
        shells.dt = 2e-7
        shells.advance(600)
        runs.append(shells)
    own, user = runs
    assert own.equivalent_plastic_strain.max() > 0.01
    np.testing.assert_allclose(user.stress, own.stress, rtol=0, atol=SAME * np.abs(own.stress).max())
    np.testing.assert_allclose(user.position, own.position, rtol=0, atol=SAME)
    np.testing.assert_allclose(user.thickness, own.thickness, rtol=SAME)
    told = user.history_at_points[..., 2:8]
    np.testing.assert_allclose(told[..., 0], user.time - user.dt)
    np.testing.assert_array_equal(told[:, 0, 0, 2], 1 + np.arange(len(cells)))
    other = ExplicitShells(points, cells, 1.0, open_sheet_law(material), DENSITY, options=options)
    other.restore(user.dump())
    for each in (user, other):
        each.advance(20)
    assert user.stress.tobytes() == other.stress.tobytes()


def test_explicit_shells_of_single_precision_refuse_a_umat(umat_sheet: Path) -> None:
    law = open_sheet_law(strip(user_table(umat_sheet), "shell4_mitc").materials[0])
    points = np.array([[0, 0, 0], [5, 0, 0], [5, 5, 0], [0, 5, 0]], dtype=float)
    with pytest.raises(ExplicitError, match="double precision"):
        ExplicitShells(points, [[0, 1, 2, 3]], 1.0, law, DENSITY, precision="single")


def test_a_device_refuses_a_umat_and_names_the_way_out(umat_sheet: Path) -> None:
    law = open_sheet_law(strip(user_table(umat_sheet), "shell4_mitc").materials[0])
    points = np.array([[0, 0, 0], [5, 0, 0], [5, 5, 0], [0, 5, 0]], dtype=float)
    told = r'device = "?.?host.* does not compute laws of shared libraries \(UMAT\): take device = "cpu"'
    with pytest.raises(ExplicitError, match=told):
        ExplicitShells(points, [[0, 1, 2, 3]], 1.0, law, DENSITY, device="host")


# --- what is refused ---


def test_a_routine_that_is_not_written_for_plane_stress_is_refused_in_shells(umat_laws: Path) -> None:
    table = {"umat": str(umat_laws), "props": [1, YOUNG, POISSON, 500, 0.007, 0.25], "state_variables": 1}
    with pytest.raises(CaseError, match="writes more than NTENS = 3 stresses"):
        strip(table, "shell4_mitc")


def test_the_number_of_state_variables_is_checked_in_shells(umat_sheet: Path) -> None:
    with pytest.raises(CaseError, match="writes beyond its 3 state variables"):
        strip({**user_table(umat_sheet), "state_variables": 3}, "shell4_mitc")


def test_the_rate_jacobian_is_refused_in_shells(umat_sheet: Path) -> None:
    with pytest.raises(CaseError, match="no shell takes it"):
        strip({**user_table(umat_sheet), "jacobian": "jaumann_kirchhoff"}, "shell4_mitc")


# --- space ---


def block_case(table: dict[str, Any], element: str = "hex8_fbar") -> SpaceCase:
    case = {
        "title": "block",
        "analysis": "solid",
        "workpiece": {"material": "metal", "element": element, "mesh": {"size": [2, 1, 1], "cells": [2, 1, 1]}},
        "materials": {"metal": table},
        "boundary": {"end": {"set": "left", "fix": ["x", "y", "z"]}},
        "stages": [
            {"name": "shear", "displacement": [{"set": "right", "component": "y", "value": 0.5},
                                               {"set": "right", "component": "x", "value": 0.1},
                                               {"set": "right", "component": "z", "value": -0.3}]},
        ],
        "solver": SOLVER,
    }  # fmt: skip
    return SpaceCase.model_validate(case)


def block(table: dict[str, Any], element: str) -> Any:
    return build_model(block_case(table, element))


def stamping_case(table: dict[str, Any]) -> StampingCase:
    return StampingCase.model_validate(pull(materials={"steel": table}))


@pytest.mark.parametrize("element", ["hex8", "hex8_fbar"])
def test_a_umat_of_swift_is_the_built_in_law_in_space(element: str, umat_laws: Path) -> None:
    own_table = {**LAWS, "hardening": {"law": "swift", "K": 500, "e0": 0.007, "n": 0.25}}
    props = [1, YOUNG, POISSON, 500, 0.007, 0.25]
    user_table = {"umat": str(umat_laws), "props": props, "state_variables": 1, "plastic_strain": 1}
    (own, own_reports), (user, user_reports) = (run(block(table, element)) for table in (own_table, user_table))
    assert [len(r.log) for r in user_reports] == [len(r.log) for r in own_reports]
    assert own.state.cells.eqps[0].max() > 0.1
    for name in ("displacement", "reaction"):
        x, y = getattr(own.state.nodes, name), getattr(user.state.nodes, name)
        np.testing.assert_allclose(y, x, rtol=0, atol=SAME * np.abs(x).max())
    a, b = own.state.cells.stress[0], user.state.cells.stress[0]
    np.testing.assert_allclose(b, a, rtol=0, atol=SAME * np.abs(a).max())


# --- a law of one C++ file ---


@pytest.fixture(scope="module")
def norton(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The law of docs/adding_a_law.md."""
    page = (Path(__file__).parents[2] / "docs" / "adding_a_law.md").read_text(encoding="utf-8")
    source = tmp_path_factory.mktemp("norton") / "norton.cpp"
    source.write_text(re.search(r"```cpp\n(.*?)```", page, re.DOTALL).group(1))
    return compile_law(source)


@pytest.mark.parametrize("family", ["shell", "space"])
def test_a_law_of_one_file_relaxes_as_its_closed_form(family: str, norton: Path) -> None:
    """Norton's creep in a bar pulled at once and held: s^(1-n) = s0^(1-n) + (n-1) E A t, uniaxial."""
    E, A, n, seconds = 200e3, 1e-14, 4.0, 50.0
    material = {"umat": str(norton), "props": [E, 0.3, A, n], "state_variables": 1, "plastic_strain": 1}
    build = strip if family == "shell" else block
    element = "shell4_mitc" if family == "shell" else "hex8_fbar"
    model = build(material, element)
    data = model.materials[0]
    assert data.young == pytest.approx(E, rel=1e-6)
    assert data.poisson == pytest.approx(0.3, rel=1e-6)
    law, components = _core.Umat(data.umat.library, data.umat.props, 1), 3 if family == "shell" else 6

    def relax(steps: int) -> float:
        """Stress at the end, of an update law with the strains across such that there is no stress across."""
        stress, state = np.zeros(components), np.zeros(1)
        strain = np.zeros(components)
        across = [1] if family == "shell" else [1, 2]
        for step in range(steps + 1):
            strain[:] = 0.0
            strain[0] = 1e-3 if step == 0 else 0.0
            dt = 1e-9 if step == 0 else seconds / steps
            for _ in range(20):
                status, end, after, tangent = law.update(strain, stress, state, dt)
                assert status == _core.LawStatus.done
                off = end[across]
                if np.abs(off).max() < 1e-10:
                    break
                strain[across] -= np.linalg.solve(tangent[np.ix_(across, across)], off)
            stress, state = end, after
        return float(stress[0])

    coarse, fine = relax(40), relax(80)
    exact = ((E * 1e-3) ** (1 - n) + (n - 1) * E * A * seconds) ** (1 / (1 - n))
    assert (coarse - exact) / (fine - exact) == pytest.approx(2.0, abs=0.1)
    assert 2 * fine - coarse == pytest.approx(exact, rel=1e-4)


@pytest.mark.parametrize("family", ["shell", "space"])
def test_a_law_of_one_file_has_its_tangent_in_shells_and_in_space(family: str, norton: Path) -> None:
    law = _core.Umat(str(norton), [200e3, 0.3, 1e-14, 4.0], 1)
    size = 3 if family == "shell" else 6
    rng = np.random.default_rng(4)
    stress, state = np.zeros(size), np.zeros(1)
    for _ in range(3):
        _, stress, state, _ = law.update(1e-3 * rng.standard_normal(size), stress, state, 10.0)
    strain = 1e-3 * rng.standard_normal(size)
    tangent = law.update(strain, stress, state, 10.0)[3]
    numerical = np.zeros((size, size))
    for j in range(size):
        move = np.zeros(size)
        move[j] = 1e-8
        ends = [law.update(strain + sign * move, stress, state, 10.0)[1] for sign in (1, -1)]
        numerical[:, j] = (ends[0] - ends[1]) / 2e-8
    np.testing.assert_allclose(tangent, numerical, rtol=0, atol=1e-6 * 200e3)
    assert state[0] > 1e-4


# --- stampings ---


@pytest.mark.parametrize("procedure", ["explicit", "implicit"])
def test_a_stamping_of_a_umat_is_that_of_the_built_in_law(procedure: str, umat_sheet: Path, tmp_path: Path) -> None:
    """A strip pulled to 10 %, then let go: springback takes the state variables over."""
    results = []
    for name, table in (("own", LAWS), ("user", {**user_table(umat_sheet), "yield_stress": YIELD})):
        case = pull(procedure=procedure, materials={"steel": table}, springback={})
        case["blank"]["element_size"] = 4
        case["stages"][0]["displacement"] += [{"set": "right", "component": "z", "value": 0}]
        case["implicit"] = {"initial_increment": 0.1, "max_increment": 0.1}
        outcome = run_model(build_model(StampingCase.model_validate(case)), tmp_path / name, threads=1)
        assert outcome.status == "completed", outcome.reason
        results.append(outcome.result)
    own, user = results
    assert own.field("eqps").max() > 0.05
    for name in ("displacement", "eqps", "thickness"):
        np.testing.assert_allclose(user.field(name), own.field(name), rtol=0, atol=1e-6 * np.abs(own.field(name)).max())
    np.testing.assert_allclose(user.field("SDV1"), user.field("eqps"), rtol=0.02)


def test_a_stamping_asks_for_what_a_umat_does_not_tell(umat_sheet: Path) -> None:
    table = user_table(umat_sheet)
    del table["density"]
    with pytest.raises(CaseError) as failed:
        build_model(StampingCase.model_validate(pull(materials={"steel": table})))
    assert [p.key for p in failed.value.problems] == ["materials.steel.density", "materials.steel.yield_stress"]


@pytest.mark.parametrize("build", [strip_case, block_case, stamping_case], ids=["shell", "space", "stamping"])
def test_a_case_is_described_without_opening_its_library(build: Any, tmp_path: Path) -> None:
    """Whoever only checks a case runs no code of others."""
    library = tmp_path / "law.so"
    library.write_bytes(b"no library")
    model = build_model(build({**user_table(library), "yield_stress": YIELD}), run_user_code=False)
    assert np.isnan(model.materials[0].young)
    assert "not opened" in describe(model)
