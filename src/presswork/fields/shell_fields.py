# SPDX-License-Identifier: Apache-2.0
"""The saved fields of shells: stress and strain at the bottom, middle and top of the sheet, thickness.

Bottom and top are the outermost integration points, which lie on the faces with the Lobatto and Simpson rules; the
middle is the middle point, or the mean of the two beside it. The lamina frame turns with the material: its x is what
was x, laid into the sheet, its normal the cells'. Strains are logarithmic, from the undeformed to the
present metric of a layer, so they do not depend on the path; the top is where the cells' normals point.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from presswork.fields.field import PLACES
from presswork.law.elastic_plastic import back_stress, temperature
from presswork.model import FloatArray, IntArray, Material


@dataclass(frozen=True)
class ShellGeometry:
    """Data of one block that its fields need besides its layers."""

    connectivity: IntArray
    director_of: IntArray
    slopes: FloatArray
    """Gradients of the shape functions at the points (q, n_nodes, 2)."""
    points: FloatArray
    """Undeformed (n_points, 3)."""
    director: FloatArray
    """Undeformed (n_directors, 3)."""
    thickness: float
    layers: FloatArray
    """Positions in (-1, 1)."""
    material: Material | None = None
    """Whose back stresses are saved, if it has any."""

    def base_vectors(self, points: FloatArray, director: FloatArray, z: FloatArray) -> FloatArray:
        """Return the two covariant base vectors at heights z (n_cells, q) (n_cells, q, 2, 3)."""
        a = np.einsum("qaj,cai->cqji", self.slopes, points[self.connectivity])
        b = np.einsum("qaj,cai->cqji", self.slopes, director[self.director_of])
        vectors: FloatArray = a + z[..., None, None] * b
        return vectors


@dataclass(frozen=True)
class ShellLayers:
    """What one block of shells has at q points in the plane and k layers."""

    thickness: FloatArray
    """(n_cells, q) [mm]."""
    direction: FloatArray
    """First base vector in the frame of the stress (n_cells, q, k, 2)."""
    stress: FloatArray
    """xx, yy, xy (n_cells, q k, 3) [MPa]."""
    eqps: FloatArray
    """(n_cells, q k)."""
    history: FloatArray
    """What the law keeps (n_cells, q, k, n_history)."""
    temperature: FloatArray
    """Given from outside (n_cells, q k) [degrees C]; no rows where the material does not know of it."""


def shell_cell_fields(
    now: FloatArray, director: FloatArray, geometry: list[ShellGeometry], layers: list[ShellLayers]
) -> dict[str, FloatArray]:
    """Return the cell means over the points in the plane, cells in the order of the blocks.

    now (n_points, 3) [mm] and director (n_directors, 3): where the nodes are, and their unit directors.
    """
    parts = [
        _block_fields(now, director, g, of_block)
        | _back_stress_fields(of_block.history, g)
        | temperature_field(g.material, of_block.history, of_block.temperature)
        | state_variable_field(g.material, of_block.history)
        for g, of_block in zip(geometry, layers, strict=True)
    ]
    names = max(parts, key=len)  # not every block has back stresses and a temperature
    return {
        name: np.concatenate([p.get(name, np.zeros((len(p["thickness"]), *values.shape[1:]))) for p in parts])
        for name, values in names.items()
    }


def temperature_field(
    material: Material | None, history: FloatArray, given: FloatArray | None = None
) -> dict[str, FloatArray]:
    """Return the temperature of the hottest layer [degrees C], if any; history: of a law (n_cells, q, k, n).

    given: temperatures from outside (n_cells, q k); None: that of the start.
    """
    if material is None or material.heating is None:
        return {}
    return {"temperature": temperature(material, history, given).max(axis=2).mean(axis=1)}


def state_variable_field(material: Material | None, history: FloatArray) -> dict[str, FloatArray]:
    """Return the means of a UMAT's state variables (n_cells, n), if any; history: of layers (n_cells, q, k, m)."""
    if material is None or material.umat is None or material.umat.n_state == 0:
        return {}
    return {"state_variables": history[..., 1 : 1 + material.umat.n_state].mean(axis=(1, 2))}


def sheet_effective_stress(stress: FloatArray) -> FloatArray:
    """Return the von Mises stress of xx, yy, xy in plane stress (..., 3)."""
    xx, yy, xy = np.moveaxis(stress, -1, 0)
    return np.asarray(np.sqrt(xx**2 - xx * yy + yy**2 + 3 * xy**2))


def _block_fields(
    now: FloatArray, director: FloatArray, g: ShellGeometry, layers: ShellLayers
) -> dict[str, FloatArray]:
    stress = layers.stress.reshape(len(g.connectivity), -1, len(g.layers), 3)
    eqps = layers.eqps.reshape(stress.shape[:3])
    return layer_fields(g, now, director, layers.thickness, layers.direction, stress, eqps)


def layer_fields(
    g: ShellGeometry,
    now: FloatArray,
    director: FloatArray,
    thickness: FloatArray,
    direction: FloatArray,
    stress: FloatArray,
    eqps: FloatArray,
    pressure: FloatArray | None = None,
) -> dict[str, FloatArray]:
    """Return the cell means of one block of shells.

    now (n_points, 3) and director (n_directors, 3): where the nodes are, and their unit directors. thickness (n_cells,
    q) [mm]; direction (n_cells, q, k, 2): the first base vector in the frame of the stress; stress xx, yy, xy
    (n_cells, q, k, 3) [MPa]; eqps (n_cells, q, k). pressure (n_cells, q) [MPa] of tools that squeeze the sheet: stress
    is then what flows, with the pressure added to xx and yy.
    """
    k = len(g.layers)
    squeezed = np.zeros(thickness.shape) if pressure is None else pressure
    fields = {
        "thickness": thickness.mean(axis=1),
        "thickness_strain": np.log(thickness / g.thickness).mean(axis=1),
        "effective_stress": sheet_effective_stress(stress).max(axis=2).mean(axis=1),
        "equivalent_plastic_strain": eqps.max(axis=2).mean(axis=1),
    }
    for place in PLACES:
        own = _points_at(place, k)
        position = float(g.layers[own].mean())
        lamina = stress[:, :, own].mean(axis=2)
        base = g.base_vectors(now, director, 0.5 * position * thickness)
        frame = _lamina_frame(base, direction[:, :, own[0]])
        start = g.base_vectors(g.points, g.director, np.full_like(thickness, 0.5 * position * g.thickness))
        strain, major, minor = _logarithmic_strain(start, base)
        fields |= {
            f"equivalent_plastic_strain_{place}": eqps[:, :, own].mean(axis=(1, 2)),
            f"effective_stress_{place}": sheet_effective_stress(lamina).mean(axis=1),
            f"lamina_stress_{place}": (lamina - squeezed[..., None] * [1.0, 1.0, 0.0]).mean(axis=1),
            f"stress_{place}": (_to_global(frame, lamina) - squeezed[..., None] * [1.0, 1.0, 1.0, 0.0, 0.0, 0.0]).mean(
                axis=1
            ),
            f"strain_{place}": _voigt(strain).mean(axis=1),
            f"lamina_strain_{place}": _in_frame(frame, strain).mean(axis=1),
            f"major_strain_{place}": major.mean(axis=1),
            f"minor_strain_{place}": minor.mean(axis=1),
        }
    return fields


def _points_at(place: str, k: int) -> list[int]:
    """Return the layers out of k that stand for a place."""
    return {"bottom": [0], "middle": sorted({(k - 1) // 2, k // 2}), "top": [k - 1]}[place]


def _back_stress_fields(history: FloatArray, g: ShellGeometry) -> dict[str, FloatArray]:
    """Return the back stresses of a block, in the lamina frame, if its material has any."""
    if g.material is None or g.material.kinematic is None:
        return {}
    back = back_stress(g.material, history, 3)
    return {f"back_stress_{p}": back[:, :, _points_at(p, len(g.layers))].mean(axis=(1, 2)) for p in PLACES}


def _lamina_frame(base: FloatArray, direction: FloatArray) -> FloatArray:
    """Return the axes (n_cells, q, 2, 3) of the lamina frame: `direction` is g_1 in it."""
    first = base[:, :, 0] / np.linalg.norm(base[:, :, 0], axis=2, keepdims=True)
    normal = np.cross(base[:, :, 0], base[:, :, 1])
    normal /= np.linalg.norm(normal, axis=2, keepdims=True)
    second = np.cross(normal, first)
    c, s = direction[..., :1], direction[..., 1:]
    return np.stack([c * first - s * second, s * first + c * second], axis=2)


def _to_global(frame: FloatArray, lamina: FloatArray) -> FloatArray:
    """Return xx, yy, zz, xy, yz, xz (n_cells, q, 6) of stresses xx, yy, xy in the frame."""
    inner = np.empty((*lamina.shape[:2], 2, 2))
    inner[..., 0, 0], inner[..., 1, 1] = lamina[..., 0], lamina[..., 1]
    inner[..., 0, 1] = inner[..., 1, 0] = lamina[..., 2]
    return _voigt(np.einsum("cqai,cqab,cqbj->cqij", frame, inner, frame))


def _in_frame(frame: FloatArray, tensor: FloatArray) -> FloatArray:
    """Return xx, yy, xy (n_cells, q, 3) in the frame (n_cells, q, 2, 3) of tensors (n_cells, q, 3, 3)."""
    own = np.einsum("cqai,cqij,cqbj->cqab", frame, tensor, frame)
    return np.stack([own[..., 0, 0], own[..., 1, 1], own[..., 0, 1]], axis=-1)


def _voigt(tensor: FloatArray) -> FloatArray:
    """Return xx, yy, zz, xy, yz, xz of symmetric tensors (..., 3, 3)."""
    return np.stack([tensor[..., i, j] for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2))], axis=-1)


def _logarithmic_strain(start: FloatArray, now: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the strain in the present directions (n_cells, q, 3, 3), and its larger and smaller principal value."""
    before = np.einsum("cqai,cqbi->cqab", start, start)
    after = np.einsum("cqai,cqbi->cqab", now, now)
    # after = F^T F in covariant components: b = F F^T has the same principal stretches, along m = now^i v_i
    lower = np.linalg.cholesky(before)
    inverse = np.linalg.inv(lower)
    square = np.einsum("cqab,cqbd,cqed->cqae", inverse, after, inverse)
    values, vectors = np.linalg.eigh(square)
    principal = 0.5 * np.log(values)
    material = np.einsum("cqba,cqbk->cqak", inverse, vectors)  # contravariant components of the material directions
    along = np.einsum("cqak,cqai->cqki", material, now)
    along /= np.linalg.norm(along, axis=3, keepdims=True)
    strain = np.einsum("cqk,cqki,cqkj->cqij", principal, along, along)
    return strain, principal[..., 1], principal[..., 0]
