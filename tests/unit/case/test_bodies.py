# SPDX-License-Identifier: Apache-2.0
"""Bodies and contacts of a case: what is built, what is described, and what is refused."""

from __future__ import annotations

import numpy as np
import pytest

from presswork.case import Case, CaseError, build_model, describe
from presswork.case.plane.bodies import measure_distance_to_body
from presswork.implicit.stepping import ImplicitProcedure, NotHeldError
from presswork.mesh import mesh_rectangle

RING = """
[bodies.ring]
material = "steel"
element = "quad4"
[bodies.ring.mesh]
origin = [10, 0]
size = [5, 15]
cells = [1, 6]

[contacts.bore]
between = ["workpiece", "ring"]
contact = "coulomb"
mu = 0.1

[boundary.ring_plane]
set = "ring.bottom"
fix = ["y"]

[[stages]]"""
WITH_RING = ("\n[[stages]]", RING)


def build(write_case, *changes):
    return build_model(Case.from_toml(write_case(WITH_RING, *changes)))


def test_bodies_make_one_mesh(write_case) -> None:
    model = build(write_case)
    assert [(body.name, body.points, body.blocks) for body in model.bodies] == [
        ("workpiece", range(18), range(1)),
        ("ring", range(18, 32), range(1, 2)),
    ]
    assert [block.element for block in model.mesh.blocks] == ["tri3", "quad4"]
    assert model.mesh.node_sets["ring.left"].min() >= 18
    assert model.bodies[1].owns(model.mesh.boundary_edges).sum() == 14
    np.testing.assert_array_equal(model.mesh.edge_sets["ring.boundary"] >= 18, True)


def test_finer_body_is_the_slave_unless_said_otherwise(write_case) -> None:
    assert build(write_case).contacts[0].slave == 1
    assert build(write_case, ("mu = 0.1", 'mu = 0.1\nslave = "workpiece"')).contacts[0].slave == 0


def test_softer_of_two_equally_fine_bodies_is_the_slave(write_case) -> None:
    square = [("size = [10, 15]\ncells = [2, 3]", "size = [10, 15]\ncells = [2, 3]"),
              ("size = [5, 15]\ncells = [1, 6]", "size = [10, 15]\ncells = [2, 3]")]  # fmt: skip
    soft = (
        '[materials.soft]\nyoung = 1e4\npoisson = 0.3\nhardening = {law = "linear", yield_stress = 9}\n\n[tools.punch]'
    )
    assert build(write_case, *square).contacts[0].slave == 0
    changed = build(write_case, *square, ('[bodies.ring]\nmaterial = "steel"', '[bodies.ring]\nmaterial = "soft"'),
                    ("[tools.punch]", soft))  # fmt: skip
    assert changed.contacts[0].slave == 1


def test_contact_of_bodies_keeps_the_whole_tangent(write_case) -> None:
    assert not build(write_case).solver.symmetric
    assert not build(write_case, ('"coulomb"\nmu = 0.1', '"frictionless"')).solver.symmetric


def test_tool_on_a_symmetry_plane_of_any_body_counts_twice(write_case) -> None:
    """The ring's own bottom is a whole side of it, though the workpiece's lies on the same line."""
    side = (
        "[boundary.axis]",
        '[tools.wall]\nprofile = [[15, 0], [15, 15]]\ncontact = "frictionless"\n\n[boundary.axis]',
    )
    model = build(write_case, ('"axisymmetric"', '"plane_strain"'), side)
    assert model.tools[1].mirrored_across == (False, True)


def test_bodies_and_contacts_are_described(write_case) -> None:
    text = describe(build(write_case))
    assert "workpiece: x 0 to 10 mm, y 0 to 15 mm" in text
    assert "ring: x 10 to 15 mm, y 0 to 15 mm" in text
    assert "contact bore: workpiece with ring, coulomb, mu = 0.1; pressure on the nodes of ring" in text
    itself = build(write_case, ('["workpiece", "ring"]', '["ring", "ring"]'))
    assert "contact bore: ring with itself, coulomb, mu = 0.1" in describe(itself)


FAULTS = {
    "unknown_body": (
        ('["workpiece", "ring"]', '["workpiece", "rin"]'), ["contacts.bore.between", "did you mean `ring`?"]),
    "unknown_slave": (("mu = 0.1", 'mu = 0.1\nslave = "punch"'), ["contacts.bore.slave", "workpiece and ring"]),
    "missing_friction": (('"coulomb"\nmu = 0.1', '"shear"'), ["contacts.bore.m: missing key", "needs m"]),
    "useless_friction": (('"coulomb"\nmu', '"sticking"\nmu'), ["contacts.bore.mu", "has no meaning"]),
    "body_without_contact": (
        ('["workpiece", "ring"]', '["workpiece", "workpiece"]'), ["bodies.ring", "no contact names this body"]),
    "linear_with_quadratic": (('element = "quad4"', 'element = "quad8"'), ['bodies.ring.element = "quad8"', "tri3"]),
    "unknown_material": (
        ('[bodies.ring]\nmaterial = "steel"', '[bodies.ring]\nmaterial = "steal"'),
        ['bodies.ring.material = "steal"', "did you mean `steel`?"]),
    "set_of_unknown_body": (
        ('set = "ring.bottom"', 'set = "rng.bottom"'), ["boundary.ring_plane.set", "`ring.bottom`"]),
    "overlap": (("origin = [10, 0]", "origin = [9, 0]"), ["contacts.bore.between", "overlap at the start, by 1 mm"]),
    "far_apart": (("origin = [10, 0]", "origin = [100, 0]"), ["contacts.bore.between", "90 mm apart"]),
    "same_pair_twice": (
        ("[contacts.bore]",
         '[contacts.again]\nbetween = ["ring", "workpiece"]\ncontact = "sticking"\n\n[contacts.bore]'),
        ["contacts.bore.between", "the contact again is between the same bodies"]),
    "name_of_a_tool": (("[contacts.bore]", "[contacts.punch]"), ["contacts.punch", "a tool has this name"]),
}  # fmt: skip


@pytest.mark.parametrize("name", FAULTS)
def test_fault_of_bodies_is_named_with_a_remedy(name, write_case) -> None:
    change, wanted = FAULTS[name]
    with pytest.raises(CaseError) as caught:
        build(write_case, change)
    for text in wanted:
        assert text in str(caught.value)


def test_body_with_the_workpieces_name_is_refused(write_case) -> None:
    with pytest.raises(CaseError, match=r"bodies\.workpiece: this name is taken already"):
        build(write_case, ("[bodies.ring", "[bodies.workpiece"))


def test_as_run_case_finds_the_mesh_files_of_bodies(write_case, tmp_path) -> None:
    """A mesh file is named by its full path in the case that is kept with the results."""
    ring = 'path = "ring.msh"'
    path = write_case(WITH_RING, ("origin = [10, 0]\nsize = [5, 15]\ncells = [1, 6]", ring))
    assert f'path = "{tmp_path / "ring.msh"}"' in Case.from_toml(path).text


def test_body_that_only_touches_another_is_held(write_case) -> None:
    """The ring in y by the bore's friction; frictionless it is not, nor does a ring that is off the workpiece hold."""
    loose = ('[boundary.ring_plane]\nset = "ring.bottom"\nfix = ["y"]\n', "")
    short = ("size = [5, 15]\ncells = [1, 6]", "size = [5, 12]\ncells = [1, 6]")
    off_the_punch = ("origin = [10, 0]", "origin = [10, 1]")
    ImplicitProcedure(build(write_case, loose, short, off_the_punch), threads=1)
    slippery = ('"coulomb"\nmu = 0.1', '"frictionless"')
    with pytest.raises(NotHeldError, match="nothing holds the body 'ring' in y"):
        ImplicitProcedure(build(write_case, loose, short, off_the_punch, slippery), threads=1)
    with pytest.raises(NotHeldError, match="nothing holds the body 'ring' in y"):
        ImplicitProcedure(build(write_case, loose, short, ("origin = [10, 0]", "origin = [10.5, 1]")), threads=1)


def test_distance_to_a_body_is_negative_inside() -> None:
    mesh = mesh_rectangle(np.linspace(0, 4, 3), np.linspace(0, 2, 3), element="quad4")
    points = np.concatenate([mesh.points, [[2.0, 0.5], [5.0, 1.0], [2.0, 2.0], [-3.0, -4.0]]])
    nodes = np.arange(len(mesh.points), len(points))
    found = measure_distance_to_body(points, nodes, mesh.boundary_edges)
    np.testing.assert_allclose(found, [-0.5, 1.0, 0.0, 5.0], atol=1e-12)
