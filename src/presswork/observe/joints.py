# SPDX-License-Identifier: Apache-2.0
"""Joints by forming: what holds two sheets together that a punch presses into a die (clinching).

In axisymmetry, with the sheet on the punch's side above: its lower face runs from the axis outwards. Where it runs back
towards the axis, the other sheet lies over it. The interlock is the largest way back, the neck the least thickness of
the wall, which is where the face is steeper than 45 degrees, the bottom the thickness of both sheets on the axis.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from presswork.mesh.topology import chain_edges, halve_edges
from presswork.model import FloatArray, IntArray, Model
from presswork.observe.contract import History, Observed, Observer, Row

ON_AXIS = 1e-6
"""Distance from the axis over the radius of a sheet, within which a node is on it."""
NEAR_RIM = 0.02
"""Distance from the largest radius over it, within which the corners of a rim lie."""
QUANTITIES = ("interlock", "neck", "bottom")


@dataclass(frozen=True)
class Joint:
    """Sizes of a joint [mm]."""

    interlock: float
    neck: float
    bottom: float


class Joints(Observer):
    """The joints of a model: contacts of two sheets that are asked for."""

    def __init__(self, model: Model) -> None:
        self._pairs = [(contact.name, contact.between) for contact in model.contacts if contact.joint]

    def columns(self, run: Observed) -> list[str]:
        """Return three for each joint [mm]."""
        return [f"{name}.{quantity}" for name, _ in self._pairs for quantity in QUANTITIES]

    def row(self, run: Observed, *, is_released: bool = False) -> Row:
        """Return interlock, neck and bottom of each joint."""
        return {
            f"{name}.{quantity}": getattr(joint, quantity)
            for name, joint in self._measure(run)
            for quantity in QUANTITIES
        }

    def summary(self, run: Observed, history: History) -> dict[str, Any]:
        """Return interlock, neck and bottom of each joint."""
        found = {
            name: {f"{each}_mm": getattr(joint, each) for each in QUANTITIES} for name, joint in self._measure(run)
        }
        return {"joints": found} if found else {}

    def warnings(self, run: Observed, history: History) -> list[str]:
        """Return the joints that nothing holds together."""
        return [
            f"the joint {name} has no interlock: the sheets come apart; press further, or deepen the die's groove"
            for name, joint in self._measure(run)
            if joint.interlock <= 0.0
        ]

    def _measure(self, run: Observed) -> Iterator[tuple[str, Joint]]:
        if not self._pairs:
            return
        edges, now = halve_edges(run.mesh.boundary_edges), run.positions()
        for name, pair in self._pairs:
            bodies = [run.model.bodies[number] for number in pair]
            loops = [now[chain_edges(edges[body.owns(edges)], now)[:, 0]] for body in bodies]
            yield name, measure_joint(*loops)


def measure_joint(first: FloatArray, second: FloatArray) -> Joint:
    """Return the sizes of the joint of two sheets.

    first, second: their outlines from the axis x = 0 outwards, closed, the metal on their left (n, 2) [mm].
    """
    upper, lower = sorted((first, second), key=lambda loop: -float(loop[_on_axis(loop), 1].mean()))
    face, back = _split_faces(upper)
    if face[0, 1] > face[-1, 1]:  # the punch comes from below
        upper, lower = _mirror(lower), _mirror(upper)
        face, back = _split_faces(upper)
    along = np.diff(face, axis=0)
    steep = np.abs(along[:, 1]) > np.abs(along[:, 0])
    middles = 0.5 * (face[1:] + face[:-1])
    neck = _find_distance(middles[steep] if steep.any() else middles, back)
    interlock = (np.maximum.accumulate(face[:, 0]) - face[:, 0]).max()
    return Joint(float(interlock), neck, _find_bottom(upper) + _find_bottom(lower))


def _on_axis(loop: FloatArray) -> IntArray:
    return np.flatnonzero(loop[:, 0] < ON_AXIS * loop[:, 0].max()).astype(np.int32)


def _find_bottom(loop: FloatArray) -> float:
    """Return the thickness of a sheet on the axis."""
    return float(np.ptp(loop[_on_axis(loop), 1]))


def _split_faces(loop: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the lower face of a sheet from the axis to the corner of its rim, and the upper one back."""
    axis = _on_axis(loop)
    loop = np.roll(loop, -int(axis[np.argmin(loop[axis, 1])]), axis=0)
    x, y = loop.T
    rim = x > x.max() * (1.0 - NEAR_RIM)
    corners = [int(np.argmax(np.where(rim, x + side * y, -np.inf))) for side in (-1.0, 1.0)]
    end = int(_on_axis(loop)[1])  # the first one that is met again
    return loop[: corners[0] + 1], loop[corners[1] : end + 1]


def _find_distance(places: FloatArray, line: FloatArray) -> float:
    """Return the least distance of places (n, 2) from a line (m, 2) [mm]."""
    start, along = line[:-1], np.diff(line, axis=0)
    away = places[:, None] - start
    part = np.clip((away * along).sum(axis=2) / np.maximum((along**2).sum(axis=1), 1e-300), 0.0, 1.0)
    return float(np.linalg.norm(away - part[:, :, None] * along, axis=2).min())


def _mirror(loop: FloatArray) -> FloatArray:
    """Return an outline upside down, the metal on its left again."""
    return np.asarray((loop * (1.0, -1.0))[::-1])
