# SPDX-License-Identifier: Apache-2.0
"""Contact of deformable bodies in space against closed forms."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from presswork.implicit.stepping import ImplicitProcedure
from presswork.interaction.bodies.body_surfaces import InterfaceArrays
from presswork.mesh.joined import join_meshes
from presswork.model import (
    BodyContact,
    Hardening,
    Material,
    Model,
    OutputSettings,
    PrescribedDisplacement,
    SolverSettings,
    Stage,
    Support,
)
from tests.problems.hertz_in_space import press
from tests.problems.space_solids import box

YOUNG = 200e3
UNEVEN = {"hex8_fbar": 1e-5, "tet4_mini": 1e-11}
"""Of the stress: faces of hexahedra that are no parallelograms are integrated nearly exactly, triangles exactly."""
ELASTIC = Material("steel", YOUNG, 0.3, Hardening("linear", np.array([1e12, 0.0])))


def two_blocks(element, law="frictionless", **friction) -> Model:
    """Two blocks of unlike cells on each other, the upper one pressed down by 0.4 % of the height of both."""
    upper = box(element, (8.0, 6.0, 5.0), (5, 3, 4), distort=0.2)
    lower = box(element, (8.0, 6.0, 5.0), (3, 4, 3), distort=0.2)
    upper.points[:, 2] += 5.0
    mesh, bodies = join_meshes({"workpiece": lower, "upper": upper})
    sides = {"x": ("left", "upper.left"), "y": ("bottom", "upper.bottom"), "z": ("back",)}
    return Model(
        title="two blocks",
        analysis="solid",
        depth=1.0,
        mesh=mesh,
        materials=(ELASTIC,),
        tools=(),
        supports=tuple(Support(s, tuple(a == axis for a in "xyz")) for axis, sets in sides.items() for s in sets),
        stages=(Stage("press", prescribed=(PrescribedDisplacement("upper.front", 2, -0.04),)),),
        solver=SolverSettings(
            initial_increment=0.5,
            max_increment=0.5,
            symmetric=False,
            force_tolerance=1e-8,
            displacement_tolerance=1e-9,
        ),
        output=OutputSettings(steps=1),
        bodies=bodies,
        contacts=(BodyContact("joint", (0, 1), 1, law, **friction),),
    )


@pytest.mark.parametrize("element", ["hex8_fbar", "tet4_mini"])
@pytest.mark.parametrize(
    ("law", "friction"), [("frictionless", {}), ("sticking", {}), ("coulomb", {"mu": 0.2}), ("shear", {"m": 0.3})]
)
def test_blocks_of_unlike_meshes_pass_the_contact_patch_test(element, law, friction):
    # both blocks shorten by ln(0.996) but for what the contact leaves of penetration: the stress is the same everywhere
    run = ImplicitProcedure(two_blocks(element, law, **friction))
    for _ in run.advance():
        pass
    stress = np.concatenate([s.reshape(-1, 6) for s in run.state.cells.stress])
    mean = float(stress[:, 2].mean())
    assert mean == pytest.approx(YOUNG * np.log(0.996), rel=2e-3)
    assert np.abs(stress - mean * np.eye(6)[2]).max() < UNEVEN[element] * abs(mean)
    pressure = run.state[InterfaceArrays].pressure
    assert (pressure != 0.0).sum() == 24
    assert np.abs(pressure[pressure != 0.0] + mean).max() < 10 * UNEVEN[element] * abs(mean)


@pytest.mark.parametrize("element", ["hex8_fbar", "tet4_mini"])
@pytest.mark.parametrize("strain", [1e-5, 1e-3])
def test_blocks_that_touch_part_where_they_narrow(element, strain):
    """Drawn out sideways between rests they leave each other by some millionths of an edge, or more."""
    model = two_blocks(element)
    drawn = tuple(PrescribedDisplacement(f"{body}right", 0, 8.0 * np.expm1(strain)) for body in ("", "upper."))
    model = replace(
        model,
        supports=(*model.supports, Support("upper.front", (False, False, True))),
        stages=(replace(model.stages[0], prescribed=drawn),),
    )
    run = ImplicitProcedure(model)
    assert all(len(report.log) <= 5 for report in run.advance())
    stress = np.concatenate([s.reshape(-1, 6) for s in run.state.cells.stress])
    np.testing.assert_allclose(stress / (YOUNG * strain), np.tile(np.eye(6)[0], (len(stress), 1)), atol=1e-7)


@pytest.mark.validation
def test_an_elastic_sphere_and_block_touch_as_hertz_says():
    """Four cells across the half-width; with six the peak is 0.3 % above Hertz."""
    contact = press("hex8_fbar")
    assert 4.0 * (contact.pressure * contact.area).sum() == pytest.approx(contact.load, rel=0.005)
    assert contact.pressure.max() == pytest.approx(contact.exact_peak, rel=0.03)
    assert contact.half_width == pytest.approx(contact.exact_half_width, rel=0.05)
