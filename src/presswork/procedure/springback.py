# SPDX-License-Identifier: Apache-2.0
"""Springback: a formed sheet is let go, and the implicit procedure finds where it comes to rest.

The tools are gone; what they and inertia held fades over a few increments (transfer.py). Only symmetry planes stay, and
as many freedoms of three nodes as rigid motions are left: such supports bear no force, so they leave the shape alone
and only choose from where it is seen. The first node lies in the middle of the blank, the other two near it along x
and y, so that the bottom of a part stays where it is and its walls and flange move.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswork.mesh.checks import MeshError
from presswork.model import FloatArray, Model, OutputSettings, ShellElement, SolverSettings, Stage, Support
from presswork.model_stamping import StampingModel
from presswork.procedure.explicit import EnergyBalance
from presswork.procedure.implicit import CUTBACKS, INCREMENTS, ITERATIONS, ImplicitProcedure, IncrementReport
from presswork.procedure.recording import GaveUpError, Row, Snapshot, StartError
from presswork.procedure.stamping import ENERGIES, ExplicitStamping, RowReport
from presswork.procedure.transfer import TransferError, carry_to_implicit
from presswork.results.formability import formability_fields

NAME = "springback"
ELEMENT: ShellElement = "shell4_mitc_plus"
APART = 0.2
"""Least distance of the nodes that hold the sheet, over the blank's length and width."""
_KEPT = ("cycles", "time_step", "added_mass_percent", "energy_error_percent", *(f"{e}_energy" for e in ENERGIES[1:]))
"""Columns that stay as they were when forming ended; kinetic energy is none."""
SHARE = 0.03
"""Of the whole process that springback counts as in the progress display."""


@dataclass(frozen=True)
class SpringbackReport:
    """An increment of springback."""

    number: int
    """Rows of the stamping included."""
    time: float
    increment: IncrementReport
    is_save_point: bool


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


def make_springback_model(model: StampingModel) -> Model:
    """Return the Model of the released sheet."""
    assert model.springback is not None
    planes = [s for s in model.supports if s.node_set in ("symmetry_x", "symmetry_y")]
    block = replace(model.mesh.blocks[0], element=ELEMENT)
    node_sets = dict(model.mesh.node_sets)
    supports = list(planes)
    for node, fixed in hold_rigidly(model.mesh.points, model.symmetry).items():
        name = f"held_{node}"
        node_sets[name] = np.array([node], dtype=np.int32)
        supports.append(Support(name, (*fixed, False, False, False)))
    size = 1.0 / model.springback.increments
    return Model(
        title=model.title,
        analysis="shell",
        depth=1.0,
        mesh=replace(model.mesh, blocks=(block,), node_sets=node_sets),
        materials=model.materials,
        tools=(),
        supports=tuple(supports),
        stages=(Stage(NAME, duration=model.stages[-1].duration),),
        solver=SolverSettings(initial_increment=size, max_increment=size),
        output=OutputSettings(steps=1),
    )


class StampingWithSpringback(ExplicitStamping):
    """A stamping by explicit dynamics, after which the part springs back."""

    def __init__(self, model: StampingModel, *, threads: int = 0) -> None:
        super().__init__(model, threads=threads)
        self._threads = threads
        self._implicit: ImplicitProcedure | None = None
        self._elastic = 0.0
        self._formed: FloatArray = np.zeros((0, 3))

    def advance(self) -> Iterator[RowReport | SpringbackReport]:  # type: ignore[override]
        """Form the part row after row, then let it go. Raises GaveUpError."""
        yield from super().advance()
        implicit = self._release() if self._implicit is None else self._implicit
        before = super().number
        for report in implicit.advance():
            yield SpringbackReport(before + report.number, self.shells.time + report.time, report, report.is_save_point)

    def _release(self) -> ImplicitProcedure:
        """Take the tools away: hand the state over to an implicit procedure."""
        try:
            released = ImplicitProcedure(make_springback_model(self.model), threads=self._threads)
            carry_to_implicit(self.shells, released)
        except (MeshError, StartError, TransferError) as error:
            raise GaveUpError(f"springback cannot begin: {error}") from error
        self._elastic = released.mechanics.elastic_energy(released.state)
        self._formed = self.shells.position - self.model.mesh.points
        self._implicit = released
        return released

    def remaining(self) -> float:
        """Return the part of the whole process still to be computed; springback counts as a small one."""
        left = 1.0 if self._implicit is None else self._implicit.remaining()
        return (1.0 - SHARE) * super().remaining() + SHARE * left

    @property
    def number(self) -> int:
        """Rows and increments so far."""
        return super().number + (int(self._implicit.state.progress[INCREMENTS]) if self._implicit else 0)

    # --- what is recorded --------------------------------------------------------------------------------------------

    def log_lines(self, report: RowReport | SpringbackReport) -> list[str]:
        """Say where the row or increment ended."""
        if isinstance(report, RowReport):
            return super().log_lines(report)
        found = report.increment
        return [
            *(f"{NAME} cut back: {reason}" for reason in found.cutbacks),
            f"increment {report.number}, stage {NAME} at {found.fraction:.4f}, {len(found.log)} iterations, residuals "
            f"{' '.join(f'{r:.1e}' for r in found.log.residual)}",
        ]

    def progress_text(self, report: RowReport | SpringbackReport) -> str:
        """Name stage and cycle or increment."""
        if isinstance(report, RowReport):
            return super().progress_text(report)
        return f"{NAME}: {report.increment.fraction:.0%} of the forces taken away"

    def row(self, report: RowReport | SpringbackReport) -> Row:
        """Return the row of the history; of springback no tool has a force, and nothing moves."""
        if isinstance(report, RowReport):
            return super().row(report)
        assert self._implicit is not None
        row: Row = dict.fromkeys(self.columns, 0.0)
        row |= {name: value for name, value in self.tools.row().items() if name.endswith(".stroke")}
        row |= {"time": report.time, "stage": NAME, "increment": report.number}
        row |= {name: value for name, value in super().row(self._last_row()).items() if name in _KEPT}
        released = self._elastic - self._implicit.mechanics.elastic_energy(self._implicit.state)
        row["internal_energy"] = float(row["internal_energy"]) - released
        row["external_energy"] = float(row["external_energy"]) - released
        return row

    def _last_row(self) -> RowReport:
        """Return a report of where forming ended."""
        shells = self.shells
        return RowReport(super().number, NAME, 1.0, shells.time, 0, shells.dt, self._end_energies(), is_save_point=True)

    def _end_energies(self) -> EnergyBalance:
        return self.shells.energies(damping=self.model.explicit.damping, velocity_scale=0.0)

    def snapshot(self) -> Snapshot:
        """Return the fields of the present state; `springback` is the displacement since the part was let go."""
        snapshot = super().snapshot()
        if self._implicit is None:
            nothing = np.zeros_like(self.model.mesh.points)
            return replace(snapshot, point_data={**snapshot.point_data, NAME: nothing})
        state, mechanics = self._implicit.state, self._implicit.mechanics
        cells = mechanics.cell_fields(state)
        cells |= formability_fields(cells, self._judged)
        return replace(
            snapshot,
            time=self.shells.time + float(state.progress[0]),
            point_data={
                "displacement": state.displacement[:, :3].copy(),
                "reaction_force": state.reaction[:, :3].copy(),
                "reaction_moment": state.reaction[:, 3:].copy(),
                "contact_force": np.zeros_like(self.model.mesh.points),
                NAME: self._moved(),
            },
            cell_data={name: cells[name] for name in snapshot.cell_data},
        )

    def _moved(self) -> FloatArray:
        """Return the displacement of springback (n_points, 3) [mm]."""
        assert self._implicit is not None
        return np.asarray(self._implicit.state.displacement[:, :3] - self._formed)

    def to_arrays(self) -> dict[str, NDArray[np.generic]]:
        """Return every array that the next row or increment depends on."""
        arrays = super().to_arrays()
        if self._implicit is not None:
            arrays |= {f"{NAME}.{name}": values for name, values in self._implicit.state.to_arrays().items()}
        return arrays

    def load_arrays(self, arrays: Mapping[str, NDArray[Any]]) -> None:
        """Go back to the state of these arrays. Raises ValueError if they belong to another model."""
        own = {name.removeprefix(f"{NAME}."): v for name, v in arrays.items() if name.startswith(f"{NAME}.")}
        self._implicit = None
        super().load_arrays({name: v for name, v in arrays.items() if not name.startswith(f"{NAME}.")})
        if own:
            self._release().state.load_arrays(own)

    def summary(self, history: Mapping[str, NDArray[Any]]) -> dict[str, Any]:
        """Return what a stamping's summary says, and how far which point has sprung."""
        summary = super().summary(history)
        if self._implicit is None:
            return summary
        way = np.linalg.norm(self._moved(), axis=1)
        at = int(np.argmax(way))
        progress = self._implicit.state.progress
        return summary | {
            NAME: {
                "largest_mm": float(way[at]),
                "at_mm": [float(x) for x in self.model.mesh.points[at]],
                "increments": int(progress[INCREMENTS]),
                "iterations": int(progress[ITERATIONS]),
                "cutbacks": int(progress[CUTBACKS]),
            }
        }
