# SPDX-License-Identifier: Apache-2.0
"""The saved fields of shells: stress and strain at the bottom, middle and top of the sheet, thickness.

Bottom and top are the outermost integration points, which lie on the faces with the Lobatto and Simpson rules; the
middle is the middle point, or the mean of the two beside it. The lamina frame turns with the material: its x is what
was x, laid into the sheet, its normal the cells'. Strains are logarithmic, from the undeformed to the
present metric of a layer, so they do not depend on the path; the top is where the cells' normals point.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from presswork.fields.field import PLACES
from presswork.law.elastic_plastic import back_stress, temperature
from presswork.law.history import History
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
    thickness: FloatArray
    """Thickness of the undeformed shells (n_cells,) [mm]."""
    layers: FloatArray
    """Positions in (-1, 1)."""
    material: Material | None = None
    """Whose back stresses are saved, if it has any."""

    @cached_property
    def start(self) -> tuple[FloatArray, FloatArray]:
        """Base vectors of the undeformed shells, as `base_vectors` returns them."""
        return self.base_vectors(self.points, self.director)

    def base_vectors(self, points: FloatArray, director: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the covariant base vectors of the mid-surface, and their change with height (2, 3, q, n_cells)."""
        return (
            differentiate(self.slopes, points[self.connectivity]),
            differentiate(self.slopes, director[self.director_of]),
        )


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
    """Temperature given from outside (n_cells, q k) [degrees C]; no rows where the material does not know of it."""
    kept: History
    """The parts of the history by name."""


def shell_cell_fields(
    now: FloatArray, director: FloatArray, geometry: list[ShellGeometry], layers: list[ShellLayers]
) -> dict[str, FloatArray]:
    """Return the cell means over the points in the plane, cells in the order of the blocks.

    now (n_points, 3) [mm] and director (n_directors, 3): where the nodes are, and their unit directors.
    """
    parts = [
        _block_fields(now, director, g, of_block)
        | _back_stress_fields(of_block, g)
        | temperature_field(g.material, of_block.kept, of_block.history, of_block.temperature)
        | state_variable_field(g.material, of_block.history)
        for g, of_block in zip(geometry, layers, strict=True)
    ]
    names = max(parts, key=len)  # not every block has back stresses and a temperature
    return {
        name: np.concatenate([p.get(name, np.zeros((len(p["thickness"]), *values.shape[1:]))) for p in parts])
        for name, values in names.items()
    }


def temperature_field(
    material: Material | None, kept: History, history: FloatArray, given: FloatArray | None = None
) -> dict[str, FloatArray]:
    """Return the temperature of the hottest layer [degrees C], if any; history: of a law (n_cells, q, k, n).

    given: temperatures from outside (n_cells, q k); None: that of the start.
    """
    if material is None or material.heating is None:
        return {}
    return {"temperature": temperature(material, kept, history, given).max(axis=2).mean(axis=1)}


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
        "thickness_strain": np.log(thickness / g.thickness[:, None]).mean(axis=1),
        "effective_stress": sheet_effective_stress(stress).max(axis=2).mean(axis=1),
        "equivalent_plastic_strain": eqps.max(axis=2).mean(axis=1),
    }
    surface, change = g.base_vectors(now, director)
    for place in PLACES:
        own = _points_at(place, k)
        position = float(g.layers[own].mean())
        lamina = np.ascontiguousarray(stress[:, :, own].mean(axis=2).T)
        base = surface + 0.5 * position * thickness.T * change
        frame = _lamina_frame(base, direction[:, :, own[0]].T)
        start = g.start[0] + 0.5 * position * g.thickness * g.start[1]
        images, strain, major, minor = _logarithmic_strain(start, base)
        fields |= {
            f"equivalent_plastic_strain_{place}": eqps[:, :, own].mean(axis=(1, 2)),
            f"effective_stress_{place}": sheet_effective_stress(lamina.T).mean(axis=1),
            f"lamina_stress_{place}": _mean(lamina) - squeezed.mean(axis=1)[:, None] * [1.0, 1.0, 0.0],
            f"stress_{place}": _mean(_to_global(lamina, frame))
            - squeezed.mean(axis=1)[:, None] * [1.0, 1.0, 1.0, 0.0, 0.0, 0.0],
            f"strain_{place}": _mean(_to_global(strain, images)),
            f"lamina_strain_{place}": _mean(_turn(strain, images, frame)),
            f"major_strain_{place}": major.mean(axis=0),
            f"minor_strain_{place}": minor.mean(axis=0),
        }
    return fields


def _mean(values: FloatArray) -> FloatArray:
    """Return the means over the points in the plane (n_cells, k) of tensors (k, q, n_cells)."""
    return np.ascontiguousarray(values.mean(axis=1).T)


def _points_at(place: str, k: int) -> list[int]:
    """Return the layers out of k that stand for a place."""
    return {"bottom": [0], "middle": sorted({(k - 1) // 2, k // 2}), "top": [k - 1]}[place]


def _back_stress_fields(of_block: ShellLayers, g: ShellGeometry) -> dict[str, FloatArray]:
    """Return the back stresses of a block, in the lamina frame, if its material has any."""
    if g.material is None or g.material.kinematic is None:
        return {}
    back = back_stress(of_block.kept, of_block.history, 3)
    return {f"back_stress_{p}": back[:, :, _points_at(p, len(g.layers))].mean(axis=(1, 2)) for p in PLACES}


def differentiate(slopes: FloatArray, values: FloatArray) -> FloatArray:
    """Return the derivatives (2, 3, q, n_cells) of vectors at the nodes (n_cells, n_nodes, 3).

    slopes: gradients of the shape functions at the points (q, n_nodes, 2).
    """
    by_node = np.ascontiguousarray(values.transpose(1, 2, 0))
    terms = zip(slopes.transpose(1, 2, 0)[..., None], by_node, strict=True)
    return np.asarray(sum(slope[:, None] * of_node[:, None] for slope, of_node in terms))


def dot(a: FloatArray, b: FloatArray) -> FloatArray:
    """Return the products of vectors (3, ...)."""
    return np.asarray(a[0] * b[0] + a[1] * b[1] + a[2] * b[2])


def cross(a: FloatArray, b: FloatArray) -> FloatArray:
    """Return the vector products of vectors (3, ...)."""
    return np.stack([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def _lamina_frame(base: FloatArray, direction: FloatArray) -> FloatArray:
    """Return the axes (2, 3, q, n_cells) of the lamina frame.

    direction (2, q, n_cells): the first base vector in it.
    """
    first = base[0] / np.sqrt(dot(base[0], base[0]))
    normal = cross(base[0], base[1])
    second = cross(normal / np.sqrt(dot(normal, normal)), first)
    c, s = direction
    return np.stack([c * first - s * second, s * first + c * second])


def _to_global(inside: FloatArray, axes: FloatArray) -> FloatArray:
    """Return xx, yy, zz, xy, yz, xz (6, q, n_cells) of tensors xx, yy, xy on two vectors (2, 3, q, n_cells)."""
    xx, yy, xy = inside
    a, b = axes
    along_a, along_b = xx * a + xy * b, xy * a + yy * b
    places = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2))
    return np.stack([along_a[i] * a[j] + along_b[i] * b[j] for i, j in places])


def _turn(inside: FloatArray, axes: FloatArray, frame: FloatArray) -> FloatArray:
    """Return the same tensors by xx, yy, xy in another frame of their plane."""
    xx, yy, xy = inside
    (p, q), (r, s) = ([dot(f, a) for a in axes] for f in frame)
    along_p, along_q = xx * p + xy * q, xy * p + yy * q
    return np.stack([along_p * p + along_q * q, xx * r * r + 2.0 * xy * r * s + yy * s * s, along_p * r + along_q * s])


def _logarithmic_strain(start: FloatArray, now: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Return the strain in the present directions, and its larger and smaller principal value.

    start, now: base vectors (2, 3, q, n_cells). The strain is xx, yy, xy (3, q, n_cells) on the two present images of
    orthogonal unit vectors, which come first (2, 3, q, n_cells): ln V = sum of ln(l) F v (F v)^T/l^2, with l and v the
    principal stretches and directions of F^T F.
    """
    # 1. images F of the unit vectors that Gram and Schmidt's method makes of the base vectors
    size = np.sqrt(dot(start[0], start[0]))
    along = dot(start[0], start[1]) / size
    across = np.sqrt(dot(start[1], start[1]) - along**2)
    first = now[0] / size
    images = np.stack([first, (now[1] - along * first) / across])
    # 2. principal stretches squared, of two directions
    xx, yy, xy = dot(images[0], images[0]), dot(images[1], images[1]), dot(images[0], images[1])
    half, radius = 0.5 * (xx - yy), np.hypot(0.5 * (xx - yy), xy)
    mean = 0.5 * (xx + yy)
    squares = np.stack([mean + radius, mean - radius])
    principal = 0.5 * np.log(squares)
    # 3. the strain on the images: sum of ln(l)/l^2 v v^T
    weights = principal / squares
    even, odd = 0.5 * (weights[0] + weights[1]), 0.5 * (weights[0] - weights[1])
    turned = np.divide(odd, radius, out=np.zeros_like(odd), where=radius > 0.0)
    strain = np.stack([even + turned * half, even - turned * half, turned * xy])
    return images, strain, principal[0], principal[1]
