# SPDX-License-Identifier: Apache-2.0
"""Whether anything holds the bodies when a run begins and in each increment, and stops a tool that a force pushes."""

from __future__ import annotations

import numpy as np

from presswork.interaction.loose_bodies import LooseArrays
from presswork.interaction.of_model import Interactions
from presswork.interaction.rigid_motions import (
    Held,
    RigidMotions,
    about_points,
    find_free,
    find_named,
    hold_along,
    hold_by_supports,
    name_body,
    name_motions,
    spread,
    spread_contact,
)
from presswork.interaction.supports import NotHeldError
from presswork.interaction.tool_arrays import ContactArrays
from presswork.model import BoolArray, FloatArray, Model, list_bodies
from presswork.state import State

SLANTED = 0.1
"""Component of a unit vector along an axis above which a support holds along that axis."""


def check_held(model: Model, interactions: Interactions, state: State) -> None:
    """Refuse bodies that the first increment would push away."""
    if interactions.inertia:
        return
    if model.dimension == 3:
        _check_held_in_space(model, interactions, state)
    else:
        _check_held_in_plane(model, interactions, state)
    check_pushed(model, interactions, state, 0)


def _check_held_in_space(model: Model, interactions: Interactions, state: State) -> None:
    """Refuse bodies in space that are free to move as rigid ones."""
    free = find_free(_find_holds(model, interactions, state, 0, lying=False))
    if not free.shape[2]:
        return
    bodies, names = list_bodies(model), name_motions(model)
    most = np.abs(free).max(axis=2)
    number = int(most.max(axis=1).argmax())
    named = " and ".join(name for name, part in zip(names, find_named(free)[number], strict=True) if part)
    others = " and no other body that is held touches it there" if len(bodies) > 1 else ""
    count = free.shape[2]
    raise NotHeldError(
        f"nothing holds {name_body(model, bodies[number])} against {count} rigid motion{'s' * (count > 1)} "
        f"({named}){others}; add a [boundary] entry"
    )


def _check_held_in_plane(model: Model, interactions: Interactions, state: State) -> None:
    """Refuse bodies in the plane that are free to move along x or y."""
    bodies = list_bodies(model)
    held = _find_holds(model, interactions, state, 0, lying=False)
    for number, body in enumerate(bodies):
        axes = "y" if model.analysis == "axisymmetric" else "xy"
        felt: BoolArray = np.asarray((np.abs(held[:, number, : len(axes)]) > SLANTED).any(axis=0))
        if not felt.all():
            free = " and ".join(axis for axis, is_held in zip(axes, felt, strict=True) if not is_held)
            others = " and no other body" if model.contacts else ""
            raise NotHeldError(
                f"nothing holds {name_body(model, body)} in {free}: no boundary or displacement fixes a point there, "
                f"and no tool that holds its place{others} touches it at the start; add a [boundary] entry, or let a "
                "tool touch it"
            )


def note_loose(model: Model, interactions: Interactions, state: State, stage: int) -> None:
    """Note in a converged state the motions of bodies that nothing holds.

    Bodies that lie on a tool are held by it, but do not move by themselves.
    """
    if interactions.inertia:
        return
    own = state[LooseArrays]
    own.free = np.zeros_like(own.free)
    if not _leaves_free(model, interactions, state, stage):
        return
    free = find_free(_find_holds(model, interactions, state, stage, lying=False))
    rows = free.reshape(len(own.free), free.shape[2])
    own.free = rows @ rows.T
    if not own.free.any():
        return
    loose = find_named(find_free(_find_holds(model, interactions, state, stage, lying=True)))
    own.stage[loose & (own.stage < 0)] = stage


def _leaves_free(model: Model, interactions: Interactions, state: State, stage: int) -> bool:
    """Return whether supports leave any body a rigid motion."""
    rows, _ = _find_support_rows(model, interactions, state, stage)
    return int(find_free(rows).shape[2]) > 0


def _find_support_rows(
    model: Model, interactions: Interactions, state: State, stage: int
) -> tuple[FloatArray, RigidMotions]:
    """Return what supports feel of the rigid motions of bodies (n, n_bodies, n_motions), and these."""
    points, supports = model.mesh.points + state.nodes.moved, interactions.supports
    motions = about_points(model, points)
    rows = hold_by_supports(motions, points, supports.fixed(stage), supports.slanted(stage))
    return spread(list_bodies(model), rows, len(name_motions(model))), motions


def _find_holds(model: Model, interactions: Interactions, state: State, stage: int, *, lying: bool) -> FloatArray:
    """Return what all that holds bodies feels of their rigid motions (n, n_bodies, n_motions).

    lying: tools hold nodes that lie on them without a push, too.
    """
    rows, motions = _find_support_rows(model, interactions, state, stage)
    bodies, points = list_bodies(model), model.mesh.points + state.nodes.moved
    tools = interactions.space_tools
    by_tools: Held | None
    if model.dimension == 3:
        by_tools = tools.held_directions(state, stage, lying=lying) if tools else None
    else:
        by_tools = _hold_by_plane_tools(model, interactions, state, stage)
    found = [rows]
    if by_tools is not None:
        found.append(spread(bodies, [hold_along(motions, points, by_tools)], rows.shape[2]))
    for contact, places, directions in interactions.bodies.touching(state):
        found.append(spread_contact(motions, len(bodies), contact, places, directions))
    return np.concatenate(found)


def _hold_by_plane_tools(model: Model, interactions: Interactions, state: State, stage: int) -> Held:
    """Return the nodes (n,) that tools touch, and unit vectors (n, 2) along which these hold them."""
    tools = interactions.tools
    pushed = tools.floating.pushed(stage)
    nodes, directions = [np.zeros(0, dtype=np.int32)], [np.zeros((0, 2))]
    tools.contact.search(state, state.nodes.displacement)
    for t, tool in enumerate(model.plane_tools):
        face, place = np.nonzero(state[ContactArrays].status[2 * t : 2 * t + 2])
        along, own = tools.contact.normal[2 * t + face, place], tools.contact.nodes[place]
        if tool.friction.law != "frictionless":
            along, own = np.concatenate([along, along[:, ::-1] * (-1, 1)]), np.concatenate([own, own])
        if t in pushed:  # it holds only across its direction
            direction, _ = pushed[t]
            along = along - (along @ direction)[:, None] * direction
        nodes.append(own)
        directions.append(along)
    return np.concatenate(nodes), np.concatenate(directions)


def check_pushed(model: Model, interactions: Interactions, state: State, stage: int) -> None:
    """Refuse a tool that a force pushes at nothing when a stage begins with this state."""
    if model.dimension == 3:
        _check_pushed_in_space(model, interactions, state, stage)
        return
    for t, (direction, _) in interactions.tools.floating.pushed(stage).items():
        face, place = np.nonzero(state[ContactArrays].status[2 * t : 2 * t + 2])
        if not (interactions.tools.contact.normal[2 * t + face, place] @ direction > 0.1).any():
            raise _explain_not_stopped(model.plane_tools[t].name, model.stages[stage].name)


def _check_pushed_in_space(model: Model, interactions: Interactions, state: State, stage: int) -> None:
    """Refuse such a tool in space."""
    tools = interactions.space_tools
    if tools is None or model.analysis != "solid":
        return
    pushes = tools.floating.pushes(stage)
    if not pushes:
        return
    touched = tools.contact.touched(state)
    for t, push in pushes.items():
        if not (touched[t] @ np.array(push.direction) > 0.0).any():
            raise _explain_not_stopped(model.space_tools[t].name, model.stages[stage].name)


def _explain_not_stopped(name: str, where: str) -> NotHeldError:
    return NotHeldError(
        f"the tool {name!r} is pushed by a force in stage {where!r}, but nothing lies before it that would "
        "stop it: it does not touch the workpiece there when the stage begins. Bring it there first by a "
        "stage with a stroke, or put it on a spring"
    )
