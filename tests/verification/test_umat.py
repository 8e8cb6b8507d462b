# SPDX-License-Identifier: Apache-2.0
"""Laws from shared libraries (tests/data/umat) against the built-in law and closed forms."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from presswork import _core, build_model
from presswork.case import read_case
from presswork.examples import copy_example
from presswork.implicit.stepping import GaveUpError
from presswork.law.at_rest import history_at_rest
from presswork.model import Material, PrescribedDisplacement, Stage, Support, Umat
from presswork.recorder import run_model
from tests.problems.plane_solids import block_mesh, drive_boundary, fixed_increments, make_model, run
from tests.regression.whole_runs import run_in_two_parts

YOUNG, POISSON = 200e3, 0.3
SWIFT = (700.0, 0.01, 0.2)


def umat(library, properties, n_state, **options) -> Material:
    """Return a Material of a UMAT with the elastic constants of the tests."""
    return Material("user", YOUNG, POISSON, None, umat=Umat(str(library), properties, n_state, **options))


def shape(angle: float) -> np.ndarray:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s], [s, c]])


def upset(tmp_path, name, material_lines, *, cells=6):
    """Upset the example's cylinder to 40 % with a material; return history and result."""
    text = copy_example("upsetting_q4", tmp_path / f"{name}_case").read_text(encoding="utf-8")
    head, rest = text.split("[materials.steel]")
    tail = rest[rest.index("[tools.punch]") :].replace("stroke = 9.0", "stroke = 6.0")
    case = tmp_path / f"{name}.toml"
    case.write_text(f"{head}[materials.steel]\n{material_lines}\n{tail}")
    settings = [
        f"workpiece.mesh.cells=[{cells},{cells}]",
        "solver.force_tolerance=1e-10",
        "solver.displacement_tolerance=1e-8",
    ]
    outcome = run_model(build_model(read_case(case, settings)), tmp_path / name, threads=1)
    assert outcome.status == "completed", outcome.reason
    return outcome.result


BUILT_IN = """young = 200e3
poisson = 0.3
hardening = {law = "swift", K = 700, e0 = 0.01, n = 0.2}"""
LINEAR = """young = 200e3
poisson = 0.3
hardening = {law = "linear", yield_stress = 700, modulus = 300}"""


def assert_same_run(own, reference, plastic_strain):
    assert len(own.history["time"]) == len(reference.history["time"])
    np.testing.assert_allclose(own.history["punch.force"], reference.history["punch.force"], rtol=1e-6)
    assert list(own.history["iterations"]) == list(reference.history["iterations"])
    eqps = reference.field("eqps", step=-1)
    assert eqps.max() > 0.5
    np.testing.assert_allclose(own.field("eqps", step=-1), eqps, rtol=1e-6)
    np.testing.assert_allclose(own.field(plastic_strain, step=-1), eqps, rtol=1e-6)
    assert abs(own.summary["energy"]["error_percent"]) < 1.0


def test_umat_of_swift_upsets_as_the_built_in_law(tmp_path, umat_laws):
    """Whole run, folding included: forces and iterations are the same, so stress and tangent are."""
    lines = f"""umat = "{umat_laws}"
props = [1, 200e3, 0.3, 700, 0.01, 0.2]
state_variables = 1
plastic_strain = 1"""
    assert_same_run(upset(tmp_path, "user", lines), upset(tmp_path, "own", BUILT_IN), "SDV1")


def test_fortran_umat_upsets_as_the_built_in_law(tmp_path, umat_fortran):
    lines = f"""umat = "{umat_fortran}"
props = [200e3, 0.3, 700, 300]
state_variables = 1
plastic_strain = 1"""
    assert_same_run(upset(tmp_path, "user", lines), upset(tmp_path, "own", LINEAR), "SDV1")


@pytest.mark.validation
def test_a_resumed_run_with_state_variables_gives_the_same_bits(tmp_path, umat_laws):
    lines = f"""umat = "{umat_laws}"
props = [3, 200e3, 0.3, 700, 300]
state_variables = 6"""
    whole = upset(tmp_path, "whole", lines, cells=3)

    settings = ["workpiece.mesh.cells=[3,3]", "solver.force_tolerance=1e-10", "solver.displacement_tolerance=1e-8"]
    model = build_model(read_case(tmp_path / "whole.toml", settings))
    parts = run_in_two_parts(model, tmp_path / "parts", lambda progress: progress.fraction > 0.3)
    np.testing.assert_array_equal(parts.history["punch.force"], whole.history["punch.force"])
    np.testing.assert_array_equal(parts.field("SDV5", step=-1), whole.field("SDV5", step=-1))


def test_several_threads_give_the_same_bits(umat_laws):
    mesh = block_mesh("quad4_fbar", (9, 9), origin=(0.0, 0.0), size=(1.0, 1.0))
    stress = []
    for thread_safe in (False, True):
        material = umat(umat_laws, (1.0, YOUNG, POISSON, *SWIFT), 1, thread_safe=thread_safe)
        model = drive_boundary(
            mesh, [np.array([[1.2, 0.3], [0.0, 0.9]])], material, analysis="plane_strain", solver=fixed_increments(2)
        )
        stress.append(run(model, threads=2 if thread_safe else 1)[0].state.cells.stress[0])
    np.testing.assert_array_equal(*stress)


# --- the whole deformation gradient ---------------------------------------------------------------------------------

MU, KAPPA = 80.0, 400.0


def neo_hookean(F: np.ndarray) -> np.ndarray:
    """Cauchy stress xx, yy, zz, xy of mu/2 (J^(-2/3) tr b - 3) and kappa (J - 1), in plane strain."""
    whole = np.eye(3)
    whole[:2, :2] = F
    J, b = np.linalg.det(whole), whole @ whole.T
    s = MU / J ** (5 / 3) * (b - np.trace(b) / 3 * np.eye(3)) + KAPPA * (J - 1) * np.eye(3)
    return np.array([s[0, 0], s[1, 1], s[2, 2], s[0, 1]])


@pytest.mark.parametrize("increments", [1, 7])
def test_neo_hookean_umat_meets_its_closed_form_whatever_the_path(umat_laws, increments):
    """Stretch, shear of two, and a turn by 50 degrees: the stress is that of the final F, however it was reached."""
    gradients = [np.array([[1.0, 0.4], [0.0, 1.2]]), np.array([[1.3, 2.0], [0.0, 0.9]])]
    gradients.append(shape(np.radians(50)) @ gradients[-1])
    mesh = block_mesh("quad4", (2, 2), origin=(0.0, 0.0), size=(1.0, 1.0))
    material = umat(umat_laws, (2.0, MU, KAPPA), 0, jacobian="jaumann_kirchhoff")
    solver = fixed_increments(increments)
    procedure, _ = run(drive_boundary(mesh, gradients, material, analysis="plane_strain", solver=solver))
    exact = neo_hookean(gradients[-1])
    np.testing.assert_allclose(
        procedure.state.cells.stress[0], np.broadcast_to(exact, (4, 4, 4)), rtol=0, atol=1e-8 * MU
    )


# --- tangents ---------------------------------------------------------------------------------------------------------


def error_of_stiffness(library, properties, n_state, jacobian, element, *, axisymmetric, measure="log"):
    """Relative difference between the stiffness of one prestressed element and central differences of its force."""
    rng = np.random.default_rng(5)
    law = _core.Umat(str(library), properties, n_state, jacobian=_core.UmatJacobian[jacobian])
    nodes, q = _core.element_sizes(element)
    corners = np.array([[2.0, 0], [3, 0], [3, 1], [2, 1]])
    points = [*corners, *(0.5 * (corners + np.roll(corners, -1, axis=0))), corners.mean(axis=0)][:nodes]
    points = np.array(points) + 0.05 * rng.standard_normal((nodes, 2))
    user = history_at_rest(law, (1, q), 4)
    gradient = np.array([1.0, 0, 0, 1, 1]) + 0.1 * rng.standard_normal((q, 5))
    user[..., n_state + np.array([0, 3, 1, 4, 8])] = gradient
    user[..., :n_state] = 20 * rng.random((1, q, n_state)) if n_state == 6 else 0.02
    if n_state == 6:
        user[..., 2] = -user[..., 0] - user[..., 1]
        user[..., 4] = 0.02
    stress = 100 * rng.standard_normal((1, q, 4))

    def evaluate(increment, stiffness):
        force, fault = np.zeros((1, 2 * nodes, _core.pack_width)), _core.LawFault()
        failed = _core.evaluate_block(
            element, np.arange(nodes, dtype=np.int32)[None], points, increment, law,
            _core.PointSettings(measure=_core.StrainMeasure[measure]), axisymmetric=axisymmetric, depth=1.3,
            hourglass_fraction=0.05, stress_n=stress, eqps_n=np.zeros((1, q)), hourglass_n=np.zeros((1, 2)),
            stress=np.zeros((1, q, 4)), eqps=np.zeros((1, q)), hourglass=np.zeros((1, 2)), volume=np.zeros((1, q)),
            force=force, stiffness=stiffness, history_n=user, history=np.zeros_like(user), when=_core.UmatPlace(),
            fault=fault,
        )  # fmt: skip
        assert failed == -1
        assert fault.status == _core.LawStatus.done
        return force[0, :, 0]

    increment = 0.05 * rng.standard_normal((nodes, 2))
    exact = np.zeros((1, 2 * nodes, 2 * nodes, _core.pack_width))
    evaluate(increment, exact)
    numerical = np.zeros((2 * nodes, 2 * nodes))
    for j in range(2 * nodes):
        move = np.zeros(2 * nodes)
        move[j] = 1e-6
        move = move.reshape(-1, 2)
        numerical[:, j] = (evaluate(increment + move, None) - evaluate(increment - move, None)) / 2e-6
    return np.abs(exact[0, :, :, 0] - numerical).max() / np.abs(numerical).max()


ELEMENTS = ["quad4", "quad4_fbar", "quad8_2x2"]
LAWS = {
    "swift": ([1, YOUNG, POISSON, *SWIFT], 1, "stress_increment"),
    "prager": ([3, YOUNG, POISSON, 200.0, 5e3], 6, "stress_increment"),
    "neo_hooke": ([2, 8e4, 2e5], 0, "jaumann_kirchhoff"),
}


@pytest.mark.parametrize("axisymmetric", [True, False], ids=["axisymmetric", "plane_strain"])
@pytest.mark.parametrize("element", ELEMENTS)
@pytest.mark.parametrize("law", LAWS)
def test_stiffness_from_ddsdde_is_the_derivative_of_the_force(umat_laws, law, element, axisymmetric):
    properties, n_state, jacobian = LAWS[law]
    error = error_of_stiffness(umat_laws, properties, n_state, jacobian, element, axisymmetric=axisymmetric)
    assert error < 1e-6


def test_the_jacobian_key_changes_the_stiffness(umat_laws):
    other = error_of_stiffness(umat_laws, [2, 8e4, 2e5], 0, "stress_increment", "quad4", axisymmetric=True)
    assert other > 1e-3


# --- rotation ---------------------------------------------------------------------------------------------------------


def test_stress_and_tensor_state_variables_turn_with_the_material(umat_laws):
    """Prager's law along a path, and along the same path with a rotation of its own on top of every increment."""
    path = [np.diag([1.03, 0.98]), np.diag([1.05, 0.96]), np.array([[1.09, 0.05], [0.03, 0.93]])]
    angles = np.radians([20.0, 65.0, 90.0])
    turned = [shape(angle) @ F for angle, F in zip(angles, path, strict=True)]
    mesh = block_mesh("quad4", (1, 1), origin=(0.0, 0.0), size=(1.0, 1.0))
    material = umat(umat_laws, (3.0, YOUNG, POISSON, 200.0, 5e3), 6)
    states = [
        run(drive_boundary(mesh, gradients, material, analysis="plane_strain", solver=fixed_increments(1)))[0].state
        for gradients in (path, turned)
    ]
    for own, other in ([s.cells.stress[0][0, 0] for s in states], [s.cells.history[0][0, 0, :4] for s in states]):
        assert np.abs(own).max() > 50.0
        xx, yy, zz, xy = own
        np.testing.assert_allclose(other, [yy, xx, zz, -xy], rtol=0, atol=1e-9 * np.abs(own).max())
    np.testing.assert_allclose(states[1].cells.history[0][..., 4], states[0].cells.history[0][..., 4], rtol=1e-10)


# --- what a routine may ask for, and what it is told ------------------------------------------------------------------


def pull(material, log_strain, solver, duration=1.0):
    """Stretch a bar of one cell, radius 10 and height 15, in one stage."""
    mesh = block_mesh("quad4", (1, 1), origin=(0.0, 0.0), size=(10.0, 15.0))
    supports = (Support("left", (True, False)), Support("bottom", (False, True)))
    motion = PrescribedDisplacement("top", 1, 15.0 * np.expm1(log_strain))
    stages = [Stage("pull", duration=duration, prescribed=(motion,))]
    return make_model(mesh, material, analysis="axisymmetric", supports=supports, solver=solver, stages=stages)


def test_a_smaller_increment_that_the_routine_asks_for_is_taken(umat_laws):
    """PNEWDT 0.3 above a strain increment of 0.004: 0.01 is cut to 0.003, and no increment is above the limit."""
    material = umat(umat_laws, (4.0, YOUNG, POISSON, 0.3, 0.004), 0)
    procedure, reports = run(pull(material, 0.01, fixed_increments(1)))
    assert "asks for a smaller increment (PNEWDT)" in reports[0].cutbacks[0]
    assert reports[0].fraction == pytest.approx(0.3, rel=1e-9)
    sizes = np.diff([0.0, *(r.fraction for r in reports)])
    assert sizes.max() * np.expm1(0.01) < 0.0041
    assert procedure.state.cells.stress[0][0, 0, 1] == pytest.approx(0.01 * YOUNG, rel=1e-3)


def test_a_routine_that_stops_leaves_the_run_with_its_reason(umat_laws):
    material = umat(umat_laws, (6.0, YOUNG, POISSON, -1.0, 1.0), 0)
    with pytest.raises(GaveUpError, match="stops the analysis \\(XIT\\)"):
        run(pull(material, 0.01, fixed_increments(2)))


def test_numbers_that_are_none_cut_the_increment_until_it_gives_up(umat_laws):
    material = umat(umat_laws, (6.0, YOUNG, POISSON, 1.0, 0.005), 0)
    with pytest.raises(GaveUpError, match="not a number"):
        run(pull(material, -0.02, fixed_increments(4)))


def test_the_routine_is_told_where_and_when_it_is(umat_laws):
    material = umat(umat_laws, (5.0, YOUNG, POISSON), 12)
    procedure, _ = run(pull(material, 1e-3, fixed_increments(4), duration=2.0))
    told = procedure.state.cells.history[0][0, 1, :12]
    stress = procedure.state.cells.stress[0][0, 1, 1]
    mesh = procedure.model.mesh
    place = 10.0 * (0.5 + 0.5 / np.sqrt(3)), 15.0 * (0.5 - 0.5 / np.sqrt(3))
    assert mesh.blocks[0].element == "quad4"
    np.testing.assert_allclose(told[:7], [1.5, 1.5, 0.5, 1, 2, 1, 4])
    np.testing.assert_allclose(told[7:9], place, rtol=2e-3)
    assert told[9] == pytest.approx(np.sqrt(150.0), rel=2e-3)
    assert told[10] == pytest.approx(stress, rel=1e-9)
    assert told[11] == 4012


# --- a law of one C++ file, from the documentation --------------------------------------------------------------------


def test_the_documented_law_relaxes_as_its_closed_form(umat_norton):
    """Norton's creep, rate = A q^n, in a bar pulled at once and held: s^(1-n) = s0^(1-n) + (n-1) E A t."""
    A, n, seconds = 1e-14, 4.0, 50.0
    material = umat(umat_norton, (YOUNG, POISSON, A, n), 1, plastic_strain=1)

    def relax(steps):
        mesh = block_mesh("quad4", (1, 1), origin=(0.0, 0.0), size=(10.0, 15.0))
        supports = (Support("left", (True, False)), Support("bottom", (False, True)))
        pull = PrescribedDisplacement("top", 1, 15.0 * np.expm1(1e-3))
        stages = [
            Stage("pull", duration=1e-9, prescribed=(pull,)),
            Stage("hold", duration=seconds, prescribed=(PrescribedDisplacement("top", 1, 0.0),)),
        ]
        solver = fixed_increments(steps, increment_tolerance=0.9)
        model = make_model(mesh, material, analysis="axisymmetric", supports=supports, stages=stages, solver=solver)
        return run(model)[0].state

    states = [relax(steps) for steps in (40, 80)]
    coarse, fine = (state.cells.stress[0][0, 0, 1] for state in states)
    start = YOUNG * 1e-3
    exact = (start ** (1 - n) + (n - 1) * YOUNG * A * seconds) ** (1 / (1 - n))
    assert exact < 0.75 * start
    assert (coarse - exact) / (fine - exact) == pytest.approx(2.0, abs=0.1)  # backward Euler
    assert 2 * fine - coarse == pytest.approx(exact, rel=1e-4)
    np.testing.assert_allclose(states[1].cells.eqps[0], 1e-3 - fine / YOUNG, rtol=1e-6)


def test_the_documented_case_runs(tmp_path, umat_norton):
    """The page's own [materials] table, in an upsetting."""
    page = (Path(__file__).parents[2] / "docs" / "adding_a_law.md").read_text(encoding="utf-8")
    table = re.search(r"```toml\n\[materials.steel\]\n(.*?)```", page, re.DOTALL).group(1)
    result = upset(tmp_path, "user", table.replace('"norton.so"', f'"{umat_norton}"'), cells=3)
    assert result.field("SDV1", step=-1).max() > 0.3
