# SPDX-License-Identifier: Apache-2.0
"""Contact of deformable bodies against closed forms: patch tests between meshes that do not match, and more."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from presswork.implicit.stepping import ImplicitProcedure
from presswork.interaction.bodies.body_surfaces import InterfaceArrays
from presswork.mesh import grade_line, mesh_rectangle
from presswork.mesh.joined import join_meshes
from presswork.mesh.topology import drop_unused_points, find_boundary_edges
from presswork.model import (
    Body,
    BodyContact,
    FloatArray,
    Friction,
    Material,
    Mesh,
    Model,
    PrescribedDisplacement,
    Pressure,
    Profile,
    SolverSettings,
    Stage,
    Support,
    Tool,
)
from presswork.state import State
from tests.problems.plane_solids import (
    block_mesh,
    distort,
    elastic,
    fixed_increments,
    linear_hardening,
    make_model,
    run,
)

PRESSURE = 300.0


def two_blocks(element, analysis, slave, *, die_element=None, tilt=0.0, contact="frictionless") -> Model:
    """A block 8 x 5 on one of 8 x 6 mm, of distorted meshes that do not match; in axisymmetry from r = 5 mm on."""
    origin = 5.0 if analysis == "axisymmetric" else 0.0
    lower = distort(block_mesh(element, (4, 3), origin=(origin, 0.0), size=(8.0, 6.0)), 0.4)
    upper = distort(block_mesh(die_element or element, (5, 2), origin=(origin, 6.0), size=(8.0, 5.0)), 0.4)
    mesh, bodies = join_meshes({"workpiece": lower, "die": upper})
    x, y = mesh.points.T
    tilted = np.column_stack([x, y + tilt * x * np.where(y < 6.0, y / 6.0, (11.0 - y) / 5.0)])
    supports = [Support("bottom", (False, True))]
    if analysis == "plane_strain":
        supports += [Support("bottom_left", (True, False)), Support("die.top_left", (True, False))]
    model = make_model(
        replace(mesh, points=tilted),
        elastic(2e5, 0.3),
        analysis=analysis,
        supports=supports,
        pressures=[Pressure("die.top", PRESSURE)],
        solver=fixed_increments(2),
    )
    return replace(model, bodies=bodies, contacts=(BodyContact("joint", (0, 1), slave, contact),))


def stress_of(procedure):
    return np.concatenate([s.reshape(-1, 4) for s in procedure.state.cells.stress])


@pytest.mark.parametrize("slave", [0, 1], ids=["coarse_slave", "fine_slave"])
@pytest.mark.parametrize("analysis", ["plane_strain", "axisymmetric"])
@pytest.mark.parametrize(
    ("element", "die_element"),
    [("tri3", None), ("quad4", None), ("quad4_fbar", None), ("tri3", "quad4_fbar"), ("quad8_2x2", None),
     ("tri6_7pt", None), ("quad9", "tri6_6pt")],
)  # fmt: skip
def test_uniform_pressure_passes_between_meshes_that_do_not_match(element, die_element, analysis, slave) -> None:
    """Uniaxial stress in both bodies to 1e-10 of the pressure, with no net force."""
    procedure, _ = run(two_blocks(element, analysis, slave, die_element=die_element))
    stress = stress_of(procedure)
    in_plane = stress[:, [0, 1, 3]]
    np.testing.assert_allclose(in_plane, np.tile([0.0, -PRESSURE, 0.0], (len(in_plane), 1)), atol=1e-10 * PRESSURE)
    force = procedure.state[InterfaceArrays].force
    assert np.abs(force.sum(axis=0)).max() < 1e-12 * np.abs(force).sum()


def test_inclined_interface_carries_hydrostatic_pressure() -> None:
    """Pressure all round, frictionless: -p in the plane everywhere, to 1e-5 (ends slip by p over the stiffness)."""
    model = two_blocks("quad4", "plane_strain", 0, tilt=0.1)
    sides = ("left", "right", "die.left", "die.right", "die.top")
    stage = replace(model.stages[0], pressures=tuple(Pressure(side, PRESSURE) for side in sides))
    procedure, _ = run(replace(model, stages=(stage,)))
    in_plane = stress_of(procedure)[:, [0, 1, 3]]
    wanted = np.tile([-PRESSURE, -PRESSURE, 0.0], (len(in_plane), 1))
    np.testing.assert_allclose(in_plane, wanted, atol=1e-5 * PRESSURE)


@pytest.mark.parametrize("strain", [1e-5, 1e-3])
def test_bodies_that_touch_part_where_they_narrow(strain) -> None:
    """Drawn out sideways between rests they leave each other by some millionths of an edge, or more."""
    model = two_blocks("quad4_fbar", "plane_strain", 0)
    supports = [Support(f"{body}left", (True, False)) for body in ("", "die.")]
    supports += [Support(side, (False, True)) for side in ("bottom", "die.top")]
    drawn = tuple(PrescribedDisplacement(f"{body}right", 0, 8.0 * np.expm1(strain)) for body in ("", "die."))
    stage = replace(model.stages[0], pressures=(), prescribed=drawn)
    procedure, reports = run(replace(model, supports=tuple(supports), stages=(stage,)))
    stress = stress_of(procedure)[:, [0, 1, 3]] / (2e5 / (1.0 - 0.3**2) * strain)
    np.testing.assert_allclose(stress, np.tile([1.0, 0.0, 0.0], (len(stress), 1)), atol=1e-8)
    assert max(len(report.log) for report in reports) <= 5


# --- Hertz ---------------------------------------------------------------------------------------------------------
RADII, YOUNG, POISSON = (10.0, 20.0), (2e5, 1e5), 0.3


def curved_block(n_x: int, n_y: int, radius: float, *, above: bool) -> Mesh:
    """The right half of a block 20 x 10 mm whose face towards y = 0 is a parabola of this radius at its vertex."""
    x = grade_line(0.0, [(1.0, n_x, 1.0), (9.0, 16, 20.0)])
    y = grade_line(0.0, [(1.0, n_y, 1.0), (9.0, 16, 20.0)])
    if not above:
        y = -y[::-1]
    mesh = mesh_rectangle(x, y, element="quad4_fbar")
    side = 1.0 if above else -1.0
    bent = mesh.points[:, 1] + side * mesh.points[:, 0] ** 2 / (2 * radius) * (1 - np.abs(mesh.points[:, 1]) / 10.0)
    return replace(mesh, points=np.column_stack([mesh.points[:, 0], bent]))


def press_cylinders(slave: int, refined: int = 1) -> tuple[FloatArray, FloatArray, float, float]:
    """Press two curved blocks together; return x and pressure of the slave's nodes, and Hertz's a and p0 for the load.

    Plane strain: a = sqrt(4 P R / (pi E*)), p0 = 2 P / (pi a). Johnson (1985), Contact mechanics, section 4.2c.
    """
    n = 10 * refined
    lower = curved_block(16 * refined, n, RADII[0], above=False)
    mesh, bodies = join_meshes({"workpiece": lower, "die": curved_block(20 * refined, n, RADII[1], above=True)})
    mesh = replace(mesh, blocks=(mesh.blocks[0], replace(mesh.blocks[1], material=1)))
    supports = [
        Support("left", (True, False)),
        Support("die.left", (True, False)),
        Support("bottom", (True, True)),
        Support("die.top", (True, False)),
    ]
    model = make_model(
        mesh,
        elastic(YOUNG[0], POISSON),
        supports=supports,
        prescribed=[PrescribedDisplacement("die.top", 1, -0.05)],
        solver=SolverSettings(initial_increment=0.25, max_increment=0.25, force_tolerance=1e-6, symmetric=False),
    )
    materials = (elastic(YOUNG[0], POISSON), elastic(YOUNG[1], POISSON))
    contact = BodyContact("c", (0, 1), slave, "frictionless")
    procedure, _ = run(replace(model, materials=materials, bodies=bodies, contacts=(contact,)))
    load = 2 * abs(procedure.state.nodes.reaction[mesh.node_sets["die.top"], 1].sum())
    stiffness = 1 / ((1 - POISSON**2) * (1 / YOUNG[0] + 1 / YOUNG[1]))
    half_width = float(np.sqrt(4 * load / (1 / RADII[0] + 1 / RADII[1]) / (np.pi * stiffness)))
    pressure = procedure.interactions.bodies.traction(procedure.state).pressure
    x = mesh.points[:, 0] + procedure.state.nodes.displacement[:, 0]
    own = np.flatnonzero(pressure > 0)
    own = own[np.isin(own, bodies[slave].points)]
    own = own[np.argsort(x[own])]
    return x[own], pressure[own], half_width, 2 * load / (np.pi * half_width)


@pytest.mark.parametrize("slave", [0, 1])
def test_two_cylinders_meet_hertz(slave) -> None:
    """Edges of 0.063 and 0.05 mm against a = 0.41 mm: the peak within 1 %, where contact ends within an edge."""
    x, pressure, half_width, peak = press_cylinders(slave)
    assert pressure.max() == pytest.approx(peak, rel=0.01)
    assert x.max() == pytest.approx(half_width, abs=0.063)
    inner = x < 0.6 * half_width
    exact = peak * np.sqrt(1 - (x[inner] / half_width) ** 2)
    np.testing.assert_allclose(pressure[inner], exact, rtol=0.03)


# --- friction ------------------------------------------------------------------------------------------------------
def slide_block(contact: str, **friction: float) -> list[tuple[FloatArray, State]]:
    """Press a block on a flat one 10,000 times as stiff, slide it 3 mm on and 1 mm back; force and state of each stage.

    The block's flow stress of 700 MPa matters only for k.
    """
    slider = block_mesh("quad4_fbar", (5, 2), origin=(4.0, 3.0), size=(8.0, 5.0))
    mesh, bodies = join_meshes(
        {"workpiece": slider, "die": block_mesh("quad4_fbar", (8, 2), origin=(0.0, 0.0), size=(20.0, 3.0))}
    )
    mesh = replace(mesh, blocks=(mesh.blocks[0], replace(mesh.blocks[1], material=1)))
    moves = {"press": (0.0, -0.003), "slide": (3.0, 0.0), "back": (-1.0, 0.0)}
    stages = [
        Stage(name, prescribed=tuple(PrescribedDisplacement("top", i, move[i]) for i in (0, 1)))
        for name, move in moves.items()
    ]
    solver = SolverSettings(initial_increment=0.02, max_increment=0.1, force_tolerance=1e-7, symmetric=False)
    soft = Material("soft", 2e5, 0.3, linear_hardening(700.0))
    model = make_model(mesh, soft, supports=[Support("die.bottom", (True, True))], stages=stages, solver=solver)
    procedure = ImplicitProcedure(
        replace(
            model,
            materials=(soft, elastic(2e9, 0.3)),
            bodies=bodies,
            contacts=(BodyContact("c", (0, 1), 0, contact, **friction),),
        ),
        threads=1,
    )
    ends = [procedure.state for report in procedure.advance() if report.fraction == 1.0]
    return [(state[InterfaceArrays].force[list(bodies[1].points)].sum(axis=0), state) for state in ends]


def test_sliding_block_drags_by_coulombs_law_and_turns_round() -> None:
    _, slid, back = slide_block("coulomb", mu=0.2)
    for (force, state), way in ((slid, 1.0), (back, -1.0)):
        assert force[0] == pytest.approx(-way * 0.2 * force[1], rel=1e-6)
        touching = state[InterfaceArrays].pressure > 0
        ratio = state[InterfaceArrays].shear[touching] / state[InterfaceArrays].pressure[touching]
        np.testing.assert_allclose(ratio, -way * 0.2, rtol=1e-9)


def test_sliding_block_drags_by_a_constant_shear() -> None:
    """m k over the whole face of 8 mm x 1 mm, which stays in contact under this load."""
    _, (force, state), _ = slide_block("shear", m=0.02)
    assert (state[InterfaceArrays].pressure > 0).sum() == 6
    assert force[0] == pytest.approx(0.02 * 700.0 / np.sqrt(3.0) * 8.0, rel=1e-3)


def test_the_smaller_of_both_limits_friction() -> None:
    _, (force, _), _ = slide_block("coulomb_capped", mu=0.2, m=0.02)
    assert force[0] == pytest.approx(0.02 * 700.0 / np.sqrt(3.0) * 8.0, rel=1e-3)
    _, (force, _), _ = slide_block("coulomb_capped", mu=0.02, m=0.5)
    assert force[0] == pytest.approx(-0.02 * force[1], rel=1e-6)


def test_frictionless_block_slides_freely() -> None:
    _, (force, _), _ = slide_block("frictionless")
    assert abs(force[0]) < 1e-3 * abs(force[1])


def test_bodies_that_stick_deform_like_one() -> None:
    """A block of two halves that stick, upset by 20 % beyond yield and shifted, against the block in one piece."""
    material = Material("steel", 2e5, 0.3, linear_hardening(700.0, 300.0))
    whole = block_mesh("quad4_fbar", (6, 8), origin=(0.0, 0.0), size=(6.0, 8.0))
    parts = [block_mesh("quad4_fbar", (6, 4), origin=(0.0, y), size=(6.0, 4.0)) for y in (0.0, 4.0)]
    halves, bodies = join_meshes({"workpiece": parts[0], "upper": parts[1]})
    found = []
    for mesh, top in ((whole, "top"), (halves, "upper.top")):
        model = make_model(
            mesh,
            material,
            supports=[Support("bottom", (True, True))],
            prescribed=[PrescribedDisplacement(top, 1, -1.6), PrescribedDisplacement(top, 0, 0.2)],
            solver=SolverSettings(initial_increment=0.05, max_increment=0.05, force_tolerance=1e-7, symmetric=False),
        )
        if mesh is halves:
            model = replace(model, bodies=bodies, contacts=(BodyContact("c", (0, 1), 0, "sticking"),))
        procedure, _ = run(model)
        found.append((mesh.points, procedure.state, procedure.state.nodes.reaction[mesh.node_sets[top]].sum(axis=0)))
    (points, state, force), (own_points, own_state, own_force) = found
    np.testing.assert_allclose(own_force, force, rtol=1e-4)
    same = [int(np.argmin(((points - x) ** 2).sum(axis=1))) for x in own_points]
    np.testing.assert_allclose(own_state.nodes.displacement, state.nodes.displacement[same], atol=1e-5)


# --- a body with itself --------------------------------------------------------------------------------------------
def slotted_block(n: int, *, whole: bool) -> Mesh:
    """A block 10 x 8 mm with a slot 0.2 mm high from x = 3 mm to its right side, or its upper half."""
    x = np.concatenate([np.linspace(0.0, 3.0, 6 * n + 1), np.linspace(3.0, 10.0, 14 * n + 1)[1:]])
    y = np.concatenate([[0.0], np.linspace(0.1, 4.0, 8 * n + 1)])
    grid = mesh_rectangle(x, np.concatenate([-y[::-1], y[1:]]) if whole else y, element="quad4_fbar")
    cells = grid.blocks[0].connectivity
    middle = grid.points[cells].mean(axis=1)
    cells = cells[(middle[:, 0] < 3.0) | (np.abs(middle[:, 1]) > 0.1)]
    points, number = drop_unused_points(grid.points, [cells])
    cells = number[cells].astype(np.int32)
    sides = {
        "top": points[:, 1] == points[:, 1].max(),
        "bottom": points[:, 1] == points[:, 1].min(),
        "left": points[:, 0] == 0.0,
    }
    sets = {name: np.flatnonzero(mask).astype(np.int32) for name, mask in sides.items()}
    block = replace(grid.blocks[0], connectivity=cells)
    return Mesh(points, (block,), sets, {}, find_boundary_edges([cells]))


def close_slot(n: int, *, whole: bool) -> tuple[float, ImplicitProcedure]:
    """Press both sides together by 0.3 mm each; return the force, and the procedure at its end."""
    mesh = slotted_block(n, whole=whole)
    prescribed = [PrescribedDisplacement("top", 1, -0.3)]
    supports = [Support("left", (True, False))]  # the plane holds the web of the half
    if whole:
        prescribed.append(PrescribedDisplacement("bottom", 1, 0.3))
    solver = SolverSettings(initial_increment=0.05, max_increment=0.05, force_tolerance=1e-6, symmetric=False)
    model = make_model(mesh, elastic(2e5, 0.3), supports=supports, prescribed=prescribed, solver=solver)
    if whole:
        body = Body("workpiece", range(len(mesh.points)), range(1))
        model = replace(model, bodies=(body,), contacts=(BodyContact("slot", (0, 0), 0, "frictionless"),))
    else:
        line = Profile(np.array([[-5.0, 0.0, 20.0, 0.0, 0.0, 0.0, 0.0]]))
        plane = Tool("plane", line, friction=Friction("frictionless"))
        model = replace(model, tools=(plane,))
    procedure, _ = run(model)
    return float(procedure.state.nodes.reaction[mesh.node_sets["top"], 1].sum()), procedure


def test_slot_that_closes_is_its_half_on_a_rigid_plane() -> None:
    """Self-contact by mortar against exact contact with the plane of symmetry: 0.3 % of the force, 0.03 % refined.

    Behind the root of the slot the gap opens within an edge: there the weighted mean gap is zero, and not each node's.
    """
    errors = []
    for n in (1, 2):
        force, procedure = close_slot(n, whole=True)
        half, _ = close_slot(n, whole=False)
        errors.append(abs(force / half - 1))
    assert errors[0] < 3e-3
    assert errors[1] < 3e-4
    force = procedure.state[InterfaceArrays].force
    assert np.abs(force.sum(axis=0)).max() < 1e-12 * np.abs(force).sum()
    bodies = procedure.interactions.bodies
    found = bodies.at(procedure.state, procedure.state, procedure.state.nodes.displacement)
    pushes = procedure.state[InterfaceArrays].pressure > 0
    assert pushes.sum() > 20
    assert np.abs(found.gap[pushes]).max() < 1e-3 * bodies.interfaces[0].edge


def test_the_two_sides_of_a_thin_wall_do_not_touch() -> None:
    """A wall one flat cell thick, with a contact with itself, bends no otherwise than without."""
    mesh = block_mesh("quad4_fbar", (6, 1), origin=(0.0, 0.0), size=(30.0, 1.0))
    moves = [PrescribedDisplacement("right", 1, 3.0)]
    model = make_model(mesh, elastic(2e5, 0.3), supports=[Support("left", (True, True))], prescribed=moves)
    free, _ = run(model)
    body = Body("workpiece", range(len(mesh.points)), range(1))
    itself = BodyContact("c", (0, 0), 0, "frictionless")
    touching, _ = run(replace(model, bodies=(body,), contacts=(itself,)))
    assert not touching.state[InterfaceArrays].pressure.any()
    np.testing.assert_allclose(touching.state.nodes.displacement, free.state.nodes.displacement, atol=1e-9)
