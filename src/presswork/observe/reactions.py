# SPDX-License-Identifier: Apache-2.0
"""What supports and prescribed displacements hold a body with: a force for each of them, and the field of all.

A reaction is the force of what holds on the body, of what is modelled: in axisymmetry of the whole ring (x is radial,
added up round it), in plane strain of the depth, on a symmetry plane of the part that is modelled. A freedom that two
entries hold counts in both.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from presswork.fields.instant import Instant
from presswork.formability import Info
from presswork.mesh.faces import select_faces
from presswork.model import Body, BoolArray, FloatArray, IntArray, Mesh, Model, take_corners
from presswork.observe.contract import Observed, Observer, Row

AXES = "xyz"


@dataclass(frozen=True)
class Holder:
    """A boundary entry, or the displacements prescribed on a set, under the name that the history gives it."""

    name: str
    node_set: str
    held: BoolArray
    """Freedoms by stage (n_stages, freedoms)."""
    moved: BoolArray
    """Freedoms that some stage moves (freedoms,)."""


class Reactions(Observer):
    """The holders of one model, in the order of the case.

    An entry has its own name, a prescribed displacement that of its set; where a tool or contact has that name, too,
    with boundary_ or displacement_ before it.
    """

    def __init__(self, model: Model) -> None:
        self._freedoms = freedoms = 6 if model.analysis in ("shell", "stamping") else model.dimension
        taken = [tool.name for tool in model.tools] + [contact.name for contact in model.contacts]
        found: dict[str, Holder] = {}
        prescribed = [stage.prescribed for stage in model.stages]
        n_stages = len(prescribed)
        for support in model.supports:
            if support.name:
                name = f"boundary_{support.name}" if support.name in taken else support.name
                held = np.tile(np.asarray(support.fix[:freedoms]), (n_stages, 1))
                held[[support.name in stage.released for stage in model.stages]] = False
                found[name] = Holder(name, support.node_set, held, np.zeros(freedoms, dtype=bool))
        displaced = {p.node_set: None for of_stage in prescribed for p in of_stage}
        for node_set in displaced:
            name = node_set
            if name in taken or (name in found and found[name].node_set != node_set):
                name = f"displacement_{node_set}"
            entry = found.get(name)
            held = np.zeros((n_stages, freedoms), dtype=bool) if entry is None else entry.held
            moved = np.zeros(freedoms, dtype=bool)
            for number, of_stage in enumerate(prescribed):
                for p in of_stage:
                    if p.node_set == node_set:
                        held[number, p.component] = True
                        moved[p.component] |= p.value != 0.0
            found[name] = Holder(name, node_set, held, moved)
        self.holders = tuple(found.values())

    @property
    def names(self) -> list[str]:
        """Return the names of its columns."""
        return [f"{holder.name}.{quantity}" for holder in self.holders for quantity in _quantities(holder)]

    def columns(self, run: Observed) -> list[str]:
        """Return the reactions of every holder, and the mean displacements of what is moved."""
        return self.names

    def row(self, run: Observed, *, is_released: bool = False) -> Row:
        """Return reactions and displacements; nothing is held once the part is released."""
        if is_released:
            return dict.fromkeys(self.names, 0.0)
        return self.measure(run.mesh, run.current_stage(), run.reactions(), run.displacements())

    def info(self, run: Observed) -> Info:
        """Return what nominal stress and strain are reckoned with."""
        return self.gauges(run.model)

    def show(self, run: Observed, now: Instant) -> None:
        """Show the reactions of solids where something holds them: Newton's method leaves round-off elsewhere."""
        if run.model.explicit is None and self._freedoms < 6:
            now.reaction = run.reactions()[:, :3] * self.mask(run.mesh, run.current_stage())

    def mask(self, mesh: Mesh, stage: int) -> BoolArray:
        """Mark the freedoms that anything holds in a stage (n_points, freedoms)."""
        mask = np.zeros((len(mesh.points), self._freedoms), dtype=bool)
        for holder in self.holders:
            mask[mesh.node_sets[holder.node_set]] |= holder.held[stage]
        return mask

    def measure(self, mesh: Mesh, stage: int, reaction: FloatArray, displacement: FloatArray) -> Row:
        """Return the columns: reactions, and the mean displacements of what is moved.

        reaction [N, N mm], displacement since the start [mm, rad]: (n_points, freedoms). Moments are about the mean
        place of the set's nodes.
        """
        row: Row = {}
        for holder in self.holders:
            nodes = mesh.node_sets[holder.node_set]
            own = reaction[nodes, : self._freedoms] * holder.held[stage]
            total, mean = own.sum(axis=0), displacement[nodes, : self._freedoms].mean(axis=0)
            if self._freedoms == 6:
                place = mesh.points[nodes] + displacement[nodes, :3]
                total[3:] += np.cross(place - place.mean(axis=0), own[:, :3]).sum(axis=0)
                mean[3:] = np.degrees(mean[3:])
            values = {
                **{f"force_{axis}": float(v) for axis, v in zip(AXES, total[:3], strict=False)},
                **{f"moment_{axis}": float(v) for axis, v in zip(AXES, total[3:], strict=False)},
                **{f"displacement_{axis}": float(v) for axis, v in zip(AXES, mean[:3], strict=False)},
                **{f"rotation_{axis}": float(v) for axis, v in zip(AXES, mean[3:], strict=False)},
            }
            row |= {f"{holder.name}.{quantity}": values[quantity] for quantity in _quantities(holder)}
        return row

    def gauges(self, model: Model) -> dict[str, FloatArray]:
        """Return the gauges for nominal stress and strain of every set that moves along one axis.

        Under `gauge_` and its name: the undeformed area across this axis [mm2], the length of its body along it [mm],
        and 1 if the set is at the upper end of the body, -1 if at the lower.
        """
        mesh, found = model.mesh, {}
        if model.zones:
            return {}  # no one area bears the force of a welded sheet
        section = mesh.blocks[0].section
        thickness = section.thickness if section else model.depth
        whole = Body("workpiece", range(len(mesh.points)), range(len(mesh.blocks)))
        for holder in self.holders:
            moved = np.flatnonzero(holder.moved[:3])
            if model.analysis == "solid":
                if len(moved) == 1 and (gauge := _gauge_faces(mesh, holder, int(moved[0]))) is not None:
                    found[f"gauge_{holder.name}"] = gauge
                continue
            edges = _edges_within(mesh, mesh.node_sets[holder.node_set])
            if len(moved) != 1 or not len(edges):
                continue
            ends = mesh.points[edges[:, :2]]
            span = np.delete(ends[:, 1] - ends[:, 0], moved[0], axis=1)
            is_ring = model.analysis == "axisymmetric"
            width = 2.0 * np.pi * ends[:, :, 0].mean(axis=1) if is_ring else np.full(len(edges), thickness)
            area = float((np.linalg.norm(span, axis=1) * width).sum())
            body = next(b for b in model.bodies or (whole,) if edges[0, 0] in b.points)
            along = mesh.points[body.points.start : body.points.stop, moved[0]]
            side = 1.0 if 2.0 * ends[:, :, moved[0]].mean() > along.min() + along.max() else -1.0
            if area > 0.0:
                found[f"gauge_{holder.name}"] = np.array([area, float(np.ptp(along)), side])
        return found


def _quantities(holder: Holder) -> list[str]:
    """Return the history's quantities of a holder: its components that are held at all, and those that are moved."""
    held: BoolArray = np.atleast_1d(holder.held.any(axis=0))
    names = [f"force_{axis}" for axis, is_held in zip(AXES, held[:3], strict=False) if is_held]
    names += [f"moment_{axis}" for axis, is_held in zip(AXES, held[3:], strict=False) if is_held]
    names += [f"displacement_{axis}" for axis, is_moved in zip(AXES, holder.moved[:3], strict=False) if is_moved]
    return names + [f"rotation_{axis}" for axis, is_moved in zip(AXES, holder.moved[3:], strict=False) if is_moved]


def _gauge_faces(mesh: Mesh, holder: Holder, axis: int) -> FloatArray | None:
    """Return the gauge of a set on the surface of a solid in space that moves along an axis, as in Reactions.gauges."""
    faces = select_faces(mesh.boundary_faces, mesh.node_sets[holder.node_set])
    if not len(faces):
        return None
    x = mesh.points[take_corners(faces)]
    normal = 0.5 * np.cross(x[:, 2] - x[:, 0], x[:, -1] - x[:, 1])
    along = mesh.points[:, axis]
    side = 1.0 if 2.0 * x[..., axis].mean() > along.min() + along.max() else -1.0
    area = float(np.abs(normal[:, axis]).sum())
    return np.array([area, float(np.ptp(along)), side]) if area > 0.0 else None


def _edges_within(mesh: Mesh, nodes: IntArray) -> IntArray:
    """Return the boundary edges whose nodes are all in a set."""
    inside = np.zeros(len(mesh.points), dtype=bool)
    inside[nodes] = True
    edges = mesh.boundary_edges
    return np.asarray(edges[inside[edges].all(axis=1)])
