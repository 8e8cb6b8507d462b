# SPDX-License-Identifier: Apache-2.0
"""The fields of the results: a row for each quantity, the same row for every procedure that has the quantity.

A cell's value is the mean of its integration points, weighted by their volume. In a sheet the layers have tensors; a
single number for a whole cell is that of the layer where it is largest.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from presswork.evolution.of_material import BY_NAME, QUANTITIES
from presswork.fields.evolved_layers import best_of_layers
from presswork.fields.field import LAMINA, PLACES, TENSOR, VECTOR, Field
from presswork.fields.instant import Instant, NodalContact
from presswork.fields.solid_fields import effective_stress
from presswork.fields.surface_defects import SURFACE_FIELDS
from presswork.law.history import DEFORMATION_GRADIENT, POROSITY
from presswork.model import GTN, FloatArray


def _to_space(vectors: FloatArray | None) -> FloatArray | None:
    """Return vectors (n, 2 | 3) with three components."""
    if vectors is None:
        return None
    return np.column_stack([vectors, np.zeros((len(vectors), 3 - vectors.shape[1]))])


def _contact_force(now: Instant) -> FloatArray | None:
    return now.contact.force if now.contact else _to_space(now.tool_force)


def _reaction_force(now: Instant) -> FloatArray | None:
    return None if now.reaction is None else _to_space(now.reaction[:, :3])


def _reaction_moment(now: Instant) -> FloatArray | None:
    return now.reaction[:, 3:].copy() if now.reaction is not None and now.reaction.shape[1] == 6 else None


def _of_contact(find: Callable[[NodalContact], FloatArray]) -> Callable[[Instant], FloatArray | None]:
    return lambda now: find(now.contact) if now.contact else None


def _traction_of_tools(now: Instant) -> Mapping[str, FloatArray] | None:
    """Return the traction of each tool; of a single one, contact_traction is that."""
    return now.contact.traction if now.contact and len(now.contact.traction) > 1 else None


def _of_sheet(name: str) -> Callable[[Instant], FloatArray | None]:
    return lambda now: now.sheet.get(name)


def _of_layers(name: str) -> Callable[[Instant], Mapping[str, FloatArray] | None]:
    def find(now: Instant) -> Mapping[str, FloatArray] | None:
        found = {place: now.sheet[f"{name}_{place}"] for place in PLACES if f"{name}_{place}" in now.sheet}
        return found or None

    return find


def _of_forming(name: str) -> Callable[[Instant], FloatArray | None]:
    return lambda now: now.forming.get(name)


def _of_surface(name: str) -> Callable[[Instant], FloatArray | None]:
    return lambda now: now.surface.get(name)


def _weights(now: Instant) -> list[FloatArray]:
    """Return the part of every integration point in its cell's mean, blocks of (n_cells, q)."""
    assert now.points is not None
    return [volume / volume.sum(axis=1, keepdims=True) for volume in now.points.volume]


def _mean_stress(now: Instant) -> list[FloatArray]:
    """Return the mean stress of the cells, blocks of (n_cells, 4 | 6) [MPa]."""
    assert now.points is not None
    each = zip(_weights(now), now.points.stress, strict=True)
    return [np.einsum("cq,cqi->ci", weight, stress) for weight, stress in each]


def _equivalent_plastic_strain(now: Instant) -> FloatArray | None:
    if now.points is None:
        return now.sheet.get("equivalent_plastic_strain")
    each = zip(_weights(now), now.points.eqps, strict=True)
    return np.concatenate([(weight * eqps).sum(axis=1) for weight, eqps in each])


def _effective_stress(now: Instant) -> FloatArray | None:
    if now.points is None:
        return now.sheet.get("effective_stress")
    each = zip(_weights(now), now.points.stress, strict=True)
    return np.concatenate([(weight * effective_stress(stress)).sum(axis=1) for weight, stress in each])


def _stress(now: Instant) -> FloatArray | None:
    if now.points is None:
        return None
    return np.concatenate([np.column_stack([s, np.zeros((len(s), 6 - s.shape[1]))]) for s in _mean_stress(now)])


def _hydrostatic_stress(now: Instant) -> FloatArray | None:
    return None if now.points is None else np.concatenate([s[:, :3].mean(axis=1) for s in _mean_stress(now)])


def _temperature(now: Instant) -> FloatArray | None:
    if (nodal := now.temperature) is not None:
        return _in_cells(now, nodal)
    return now.sheet.get("temperature") if now.points is None else now.points.temperature


def _temperature_of_layers(now: Instant) -> Mapping[str, FloatArray] | None:
    found = {place: now.heated[f"temperature_{place}"] for place in PLACES if f"temperature_{place}" in now.heated}
    return {place: _in_cells(now, nodal) for place, nodal in found.items()} or None


def _in_cells(now: Instant, nodal: FloatArray) -> FloatArray:
    """Return the means of the cells (n_cells,) of nodal values."""
    return np.concatenate([nodal[block.connectivity].mean(axis=1) for block in now.model.mesh.blocks])


def _state_variables(now: Instant) -> Mapping[str, FloatArray] | None:
    """Return the means of UMATs' state variables, from 1 on; zero in cells of other laws."""
    if now.points is None:
        of_sheet = now.sheet.get("state_variables")
        return None if of_sheet is None else {str(i + 1): column for i, column in enumerate(of_sheet.T)}
    if not now.points.user:
        return None
    umats = [now.model.materials[block.material].umat for block in now.model.mesh.blocks]
    numbers = [umat.n_state if umat and umat.library != GTN else 0 for umat in umats]
    parts = []
    for n, history, kept, weight in zip(numbers, now.points.user, now.points.kept, _weights(now), strict=True):
        mean = np.zeros((len(history), max(numbers)))
        first = kept[DEFORMATION_GRADIENT].start - n if n else 0
        mean[:, :n] = np.einsum("cq,cqi->ci", weight, history[..., first : first + n])
        parts.append(mean)
    return {str(i + 1): np.concatenate([part[:, i] for part in parts]) for i in range(max(numbers))} or None


def _evolved(name: str) -> Callable[[Instant], FloatArray | None]:
    """Return what finds a quantity of evolution laws: the mean of a solid's points or of a sheet's layers, of layers
    the largest where it decides.

    Those of a sheet that conducts heat are at the nodes: the mean of the cell.
    """

    def find(now: Instant) -> FloatArray | None:
        if name in now.heated:
            return _in_cells(now, now.heated[name])
        if name not in now.evolved:
            return None
        blocks, of_mesh = now.evolved[name], now.model.mesh.blocks
        if BY_NAME[name].all_layers:
            return best_of_layers(of_mesh, blocks)
        weights: Sequence[FloatArray | None] = [None] * len(of_mesh) if now.points is None else _weights(now)
        parts = []
        for values, weight, block in zip(blocks, weights, of_mesh, strict=True):
            if len(values) == 0:
                parts.append(np.full(len(block.connectivity), np.nan))
            else:
                of_layers = values.max(axis=1) if BY_NAME[name].peak_counts else values.mean(axis=1)
                parts.append(of_layers if weight is None else (weight * values).sum(axis=1))
        return np.concatenate(parts)

    return find


def _porosity(now: Instant) -> FloatArray | None:
    """Return the porosity; NaN in cells of dense metal."""
    if now.points is None or not now.points.user:
        return None
    pores = [now.model.materials[block.material].gtn is not None for block in now.model.mesh.blocks]
    if not any(pores):
        return None
    each = zip(pores, now.points.user, now.points.kept, _weights(now), strict=True)
    parts = [
        (w * kept.of(POROSITY, user)).sum(axis=1) if has else np.full(len(w), np.nan) for has, user, kept, w in each
    ]
    return np.concatenate(parts)


def _body(now: Instant) -> FloatArray | None:
    if now.points is None or len(now.model.bodies) < 2:
        return None
    n_cells = [len(block.connectivity) for block in now.model.mesh.blocks]
    bodies = enumerate(now.model.bodies)
    return np.concatenate([np.full(n_cells[b], float(i)) for i, body in bodies for b in body.blocks])


def _zone(now: Instant) -> FloatArray | None:
    """Return the zone of a welded blank that each cell belongs to; 0 beside all of them."""
    if not getattr(now.model, "zones", ()):  # one step has a model of its own
        return None
    return np.concatenate([np.full(len(block.connectivity), float(block.zone)) for block in now.model.mesh.blocks])


ROWS = (
    Field("displacement", "mm", "point", lambda now: _to_space(now.displacement), components=VECTOR, alias="u"),
    Field("initial_position", "mm", "point", lambda now: _to_space(now.initial_position), components=VECTOR),
    Field("velocity", "mm/s", "point", lambda now: _to_space(now.velocity), components=VECTOR),
    Field("gap", "mm", "point", _of_contact(lambda c: c.gap)),
    Field("contact_status", "1", "point", _of_contact(lambda c: c.status)),
    Field("contact_pressure", "MPa", "point", _of_contact(lambda c: c.pressure)),
    Field("contact_shear", "MPa", "point", _of_contact(lambda c: c.shear)),
    Field("contact_traction", "MPa", "point", _of_contact(lambda c: c.total_traction), components=VECTOR),
    Field("contact_traction_{}", "MPa", "point", _traction_of_tools, "tool", components=VECTOR),
    Field("friction_limit", "MPa", "point", _of_contact(lambda c: c.friction_limit)),
    Field("reaction_force", "N", "point", _reaction_force, components=VECTOR),
    Field("reaction_moment", "N mm", "point", _reaction_moment, components=VECTOR),
    Field("contact_force", "N", "point", _contact_force, components=VECTOR),
    Field("lap", "1", "point", lambda now: now.laps),
    Field("springback", "mm", "point", lambda now: now.springback, components=VECTOR),
    Field("deviation", "mm", "point", lambda now: now.deviation),
    Field("nodal_temperature", "degrees C", "point", lambda now: now.temperature, label="temperature"),
    Field("thickness", "mm", "cell", _of_sheet("thickness")),
    Field("thickness_strain", "1", "cell", _of_sheet("thickness_strain")),
    Field("equivalent_plastic_strain", "1", "cell", _equivalent_plastic_strain, alias="eqps"),
    Field("effective_stress", "MPa", "cell", _effective_stress, alias="mises"),
    Field("stress", "MPa", "cell", _stress, components=TENSOR),
    Field("hydrostatic_stress", "MPa", "cell", _hydrostatic_stress),
    Field("temperature", "degrees C", "cell", _temperature),
    *(Field(q.name, q.unit, "cell", _evolved(q.name), label=q.label) for q in QUANTITIES if q.shown),
    Field("porosity", "1", "cell", _porosity),
    Field("temperature_{}", "degrees C", "layer", _temperature_of_layers, "layer"),
    Field("SDV{}", "", "cell", _state_variables, "number"),
    Field("body", "1", "cell", _body),
    Field("zone", "1", "cell", _zone),
    Field("equivalent_plastic_strain_{}", "1", "layer", _of_layers("equivalent_plastic_strain"), "layer"),
    Field("effective_stress_{}", "MPa", "layer", _of_layers("effective_stress"), "layer"),
    Field("lamina_stress_{}", "MPa", "layer", _of_layers("lamina_stress"), "layer", LAMINA, single=True),
    Field("stress_{}", "MPa", "layer", _of_layers("stress"), "layer", TENSOR, single=True),
    Field("strain_{}", "1", "layer", _of_layers("strain"), "layer", TENSOR, single=True),
    Field("lamina_strain_{}", "1", "layer", _of_layers("lamina_strain"), "layer", LAMINA, single=True),
    Field("major_strain_{}", "1", "layer", _of_layers("major_strain"), "layer"),
    Field("minor_strain_{}", "1", "layer", _of_layers("minor_strain"), "layer"),
    Field("back_stress_{}", "MPa", "layer", _of_layers("back_stress"), "layer", LAMINA, single=True),
    Field("thinning", "%", "cell", _of_forming("thinning")),
    Field("wrinkling_indicator", "1", "cell", _of_forming("wrinkling_indicator")),
    Field("forming_limit_margin", "1", "cell", _of_forming("forming_limit_margin")),
    Field("formability_zone", "1", "cell", _of_forming("formability_zone")),
    *(Field(name, "1", "cell", _of_surface(name)) for name in SURFACE_FIELDS),
)
