# SPDX-License-Identifier: Apache-2.0
"""Contact of deformable bodies in explicit runs: its surfaces, its friction, and what is recorded of it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from presswork.explicit.body_contacts import BodyContactOfRun, TouchingBodies, TouchingSurfaces
from presswork.fields.contact_stress import BodyTraction
from presswork.interaction.bodies.body_interface import Interface
from presswork.interaction.bodies.body_surfaces import MARGIN, REACH, STEEPEST, CellsOfSides
from presswork.interaction.bodies.space_interface import SpaceInterface
from presswork.interaction.heat.forming_instant import BetweenBodies
from presswork.model import FloatArray, HeatContact, IntArray, Mesh, Model
from presswork.observe.contract import Row


class ContactsOfRun:
    """The contacts of a model's bodies beside the explicit loop."""

    def __init__(self, model: Model, surfaces: Sequence[TouchingSurfaces], solids: TouchingBodies) -> None:
        """surfaces: as find_touching has them; solids: of the explicit loop, to which the contacts are added."""
        self._model, self._of = model, model.contacts
        self.added: list[BodyContactOfRun] = []
        for contact, of in zip(model.contacts, surfaces, strict=True):
            mu = STEEPEST.get(contact.contact, float(contact.mu))
            self.added.append(solids.add_contact(contact.name, of, mu=mu, reach=REACH, margin=MARGIN))
        self._begin = [each.impulse for each in self.added]
        self._lost = [each.lost for each in self.added]
        self._force = [np.zeros(3) for _ in self.added]

    @property
    def limits_shear(self) -> bool:
        """Whether the shear flow stress limits friction somewhere."""
        return any(contact.contact in ("shear", "coulomb_capped") for contact in self._of)

    def set_limits(self, flow_stress: FloatArray) -> None:
        """Let friction be no more than m k, with the shear flow stress k of the cells round a node, from now on.

        flow_stress: of the cells (n_cells,) [MPa].
        """
        if not self.limits_shear:
            return
        shear = find_nodal_shear_strength(self._model.mesh, flow_stress)
        for contact, added in zip(self._of, self.added, strict=True):
            if contact.contact in ("shear", "coulomb_capped"):
                added.limit_friction(float(contact.m) * shear)

    def begin_row(self) -> None:
        """Keep what a row of cycles begins with."""
        self._begin = [each.impulse for each in self.added]
        self._lost = [each.lost for each in self.added]

    def end_row(self, dt: float) -> None:
        """Find the mean forces of a row of dt [s]."""
        self._force = [(each.impulse - begin) / dt for each, begin in zip(self.added, self._begin, strict=True)]

    @property
    def columns(self) -> list[str]:
        """Return the columns of history.csv."""
        axes = "xyz"[: self._model.dimension]
        return [f"{contact.name}.force_{axis}" for contact in self._of if not contact.by_itself for axis in axes]

    def row(self) -> Row:
        """Return the mean force of the first body of each contact on the second."""
        row: Row = {}
        for contact, force in zip(self._of, self._force, strict=True):
            sign = 1.0 if contact.slave == contact.between[0] else -1.0
            row |= {f"{contact.name}.force_{axis}": sign * float(f) for axis, f in zip("xyz", force, strict=True)}
        return {name: row[name] for name in self.columns}

    def find_traction(self, by_tools: FloatArray) -> BodyTraction | None:
        """Return pressure, shear and force at the nodes; None where no bodies may touch.

        by_tools: forces of the tools (n_nodes, d) [N], which the forces contain.
        """
        if not self.added:
            return None
        n, d = by_tools.shape
        pressure, shear, force = np.zeros(n), np.zeros(n), np.zeros((n, 3))
        force[:, :d] = by_tools
        for each in self.added:
            area, push, drag = each.area, each.push, each.friction_force
            whole = np.where(area > 1e-9 * area.max(initial=0.0), area, np.inf)
            touched = np.linalg.norm(push, axis=1) > 0.0
            pressure[touched] = (np.linalg.norm(push, axis=1) / whole)[touched]
            shear[touched] = (np.linalg.norm(drag, axis=1) / whole)[touched]
            pushes = each.pressure > 0.0
            pressure[each.slots[pushes]] = each.pressure[pushes]
            shear[each.slots[pushes]] = np.linalg.norm(each.shear, axis=1)[pushes]
            force += push + drag
        return BodyTraction(pressure, shear, force)

    def show_heat(self, moved: FloatArray, entries: Sequence[HeatContact]) -> BetweenBodies:
        """Return how bodies press on each other and slide at the end of a row.

        moved: of the nodes in the row (n_nodes, d) [mm]; entries: contacts that pass heat.
        """
        n, lost = len(moved), 0.0
        pressure, shear = {}, {}
        added = {each.name: each for each in self.added}
        for entry in entries:
            each = added[entry.name]
            pressure[entry.name], shear[entry.name] = np.zeros(n), np.zeros(n)
            pressure[entry.name][each.slots] = each.pressure
            shear[entry.name][each.slots] = np.linalg.norm(each.shear, axis=1)
        for each, before in zip(self.added, self._lost, strict=True):
            lost += each.lost - before
        return BetweenBodies(pressure, shear, moved, lost)


def find_touching(model: Model) -> list[TouchingSurfaces]:
    """Return the surfaces of the contacts of a model's bodies."""
    found = []
    for contact in model.contacts:
        sides = (SpaceInterface if model.dimension == 3 else Interface)(model, contact, 0)
        slave, master = (
            _list_cells(model.mesh, cells, len(faces))
            for cells, faces in zip(sides.cells_behind, (sides.slave, sides.master), strict=True)
        )
        found.append(
            TouchingSurfaces(
                sides.slave,
                sides.master,
                slave,
                master,
                by_itself=sides.is_self,
                edge=sides.mean_edge,
                thickness=model.depth if model.analysis == "plane_strain" else 0.0,
            )
        )
    return found


def find_nodal_shear_strength(mesh: Mesh, flow_stress: FloatArray) -> FloatArray:
    """Return the shear flow stress of the cells round each node (n_nodes,) [MPa]; flow_stress: of the cells."""
    cells = [block.connectivity for block in mesh.blocks]
    nodes = np.concatenate([of.ravel() for of in cells])
    rows = np.repeat(np.arange(len(flow_stress)), np.concatenate([np.full(len(of), of.shape[1]) for of in cells]))
    count = np.bincount(nodes, minlength=len(mesh.points))
    total = np.bincount(nodes, flow_stress[rows], minlength=len(mesh.points))
    return np.asarray(total / np.maximum(count, 1) / np.sqrt(3.0))


def _list_cells(mesh: Mesh, cells: CellsOfSides, n_faces: int) -> IntArray:
    """Return the nodes of the cell behind each face (n_faces, nodes)."""
    widest = max(mesh.blocks[number].connectivity.shape[1] for number, _, _ in cells)
    found = np.zeros((n_faces, widest), dtype=np.int32)
    for number, places, of in cells:
        nodes = mesh.blocks[number].connectivity[of]
        found[places] = nodes[:, np.minimum(np.arange(widest), nodes.shape[1] - 1)]
    return found
