# SPDX-License-Identifier: Apache-2.0
"""Tetrahedra against closed forms, published values, and the axisymmetric solids of the program."""

from dataclasses import replace

import numpy as np
import pytest
import scipy

from presswork import build_model, read_case, run_model
from presswork.body.solids import Mechanics
from presswork.mesh.make.box import finish_mesh
from presswork.model import Material, Stage, Umat
from presswork.timing import Timing
from tests.consistency.test_solid_in_space import OneCell
from tests.problems.space_solids import compute, cook_in_space, elastic, make_model, mean_rise
from tests.problems.tetrahedra import (
    BORE,
    OUTSIDE,
    YIELD,
    inf_sup,
    mean_pressure_of_punch,
    prandtl_slice,
    thick_ball,
)


def test_a_cell_has_the_six_rigid_motions_and_no_other_mode_without_energy() -> None:
    one = OneCell("tet4_mini")
    one.stress[:], one.eqps[:], one.points[:, 3] = 0.0, 0.0, 0.0
    _, stiffness = one.evaluate(one.nothing(), with_stiffness=True)
    number = np.arange(16).reshape(4, 4)
    u, p = number[:, :3].ravel(), number[:, 3]
    with_pressure = stiffness[np.ix_(u, p)] @ np.linalg.solve(stiffness[np.ix_(p, p)], stiffness[np.ix_(p, u)])
    values = np.linalg.eigvalsh(stiffness[np.ix_(u, u)] - with_pressure)
    assert (values[:6] < 1e-10 * values[-1]).all()
    assert (values[6:] > 1e-3 * values[-1]).all()
    assert (np.linalg.eigvalsh(stiffness[np.ix_(p, p)]) < 0.0).all()


def test_the_inf_sup_value_does_not_fall_with_the_size_of_cells() -> None:
    """Chapelle & Bathe 1993: 0.141, 0.154, 0.156, 0.159 at 2, 3, 4, 6 cells a side; without the bubble it is zero."""
    values = [inf_sup("tet4_mini", n) for n in (2, 4, 6)]
    assert values == pytest.approx([0.1405, 0.1558, 0.1589], rel=1e-2)
    assert inf_sup("tet4_mini", 4, with_bubble=False) < 1e-3


def test_the_modes_of_tet10_without_energy_are_six_once_four_cells_surround_a_point() -> None:
    """One cell alone has the three special conformal motions 2 (b.x) x - |x|^2 b, too, whose dilatation has no mean."""
    counts = []
    for divided in (False, True):
        points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [0.2, 0.3, 0.25]])
        cells = (
            np.array([[4, 1, 2, 3], [0, 4, 2, 3], [0, 1, 4, 3], [0, 1, 2, 4]]) if divided else np.array([[0, 1, 2, 3]])
        )
        mesh = finish_mesh(points if divided else points[:4], cells.astype(np.int32), {}, "tet10", 0)
        model = make_model(mesh, [], Stage("none"), material=elastic(200e3, 0.3), displacements="small")
        mechanics = Mechanics(model, Timing("assembly"))
        state, n = mechanics.at_rest(), len(mesh.points)
        mechanics.evaluate(state, state.duplicate(), np.zeros((n, 3)), with_stiffness=True)
        data = np.zeros(len(mechanics.assembler.indices))
        mechanics.assemble_stiffness(np.zeros(n, dtype=np.uint8), np.zeros((n, 3, 3)), data)
        whole = scipy.sparse.csr_matrix((data, mechanics.assembler.indices, mechanics.assembler.indptr)).toarray()
        values = np.linalg.eigvalsh(np.triu(whole) + np.triu(whole, 1).T)
        counts.append(int((np.abs(values) < 1e-9 * values[-1]).sum()))
    assert counts == [9, 6]


def test_cooks_membrane_in_space_does_not_lock() -> None:
    """8.59 by quadratic tetrahedra and 8.57 by hexahedra, of this law; hexahedra cut into six.

    With 16 and 24 cells a side 7.938 and 8.248. Of the membrane to a fifth the error is that of linear tetrahedra in
    bending: with nu = 0.3, 8 cells a side are 17 % off.
    """
    rises = [mean_rise(compute(cook_in_space("tet4_mini", n, n // 4))) for n in (8, 12)]
    assert rises == pytest.approx([6.770, 7.570], rel=1e-3)
    errors = 1.0 - np.array(rises) / 8.60
    assert np.log(errors[0] / errors[1]) / np.log(1.5) > 1.3  # their order


@pytest.mark.validation
def test_cooks_membrane_of_a_neo_hookean_body_rises_as_published(umat_laws) -> None:
    """8.477 to 8.500 by converged quadratic tetrahedra of that law; 8 x 8 x 2, 12 x 12 x 3 give 8.472."""
    young, poisson = 240.565, 0.4999
    constants = (2.0, young / 2.0 / (1.0 + poisson), young / 3.0 / (1.0 - 2.0 * poisson))
    law = Umat(str(umat_laws), constants, 0, jacobian="jaumann_kirchhoff", thread_safe=True)
    membrane = replace(
        cook_in_space("tet10", 8, 2), materials=(Material("neo-Hookean", young, poisson, None, umat=law),)
    )
    assert mean_rise(compute(membrane)) == pytest.approx(8.489, rel=4e-3)


@pytest.mark.parametrize(("element", "n", "share"), [("tet4_mini", 8, 0.908), ("tet10", 6, 1.112)])
def test_thick_ball_yields_as_hill_says(element, n, share) -> None:
    """Outer displacement sigma_0 c^3 (1 - nu)/(E b^2) with the plastic front at c = 1.5 a; tet10 at n = 8: 1.052.

    A hundredth of the pressure is three of the displacement there.
    """
    procedure = compute(thick_ball(element, n, n // 2, front=1.5 * BORE))
    nodes = procedure.model.mesh.node_sets["outside"]
    along = procedure.model.mesh.points[nodes] / OUTSIDE
    moved = (procedure.state.nodes.moved[nodes] * along).sum(axis=1).mean()
    closed = YIELD * (1.5 * BORE) ** 3 * (1.0 - 0.4999) / (200e3 * OUTSIDE**2)
    assert moved / closed == pytest.approx(share, abs=5e-3)


@pytest.mark.parametrize(("element", "pressure"), [("tet4_mini", 5.401), ("tet10", 5.053), ("hex8_fbar", 5.123)])
def test_a_slice_under_a_punch_has_prandtls_limit_load(element, pressure) -> None:
    """(2 + pi) k = 5.142 k; 4 cells under half the punch, 8 give 5.159 and 5.080, and hex8 6.489 and 5.916."""
    found = mean_pressure_of_punch(compute(prandtl_slice(element, 4)), 4)
    assert found == pytest.approx(pressure, rel=1e-3)
    assert found == pytest.approx(2.0 + np.pi, rel=0.06)


UPSETTING = """
title = "Upsetting of a cylinder"
analysis = "{analysis}"
[workpiece]
material = "steel"
element = "{element}"
mesh = {mesh}
[materials.steel]
young = "200 GPa"
poisson = 0.3
hardening = {{ law = "swift", K = 565, e0 = 0.007, n = 0.26 }}
[tools.die]
{die}
contact = "shear"
m = 0.3
{boundary}
[[stages]]
name = "press"
tools.die = {{ stroke = 1.875, direction = {direction} }}
[solver]
max_increment = 0.04
[output]
steps = 1
"""
IN_SPACE = {
    "analysis": "solid",
    "element": "tet4_mini",
    "mesh": '{ kind = "cylinder", radius = 10, height = 7.5, angle = 90, cells = [5, 8, 5] }',
    "die": 'shape = "plane"\nnormal = [0, 0, -1]\nposition = [0, 0, 7.5]',
    "boundary": '[boundary]\nx = { set = "last_plane", fix = ["x"] }\ny = { set = "first_plane", fix = ["y"] }\n'
    'z = { set = "back", fix = ["z"] }',
    "direction": "[0, 0, -1]",
}
ROUND = {
    "analysis": "axisymmetric",
    "element": "quad4_fbar",
    "mesh": "{ size = [10, 7.5], cells = [20, 15] }",
    "die": "profile = [[30, 7.5], [-1, 7.5]]",
    "boundary": '[boundary]\naxis = { set = "left", fix = ["x"] }\nmiddle = { set = "bottom", fix = ["y"] }',
    "direction": "[0, -1]",
}


@pytest.mark.parametrize("element", ["tet4_mini", "tet10"])
def test_upsetting_of_a_quarter_cylinder_is_that_of_the_axisymmetric_billet(tmp_path, element) -> None:
    """Force within 1 % and rim within 0.5 % at a quarter of the height; a history without loss of volume."""
    found = []
    for name, words in (("space", IN_SPACE | {"element": element}), ("round", ROUND)):
        path = tmp_path / f"{name}.toml"
        path.write_text(UPSETTING.format(**words))
        result = run_model(build_model(read_case(path)), tmp_path / name, threads=1).result
        radius = np.linalg.norm(result.points(-1)[:, : 2 if name == "space" else 1], axis=1).max()
        found.append((result.history["die.force"][-1], radius, result.summary["volume"]))
    (force, rim, volume), (closed, edge, _) = found
    assert force == pytest.approx(closed, rel=1e-2)
    assert rim == pytest.approx(edge, rel=5e-3)
    assert volume["change_percent"] == pytest.approx(volume["elastic_part_percent"], abs=2e-3)
