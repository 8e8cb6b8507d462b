# SPDX-License-Identifier: Apache-2.0
"""The model of a part without its tools: symmetry planes, and what holds it against rigid motions."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from presswork.mesh.topology import find_parts
from presswork.model import (
    FloatArray,
    Mesh,
    Model,
    OutputSettings,
    ShellElement,
    SolverSettings,
    Springback,
    Stage,
    Support,
    find_cell,
)

NAME = "springback"
ELEMENTS: dict[str, ShellElement] = {"tri3": "shell3_mitc_plus", "quad4": "shell4_mitc_plus"}
"""Elements by number of nodes."""
SYMMETRY = tuple(tuple(i in held for i in range(6)) for held in ((0, 4, 5), (1, 3, 5)))
"""What planes normal to x and y hold: a displacement and two rotations."""
APART = 0.2
"""Least distance of the nodes that hold the sheet, over the blank's length and width."""


def hold_rigidly(points: FloatArray, symmetry: tuple[bool, bool]) -> dict[int, tuple[bool, bool, bool]]:
    """Return the nodes, and which of their displacements, that hold a blank against the rigid motions left.

    points: undeformed (n_points, 3), about z = 0; symmetry: whether planes normal to x and y hold it already.
    """
    x, y = points[:, 0], points[:, 1]
    middle = [0.0 if cut else 0.5 * (p.min() + p.max()) for p, cut in zip((x, y), symmetry, strict=True)]
    first = int(np.argmin((x - middle[0]) ** 2 + (y - middle[1]) ** 2))
    away = points[:, :2] - points[first, :2]
    far = np.abs(away) >= APART * np.ptp(points[:, :2], axis=0)
    along_x, along_y = (int(np.argmin(np.where(far[:, i], (away**2).sum(axis=1), np.inf))) for i in (0, 1))
    held = {first: np.array([not symmetry[0], not symmetry[1], True])}
    # rotation about y, x and z: each is held by a distance from the first node, unless a plane holds it
    for node, direction, free in (
        (along_x, 2, not symmetry[0]),
        (along_y, 2, not symmetry[1]),
        (along_x, 1, not any(symmetry)),
    ):
        if free:
            held.setdefault(node, np.zeros(3, dtype=bool))[direction] = True
    return {node: (bool(h[0]), bool(h[1]), bool(h[2])) for node, h in held.items()}


def make_springback_model(model: Model, mesh: Mesh, turned: FloatArray | None = None) -> Model:
    """Return the Model of the released sheet; mesh: undeformed; turned: as of LaidPart, None: it was never turned."""
    springback = model.springback or Springback()
    planes = [s for s in model.lasting_supports if s.fix in SYMMETRY]
    blocks = tuple(replace(block, element=ELEMENTS[find_cell(2, block.connectivity).name]) for block in mesh.blocks)
    node_sets = dict(mesh.node_sets)
    supports = list(planes)
    points = mesh.points if turned is None else mesh.points @ turned.T
    cells = [block.connectivity for block in mesh.blocks]
    part = find_parts(cells, len(points))[1]
    held: dict[int, tuple[bool, bool, bool]] = {}
    for index in np.unique(np.concatenate([part[each[:, 0]] for each in cells])):  # of sheets on each other each
        own = np.flatnonzero(part == index)
        held |= {int(own[node]): fixed for node, fixed in hold_rigidly(points[own], model.symmetry).items()}
    for node, fixed in held.items():
        name = f"held_{node}"
        node_sets[name] = np.array([node], dtype=np.int32)
        supports.append(Support(name, (*fixed, False, False, False)))
    size, plain = 1.0 / springback.increments, SolverSettings()
    return Model(
        title=model.title,
        analysis="shell",
        mesh=replace(mesh, blocks=blocks, node_sets=node_sets),
        zones=model.zones,
        materials=model.materials,
        supports=tuple(supports),
        stages=(Stage(NAME, duration=model.stages[-1].duration),),
        solver=SolverSettings(
            initial_increment=size,
            max_increment=size,
            force_tolerance=min(plain.force_tolerance, model.solver.force_tolerance),
            displacement_tolerance=min(plain.displacement_tolerance, model.solver.displacement_tolerance),
        ),
        output=OutputSettings(steps=1),
    )
