# SPDX-License-Identifier: Apache-2.0
"""Where material was at the start, carried through twenty meshes, against its exact path.

Two flows of the unit square whose paths are closed forms and which keep every area: it is twisted by
2 exp(-(r / 0.2)^2) rad, where r is the distance from its middle; and a band of half width w across it is squeezed to a
part 1 - a of its thickness, y = h(Y), x = X / h'(Y), h' = 1 - a exp(-((Y - 1/2) / w)^2), and so pressed out.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

import numpy as np
import pytest
from scipy.special import erf

from presswork.model import CellBlock, FloatArray, Mesh
from presswork.remesh.carrier import Carrier, Part, SurfacePlaces
from presswork.remesh.fill import fill_with_quadrilaterals
from presswork.remesh.transfer import interpolate_along

N_MESHES = 20
TWIST, REACH = 2.0, 0.2
THINNED, WIDTH = 0.4, 0.1

Flow = Callable[[FloatArray, float], FloatArray]


def twist(places: FloatArray, time: float) -> FloatArray:
    """Return where material is that was in places (n, 2); with -time the way back."""
    x, y = (places - 0.5).T
    angle = time * TWIST * np.exp(-(x**2 + y**2) / REACH**2)
    c, s = np.cos(angle), np.sin(angle)
    return 0.5 + np.column_stack([c * x - s * y, s * x + c * y])


def stretch(y: FloatArray, time: float) -> FloatArray:
    """Return h'."""
    return 1.0 - THINNED * time * np.exp(-(((y - 0.5) / WIDTH) ** 2))


def squeeze(places: FloatArray, time: float) -> FloatArray:
    """Return where material is that was in places (n, 2)."""
    x, y = places.T
    half = 0.5 * np.sqrt(np.pi) * WIDTH * (erf((y - 0.5) / WIDTH) + erf(0.5 / WIDTH))
    return np.column_stack([x / stretch(y, time), y - THINNED * time * half])


def squeeze_back(places: FloatArray, time: float) -> FloatArray:
    """Return where material was that is in places (n, 2)."""
    y = places[:, 1].copy()
    for _ in range(50):
        y -= (squeeze(np.column_stack([y, y]), time)[:, 1] - places[:, 1]) / stretch(y, time)
    return np.column_stack([places[:, 0] * stretch(y, time), y])


def mesh_square(flow: Flow, time: float, size: float, seed: int) -> tuple[FloatArray, FloatArray, int]:
    """Return a mesh of the square as the flow has made it, inner nodes shaken, and how many are on its boundary."""
    random = np.random.default_rng(seed)
    size *= random.uniform(0.93, 1.07)
    corners = np.array([[0, 0], [1, 0], [1, 1], [0, 1], [0, 0]], dtype=float)
    sides = []
    for a, b in pairwise(corners):
        fine = np.linspace(0.0, 1.0, 2001)
        way = flow(a + fine[:, None] * (b - a), time)
        arc = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(way, axis=0), axis=1))])
        n = 2 * max(1, round(arc[-1] / size / 2))
        sides.append(flow(a + np.interp(np.arange(n) / n * arc[-1], arc, fine)[:, None] * (b - a), time))
    line = np.concatenate(sides)
    points, cells = fill_with_quadrilaterals(line, lambda p: np.full(len(p), size))
    points[len(line) :] += size * random.uniform(-0.12, 0.12, (len(points) - len(line), 2))
    return points, cells, len(line)


def find_places(old: FloatArray, new: FloatArray) -> SurfacePlaces:
    """Return where nodes of a new boundary lie on the old one, both closed lines of nodes in order."""
    n, along = len(old), np.roll(old, -1, axis=0) - old
    part = np.clip(((new[:, None] - old) * along).sum(axis=2) / (along**2).sum(axis=1), 0.0, 1.0)
    side = np.linalg.norm(old + part[..., None] * along - new[:, None], axis=2).argmin(axis=1)
    return SurfacePlaces(
        np.arange(len(new)), side, (side + 1) % n, part[np.arange(len(new)), side], (side - 1) % n, (side + 2) % n
    )


def measure_drift(flow: Flow, back: Flow, size: float) -> dict[str, FloatArray]:
    """Return how far the place carried along is from the true one at each node of the last mesh, in cells.

    By moving least squares, as runs do, and by the shape functions of the old cells.
    """
    points, cells, n_line = mesh_square(flow, 0.0, size, 0)
    carried = {"least squares": points.copy(), "shape functions": points.copy()}
    none = np.zeros((0, 2), dtype=np.int32)
    for number in range(1, N_MESHES + 1):
        before, now = (number - 1) / N_MESHES, number / N_MESHES
        moved = flow(back(points, before), now)
        new, new_cells, n_new = mesh_square(flow, now, size, number)
        blocks = [CellBlock("quad4_fbar", np.ascontiguousarray(c, dtype=np.int32), 0) for c in (cells, new_cells)]
        places = find_places(moved[:n_line], new[:n_new])
        old_mesh, new_mesh = (Mesh(p, (b,), {}, {}, none) for p, b in zip((points, new), blocks, strict=True))
        part = Part(range(len(points)), range(len(new)), 0, places)
        carrier = Carrier(old_mesh, moved, new_mesh, [part])
        carried = {
            "least squares": carrier.material(carried["least squares"]),
            "shape functions": carrier.motion(carried["shape functions"]),
        }
        points, cells, n_line = new, new_cells, n_new
    exact = back(points, 1.0)
    return {name: np.linalg.norm(found - exact, axis=1) / size for name, found in carried.items()}


@pytest.mark.parametrize(
    ("flow", "back", "size", "mean", "largest", "gain"),
    [
        (twist, lambda places, time: twist(places, -time), 0.05, 0.08, 0.35, 4.0),
        (twist, lambda places, time: twist(places, -time), 0.025, 0.012, 0.06, 15.0),
        (squeeze, squeeze_back, 0.05, 0.25, 1.3, 2.0),
        (squeeze, squeeze_back, 0.025, 0.12, 1.0, 4.0),
    ],
)
def test_twenty_meshes_keep_the_first_place_of_material(
    flow: Flow, back: Flow, size: float, mean: float, largest: float, gain: float
) -> None:
    """Drift in cells, root of the mean square and largest; shape functions drift several times as far."""
    drift = measure_drift(flow, back, size)
    means = {name: float(np.sqrt((values**2).mean())) for name, values in drift.items()}
    assert means["least squares"] < mean
    assert drift["least squares"].max() < largest
    assert means["shape functions"] > gain * means["least squares"]


def test_values_along_a_side_stay_even_linear_and_in_their_range() -> None:
    places = np.array([[[0.0, 0.0], [1.0, 0.0], [1.7, 0.0], [3.0, 0.0]]])
    part = np.array([0.3])
    even = interpolate_along(places, np.full((1, 4, 1), 0.1), part)
    assert even[0, 0] == 0.1
    linear = interpolate_along(places, 2.0 + 3.0 * places[..., :1], part)
    assert linear[0, 0] == pytest.approx(2.0 + 3.0 * 1.21, abs=1e-14)
    ends = 1.0 - np.abs(places[..., :1] - 1.0)  # linear on either side of the second place
    beside_kink = interpolate_along(places, ends, part)
    assert beside_kink[0, 0] == pytest.approx(1.0 - 0.21, abs=1e-14)
    step = interpolate_along(places, np.array([[[0.0], [0.1], [1.0], [1.0]]]), np.array([0.1]))
    assert 0.1 < step[0, 0] < 0.2
