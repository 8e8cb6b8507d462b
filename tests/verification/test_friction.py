# SPDX-License-Identifier: Apache-2.0
"""Friction against closed forms: the sliding block, sticking to slipping, and Avitzur's upper bound for the ring."""

import numpy as np
import pytest

from presswork import Case, build_model
from presswork.implicit.progress import Progress
from presswork.implicit.stepping import ImplicitProcedure
from presswork.interaction.tool_arrays import ContactArrays

YIELD = 700.0
SIDE, DEPTH = 10.0, 2.0


def sliding_block(contact: dict[str, object], press: float, slide: float, **solver: object) -> Case:
    """An elastic block, its top clamped; a floor presses it, then moves to the right."""
    return Case(
        title="sliding block",
        analysis="plane_strain",
        depth=DEPTH,
        workpiece={
            "material": "steel",
            "element": "quad4_fbar",
            "mesh": {"kind": "rectangle", "size": [SIDE, SIDE], "cells": [6, 6]},
        },
        materials={
            "steel": {"young": 200e3, "poisson": 0.3, "hardening": {"law": "linear", "yield_stress": YIELD}},
        },
        tools={"floor": {"profile": [[-30, 0], [30, 0]], **contact}},
        boundary={"top": {"set": "top", "fix": ["x", "y"]}},
        stages=[
            {"name": "press", "tools": {"floor": {"move": [0, press]}}},
            {"name": "slide", "tools": {"floor": {"move": [slide, 0]}}},
        ],
        solver={"max_increment": 0.1, "initial_increment": 0.1, "force_tolerance": 1e-9, **solver},
    )


def slide_block(contact: dict[str, object], press: float, slide: float, **solver: object) -> list[np.ndarray]:
    """Force on the floor after each increment."""
    case = sliding_block(contact, press, slide, **solver)
    procedure = ImplicitProcedure(build_model(case), threads=1)
    forces = []
    for _ in procedure.advance():
        stage = min(procedure.state[Progress].stage, 1)
        procedure.interactions.tools.contact.search(procedure.state, procedure.state.nodes.displacement)
        forces.append(
            procedure.interactions.tools.contact.tool_forces(
                procedure.state, procedure.interactions.supports.fixed(stage)
            )[0][0]
        )
    return forces


@pytest.mark.parametrize("mu", [0.05, 0.2, 0.5])
def test_a_sliding_block_pulls_with_mu_times_the_normal_force(mu) -> None:
    fx, fy = slide_block({"contact": "coulomb", "mu": mu}, press=0.005, slide=0.1)[-1]
    assert fx == pytest.approx(mu * fy, rel=1e-6) or -fx == pytest.approx(mu * abs(fy), rel=1e-6)


@pytest.mark.parametrize(("m", "press"), [(0.05, 0.01), (0.2, 0.02)])
def test_a_sliding_block_under_constant_shear_pulls_with_m_k_area(m, press) -> None:
    """Where it is pressed on so hard that its heel does not lift."""
    fx, fy = slide_block({"contact": "shear", "m": m}, press=press, slide=0.1)[-1]
    length = SIDE  # the strain of the contact surface is of the order of 1e-4
    assert abs(fx) == pytest.approx(m * YIELD / np.sqrt(3) * length * DEPTH, rel=2e-3)
    assert abs(fy) > 0


@pytest.mark.parametrize(("m", "touching"), [(0.2, 0.9066), (0.3, 0.8215)])
@pytest.mark.parametrize("n", [6, 16])
def test_a_block_whose_heel_lifts_is_not_held_there(m, touching, n) -> None:
    """Shear bends it off the floor; no node pulls. touching: part of m k area on a mesh of 96 x 96.

    On a coarse mesh the last node can neither be held, since it pulls then, nor let go, since it comes back.
    """
    case = sliding_block({"contact": "shear", "m": m}, 0.01, 0.05)
    mesh = case.workpiece.mesh.model_copy(update={"cells": (n, n)})
    procedure = ImplicitProcedure(
        build_model(case.model_copy(update={"workpiece": case.workpiece.model_copy(update={"mesh": mesh})})), threads=1
    )
    for _ in procedure.advance():
        pass
    contact, state = procedure.interactions.tools.contact, procedure.state
    contact.search(state, state.nodes.displacement)
    push = contact.normal_forces(state, state.nodes.reaction, procedure.interactions.supports.fixed(1))
    assert push.min() > -1e-6 * push.max()
    drag = np.abs(state[ContactArrays].drag).sum() / (m * YIELD / np.sqrt(3) * SIDE * DEPTH)
    assert drag == pytest.approx(touching, abs=0.02 if n == 6 else 0.012)


def test_a_cap_takes_over_where_coulomb_would_exceed_it() -> None:
    capped = slide_block({"contact": "coulomb_capped", "mu": 0.5, "m": 0.01}, press=0.005, slide=0.1)[-1]
    shear = slide_block({"contact": "shear", "m": 0.01}, press=0.005, slide=0.1)[-1]
    assert abs(capped[0]) == pytest.approx(abs(shear[0]), rel=0.02)
    free = slide_block({"contact": "coulomb_capped", "mu": 0.02, "m": 1.0}, press=0.005, slide=0.1)[-1]
    assert abs(free[0]) == pytest.approx(0.02 * abs(free[1]), rel=1e-6)


def test_friction_rises_elastically_and_stays_at_its_limit() -> None:
    forces = np.array(slide_block({"contact": "coulomb", "mu": 0.3}, press=0.005, slide=0.01))
    ratio = np.abs(forces[10:, 0] / forces[10:, 1])
    assert (np.diff(ratio) > -1e-9).all()
    assert ratio[0] < 0.2
    assert ratio.max() <= 0.3 * (1 + 1e-6)
    assert ratio[-1] == pytest.approx(0.3, rel=1e-6)


def test_the_answer_does_not_depend_on_the_friction_tangent() -> None:
    ends = [
        slide_block({"contact": "shear", "m": 0.3}, 0.005, 0.05, friction_tangent=tangent, max_iterations=200)[-1]
        for tangent in ("return_mapping", "bond")
    ]
    np.testing.assert_allclose(ends[0], ends[1], rtol=1e-6)


@pytest.mark.parametrize("law", ["shear", "coulomb"])
@pytest.mark.parametrize("drawn", ["rightwards", "leftwards"])
def test_each_zone_of_a_floor_rubs_with_its_own_friction(law, drawn) -> None:
    """By hand: in plane strain the drag is the sum over zones of m k length depth, or of mu times their normal force.

    The block stands on both zones, 10 mm wide, the border at x = 4 between nodes; the floor slides by 0.02 mm.
    """
    low, high = (0.04, 0.16) if law == "shear" else (0.1, 0.4)
    symbol = "m" if law == "shear" else "mu"
    border = 4.0
    profile = [[-30, 0], {"to": [border, 0], symbol: low}, [30, 0]]
    if drawn == "leftwards":
        profile = [[30, 0], [border, 0], {"to": [-30, 0], symbol: low}]
    contact = {"contact": law, symbol: high, "profile": profile}
    press = 0.01 if law == "shear" else 0.005
    nodes, drag, push = slide_on_zones(contact, press, 0.02)
    smooth = nodes < border
    assert 0 < smooth.sum() < len(nodes)
    if law == "coulomb":
        np.testing.assert_allclose(drag / push, np.where(smooth, low, high), rtol=1e-6)
    else:
        share = np.where((nodes < 0.1) | (nodes > SIDE - 0.1), 0.5, 1.0) * SIDE / 6 * DEPTH
        np.testing.assert_allclose(drag, np.where(smooth, low, high) * YIELD / np.sqrt(3) * share, rtol=5e-3)


def slide_on_zones(contact: dict[str, object], press: float, slide: float) -> tuple[np.ndarray, ...]:
    """Position, friction and normal force of the floor's nodes at the end."""
    procedure = ImplicitProcedure(build_model(sliding_block(contact, press, slide)), threads=1)
    for _ in procedure.advance():
        pass
    bottom = procedure.model.mesh.node_sets["bottom"]
    force = procedure.state.nodes.reaction[bottom]
    x = procedure.model.mesh.points[bottom, 0] + procedure.state.nodes.displacement[bottom, 0]
    drag = procedure.state[ContactArrays].drag[np.searchsorted(procedure.interactions.tools.contact.nodes, bottom)]
    return x, np.abs(drag), np.abs(force[:, 1])


def press_ring(m: float) -> float:
    """Bore ratio of the ring 6:3:2 at 50 % reduction, mean over the height."""
    case = Case(
        title="ring",
        analysis="axisymmetric",
        workpiece={
            "material": "steel",
            "element": "tri3",
            "mesh": {"kind": "rectangle", "origin": [9, 0], "size": [9, 6], "cells": [10, 5], "pattern": "crossed"},
        },
        materials={
            "steel": {
                "young": 200e3,
                "poisson": 0.3,
                "hardening": {"law": "linear", "yield_stress": YIELD, "modulus": 300},
            }
        },
        tools={"punch": {"profile": [[0, 6], [60, 6]], "contact": "shear", "m": m}},
        boundary={"middle": {"set": "bottom", "fix": ["y"]}},
        stages=[{"name": "press", "tools": {"punch": {"move": [0, -3]}}}],
    )
    model = build_model(case)
    procedure = ImplicitProcedure(model, threads=1)
    bore = model.mesh.node_sets["left"]
    for _ in procedure.advance():
        pass
    x = model.mesh.points[bore] + procedure.state.nodes.displacement[bore]
    order = np.argsort(x[:, 1])
    return float(np.trapezoid(x[order, 0], x[order, 1]) / np.ptp(x[:, 1]) / 9.0)


# bore ratio at 50 % reduction by Avitzur's upper bound for the parallel velocity field, integrated for 6:3:2
@pytest.mark.parametrize(("m", "avitzur"), [(0.05, 1.27130), (0.1, 1.13640)])
def test_ring_meets_avitzurs_calibration_at_low_friction(m, avitzur) -> None:
    """Where the ring bulges little, the upper bound with its flat walls is close: within 1 % of the bore."""
    assert press_ring(m) == pytest.approx(avitzur, rel=0.01)


def test_a_frictionless_ring_grows_by_the_root_of_the_height() -> None:
    assert press_ring(0.0) == pytest.approx(np.sqrt(2), rel=2e-3)


def test_the_bore_shrinks_with_friction() -> None:
    bores = [press_ring(m) for m in (0.0, 0.1, 0.2, 0.4, 1.0)]
    assert (np.diff(bores) < 0).all()
