# SPDX-License-Identifier: Apache-2.0
"""Contact of a body with itself, switched on in the run where its outline is about to fold onto itself."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from presswork.implicit.stepping import ImplicitProcedure
from presswork.interaction.bodies.body_surfaces import InterfaceArrays
from presswork.mesh.topology import halve_edges
from presswork.model import Body, BodyContact, Model, find_cell
from presswork.remesh.space.closing import find_closing_faces
from presswork.remesh.triggers import find_closing_gap


def add_self_contact(model: Model, numbers: Sequence[int]) -> Model:
    """Return the model with frictionless contact of bodies, by their numbers, with themselves.

    Contact of bodies needs all of the tangent: with its symmetric part alone iterations stall.
    """
    bodies = model.bodies or (Body("workpiece", range(len(model.mesh.points)), range(len(model.mesh.blocks))),)
    added = tuple(
        BodyContact(f"{bodies[i].name} on itself", (i, i), i, "frictionless", keeps_slave=True, by_itself=True)
        for i in numbers
    )
    solver = replace(model.solver, symmetric=False)
    return replace(model, bodies=bodies, contacts=(*model.contacts, *added), solver=solver)


def touches_itself(model: Model, number: int) -> bool:
    """Return whether a model has contact of a body, by its number, with itself."""
    return any(contact.between == (number, number) for contact in model.contacts)


def find_folding(run: ImplicitProcedure, bodies: Sequence[Body]) -> dict[int, str]:
    """Return by number the bodies whose surfaces are about to fold onto themselves, with a note of each.

    A body that has contact with itself is not looked at, nor are 10-node tetrahedra, whose faces touch tools alone.
    """
    mesh, nodes, notes = run.model.mesh, run.state.nodes, {}
    for number, body in enumerate(bodies):
        if touches_itself(run.model, number):
            continue
        if run.model.dimension == 2:
            edges = halve_edges(mesh.boundary_edges[body.owns(mesh.boundary_edges)])
            place = find_closing_gap((mesh.points + nodes.displacement)[edges], nodes.increment[edges])
        elif find_cell(2, mesh.boundary_faces).is_quadratic:
            continue
        else:
            faces = mesh.boundary_faces[body.owns(mesh.boundary_faces)]
            place = find_closing_faces(mesh.points + nodes.moved, nodes.increment[:, :3], faces)
        if place is not None:
            where = ", ".join(f"{value:.4g}" for value in place)
            notes[number] = (
                f"{body.name} is about to fold onto itself near ({where}): contact with itself is switched on"
            )
    return notes


def switch_on(run: ImplicitProcedure, numbers: Sequence[int]) -> ImplicitProcedure:
    """Return the procedure that goes on from a converged state with contact of bodies with themselves."""
    after = ImplicitProcedure(add_self_contact(run.model, numbers), before=run)
    for arrays in run.state:
        if not isinstance(arrays, InterfaceArrays):
            after.state.replace(arrays.duplicate())
            continue
        kept = after.state[InterfaceArrays]
        for name in ("pressure", "shear", "slip"):  # slots of contacts that there were come first
            slots = getattr(arrays, name)
            getattr(kept, name)[: len(slots)] = slots
        kept.force, kept.friction = arrays.force.copy(), arrays.friction.copy()
        kept.search_displacement = np.array(arrays.search_displacement)
    return after
