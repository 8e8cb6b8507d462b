# SPDX-License-Identifier: Apache-2.0
"""Whether anything holds the workpiece when a run begins, and stops a tool that a force pushes."""

from __future__ import annotations

import numpy as np

from presswork.interaction.of_model import Interactions
from presswork.interaction.supports import NotHeldError, check_held_in_space
from presswork.interaction.tool_arrays import ContactArrays
from presswork.model import Body, BoolArray, Model
from presswork.state import State


def check_held(model: Model, interactions: Interactions, state: State) -> None:
    """Refuse bodies that the first increment would push away."""
    if interactions.inertia:
        return
    if model.dimension == 3:
        tools = interactions.space_tools
        touched = tools.held_directions(state) if tools else None
        touching = interactions.bodies.touching(state) if model.contacts else []
        check_held_in_space(model, interactions.supports.fixed(0), touched, touching)
        check_pushed(model, interactions, state, 0)
        return
    whole = Body("workpiece", range(len(model.mesh.points)), range(len(model.mesh.blocks)))
    bodies = model.bodies or (whole,)
    touching = interactions.bodies.touching(state)
    for number, body in enumerate(bodies):
        held = _held_by_tools(model, interactions, state, body)
        for contact, _, directions in touching:
            if number in contact.between and contact.between[0] != contact.between[1]:
                held |= (np.abs(directions) > 0.1).any(axis=0)
        if not held.all():
            free = " and ".join(axis for axis, is_held in zip("xy", held, strict=True) if not is_held)
            name = f"the {body.name}" if number == 0 else f"the body {body.name!r}"
            others = " and no other body" if model.contacts else ""
            raise NotHeldError(
                f"nothing holds {name} in {free}: no boundary or displacement fixes a point there, and no tool "
                f"that holds its place{others} touches it at the start. Add a [boundary] entry, or let a tool "
                "touch it"
            )
    check_pushed(model, interactions, state, 0)


def _held_by_tools(model: Model, interactions: Interactions, state: State, body: Body) -> BoolArray:
    """Say for x and y whether supports, or tools that touch it at the start, hold a body."""
    tools = interactions.tools
    fixed = interactions.supports.fixed(0)[body.points.start : body.points.stop]
    held: BoolArray = np.asarray(fixed.any(axis=0))
    held[0] |= model.analysis == "axisymmetric"  # a ring resists its growth
    pushed = tools.floating.pushed(0)
    own = np.isin(tools.contact.nodes, body.points)
    for t, tool in enumerate(model.plane_tools):
        face, place = np.nonzero(state[ContactArrays].status[2 * t : 2 * t + 2] * own)
        along = tools.contact.normal[2 * t + face, place]
        if tool.friction.law != "frictionless":
            along = np.concatenate([along, along[:, ::-1] * (-1, 1)])
        if t in pushed:  # it holds only across its way
            direction, _ = pushed[t]
            along = along - (along @ direction)[:, None] * direction
        held |= (np.abs(along) > 0.1).any(axis=0)
    return held


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
