# SPDX-License-Identifier: Apache-2.0
"""What follows forming: the part is trimmed, and springs back.

It is cut along the trim lines while its tools hold it (trim.py). Then it is released, and the implicit procedure finds
where it comes to rest. The tools are gone; what they and inertia held fades over a few increments (transfer.py), and so
does what the cut took away. Only symmetry planes stay, and as many freedoms of three nodes as rigid motions are left:
such supports bear no force, so they leave the shape alone and only choose from where it is seen. The first node lies in
the middle of the blank, the other two near it along x and y, so that the bottom of a part stays where it is and its
walls and flange move.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswork.fields.table import compute_fields
from presswork.geometry.best_fit import measure_deviation
from presswork.implicit.progress import Progress
from presswork.implicit.stepping import ImplicitProcedure, IncrementReport
from presswork.mesh.checks import MeshError
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
)
from presswork.outcome import GaveUpError, StartError
from presswork.process.epochs import EpochRecording, NamedArrays
from presswork.process.implicit_stamping import ImplicitStamping
from presswork.process.limits import Watched
from presswork.process.recording import Meta, Report, Row, Snapshot
from presswork.process.stamping import ExplicitStamping
from presswork.process.transfer import TEMPERATURE, TransferError, begin_with
from presswork.process.trim import Cut, TrimError, explain_beside, trim_sheet

TRIM, NAME, DEVIATION = "trim", "springback", "deviation"
FORMING, FORMED, ELASTIC = "forming.", "formed", "elastic"
"""Names in a checkpoint: the prefix of the formed part, and what _Released keeps."""
HEATED = "heated."
"""Prefix in a checkpoint of SheetState.heated."""
ELEMENTS: dict[int, ShellElement] = {3: "shell3_mitc_plus", 4: "shell4_mitc_plus"}
"""By number of nodes."""
SYMMETRY = tuple(tuple(i in held for i in range(6)) for held in ((0, 4, 5), (1, 3, 5)))
"""What planes normal to x and y hold: a displacement and two rotations."""
APART = 0.2
"""Least distance of the nodes that hold the sheet, over the blank's length and width."""
STORED = ("internal_energy", "external_energy", "elastic_energy", "external_work")
"""Columns of the history that lose the elastic energy which springback sets free."""
WORTH_A_WARNING = 0.2
"""Of an element by which the trimmed outline misses its line."""
SHARE = 0.03
"""Of the whole process that springback counts as in the progress display."""


@dataclass(frozen=True)
class TrimReport:
    """The part has been cut."""

    number: int
    is_save_point: bool = True


@dataclass(frozen=True)
class SpringbackReport:
    """An increment of springback."""

    number: int
    """What was reported before included."""
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


def make_springback_model(model: Model, mesh: Mesh) -> Model:
    """Return the Model of the released sheet; mesh: undeformed."""
    springback = model.springback or Springback()
    planes = [s for s in model.supports if s.fix in SYMMETRY]
    blocks = tuple(replace(block, element=ELEMENTS[block.connectivity.shape[1]]) for block in mesh.blocks)
    node_sets = dict(mesh.node_sets)
    supports = list(planes)
    for node, fixed in hold_rigidly(mesh.points, model.symmetry).items():
        name = f"held_{node}"
        node_sets[name] = np.array([node], dtype=np.int32)
        supports.append(Support(name, (*fixed, False, False, False)))
    size = 1.0 / springback.increments
    return Model(
        title=model.title,
        analysis="shell",
        mesh=replace(mesh, blocks=blocks, node_sets=node_sets),
        materials=model.materials,
        supports=tuple(supports),
        stages=(Stage(NAME, duration=model.stages[-1].duration),),
        solver=SolverSettings(initial_increment=size, max_increment=size),
        output=OutputSettings(steps=1),
    )


@dataclass(frozen=True)
class _Released:
    """The part without its tools."""

    implicit: ImplicitProcedure
    cut: Cut | None
    formed: FloatArray
    """Displacement when it was released (n_points, 3) [mm]."""
    elastic: float
    """Energy stored then [N mm]."""
    heated: Mapping[str, FloatArray] = field(default_factory=dict)
    """As of SheetState."""


class ReleasedStamping(EpochRecording):
    """A stamping after which the part is trimmed, or springs back, or both: with that the last epoch begins."""

    model: Model

    def __init__(self, model: Model, *, threads: int = 0) -> None:
        super().__init__(model)
        procedure = ImplicitStamping if model.explicit is None else ExplicitStamping
        self.forming: ExplicitStamping | ImplicitStamping = procedure(model, threads=threads)
        self.timing = self.forming.timing
        self._threads = threads
        self._released: _Released | None = None

    def advance(self) -> Iterator[Report]:
        """Form the part row after row, cut it, then let it go. Raises GaveUpError."""
        yield from self.forming.advance()
        if self._released is None:
            self._released = self._release()
            if self.model.trim:
                yield TrimReport(self.forming.number + 1)
        if self.model.springback is None:
            return
        before = self.forming.number + bool(self.model.trim)
        for report in self._released.implicit.advance():
            yield SpringbackReport(before + report.number, report, report.is_save_point)

    def _release(self) -> _Released:
        """Begin the epoch of the part without its tools: the implicit procedure knows no hanging nodes."""
        if isinstance(self.forming, ExplicitStamping):
            self.forming.split_evenly()
        mesh, state, cut = self.forming.mesh, self.forming.sheet(), None
        try:
            if self.model.trim:
                trimmed = trim_sheet(mesh, state, self.model.trim, ELEMENTS, self.model.symmetry)
                mesh, state, cut = trimmed.mesh, trimmed.state, trimmed.cut
            implicit = ImplicitProcedure(make_springback_model(self.model, mesh), threads=self._threads)
            begin_with(state, implicit)
        except TrimError as error:
            raise GaveUpError(str(error)) from error
        except (MeshError, StartError, TransferError) as error:
            raise GaveUpError(f"springback cannot begin: {error}") from error
        self._begin_epoch(mesh)
        elastic = implicit.mechanics.elastic_energy(implicit.state)
        return _Released(implicit, cut, state.position - mesh.points, elastic, state.heated)

    def remaining(self) -> float:
        """Return the part of the whole process still to be computed; springback counts as a small one."""
        left = 1.0 if self._released is None else 0.0
        if self._released is not None and self.model.springback is not None:
            left = self._released.implicit.remaining()
        return (1.0 - SHARE) * self.forming.remaining() + SHARE * left

    @property
    def number(self) -> int:
        """Rows and increments so far."""
        if self._released is None:
            return self.forming.number
        increments = self._released.implicit.state[Progress].increments
        return self.forming.number + bool(self.model.trim) + increments

    # --- what is recorded --------------------------------------------------------------------------------------------

    @property
    def mesh(self) -> Mesh:
        """The undeformed sheet: the blank, and what trimming leaves of it."""
        return self.forming.mesh if self._released is None else self.model.mesh

    @property
    def columns(self) -> list[str]:
        """Of history.csv."""
        return self.forming.columns

    def begin_log(self) -> str:
        """Name the procedure that forms, and what it starts with."""
        return self.forming.begin_log()

    def log_lines(self, report: Any) -> list[str]:
        """Say where the row or increment ended."""
        if isinstance(report, TrimReport):
            assert self._released is not None
            assert self._released.cut is not None
            before, after = (sum(len(b.connectivity) for b in m.blocks) for m in (self.forming.mesh, self.mesh))
            cut = self._released.cut
            line = f"{TRIM}: {after} of {before} shells, cut within {cut.off_line:.3g} mm of the line"
            return [line, *(f"warning: {text}" for text in explain_beside(cut))]
        if not isinstance(report, SpringbackReport):
            return self.forming.log_lines(report)
        found = report.increment
        return [
            *(f"{NAME} cut back: {reason}" for reason in found.cutbacks),
            f"increment {report.number}, stage {NAME} at {found.fraction:.4f}, {len(found.log)} iterations, residuals "
            f"{' '.join(f'{r:.1e}' for r in found.log.residual)}",
        ]

    def progress_text(self, report: Any) -> str:
        """Name stage and cycle or increment."""
        if isinstance(report, TrimReport):
            return TRIM
        if not isinstance(report, SpringbackReport):
            return self.forming.progress_text(report)
        return f"{NAME}: {report.increment.fraction:.0%} of the forces taken away"

    def row(self, report: Any) -> Row:
        """Return the row of the history; of a part without tools no tool has a force, and nothing moves."""
        if not isinstance(report, TrimReport | SpringbackReport):
            return self.forming.row(report)
        assert self._released is not None
        implicit = self._released.implicit
        row = self.forming.row_at_rest()
        freed = self._released.elastic - implicit.mechanics.elastic_energy(implicit.state)
        row |= {name: float(row[name]) - freed for name in STORED if name in row}
        stage = TRIM if isinstance(report, TrimReport) else NAME
        return row | {"time": self._time(), "stage": stage, "increment": report.number}

    def _time(self) -> float:
        assert self._released is not None
        return self.forming.time + self._released.implicit.state[Progress].time

    def watch(self) -> Watched:
        """Return how far forming is towards its limits; a released part has passed none of its own."""
        return self.forming.watch() if self._released is None else Watched()

    def snapshot(self) -> Snapshot:
        """Return the fields of the present state.

        `springback` is the displacement since the part was released, `deviation` how far it lies off the shape that it
        had in its tools, along that shape's normal, after the best fit.
        """
        now = self.forming.show()
        if self._released is None:
            if self.model.springback is not None:
                now.springback, now.deviation = np.zeros_like(self.mesh.points), np.zeros(len(self.mesh.points))
            return self.forming.snapshot(now)
        snapshot = self.forming.snapshot(now)
        now = self._released.implicit.mechanics.show(self._released.implicit.state)
        now.tool_force, now.judged = np.zeros_like(self.mesh.points), self.model.sheet[1].formability
        now.heated, now.temperature = self._released.heated, self._released.heated.get(TEMPERATURE)
        if self.model.springback is not None:
            now.springback, now.deviation = self._moved(), self._deviation()
        points, cells = compute_fields(now)
        common = {name: cells[name] for name in snapshot.cell_data}  # what both procedures have
        return replace(snapshot, time=self._time(), point_data=points, cell_data=common)

    def _moved(self) -> FloatArray:
        """Return the displacement of springback (n_points, 3) [mm]."""
        assert self._released is not None
        return np.asarray(self._released.implicit.state.nodes.displacement[:, :3] - self._released.formed)

    def _deviation(self) -> FloatArray:
        """Return how far nodes lie off the shape in the tools (n_points,) [mm]."""
        assert self._released is not None
        formed = self.mesh.points + self._released.formed
        cells = [block.connectivity for block in self.mesh.blocks]
        return measure_deviation(formed + self._moved(), formed, cells, self.model.symmetry)

    def _epoch_arrays(self) -> NamedArrays:
        released = self._released
        if released is None:
            return {}
        heated = {f"{HEATED}{name}": values for name, values in released.heated.items()}
        return {FORMED: released.formed, ELASTIC: np.array(released.elastic), **heated}

    def _make_run(self, epoch: Mapping[str, NDArray[Any]]) -> None:
        if not self.epoch:
            self._released = None
            return
        implicit = ImplicitProcedure(make_springback_model(self.model, self.model.mesh), threads=self._threads)
        heated = {name.removeprefix(HEATED): v for name, v in epoch.items() if name.startswith(HEATED)}
        self._released = _Released(implicit, None, epoch[FORMED], float(epoch[ELASTIC]), heated)

    def _state_arrays(self) -> NamedArrays:
        parts = {FORMING: self.forming.to_arrays()}
        if self._released is not None:
            parts[f"{NAME}."] = self._released.implicit.state.to_arrays()
        return {f"{part}{name}": values for part, arrays in parts.items() for name, values in arrays.items()}

    def _load_state(self, arrays: Mapping[str, NDArray[Any]]) -> None:
        def of(part: str) -> dict[str, NDArray[Any]]:
            return {name.removeprefix(part): values for name, values in arrays.items() if name.startswith(part)}

        self.forming.load_arrays(of(FORMING))
        if self._released is not None:
            self._released.implicit.state.load_arrays(of(f"{NAME}."))

    def meta(self) -> Meta:
        """Return how the part was cut, which no array holds."""
        cut = None if self._released is None else self._released.cut
        return {} if cut is None else {TRIM: cut.to_text()}

    def load_meta(self, meta: Mapping[str, Any]) -> None:
        """Take up what meta gave."""
        if self._released is not None and TRIM in meta:
            self._released = replace(self._released, cut=Cut.from_text(str(meta[TRIM])))

    def summary(self, history: Mapping[str, NDArray[Any]]) -> dict[str, Any]:
        """Return what a stamping's summary says, how it was cut, and how far which point has sprung."""
        summary = self.forming.summary(history)
        if self._released is None:
            return summary
        cut = self._released.cut
        if cut is not None:
            cells = sum(len(block.connectivity) for block in self.mesh.blocks)
            miss = cut.off_line
            summary[TRIM] = {
                "cells": cells,
                "off_line_mm": miss,
                "beside_sheet": {name: asdict(each) for name, each in cut.beside.items()},
            }
            summary["warnings"] = [*summary["warnings"], *explain_beside(cut)]
            if miss > WORTH_A_WARNING * cut.element_size:
                text = f"the trimmed outline is up to {miss:.3g} mm off its line: refine the blank there"
                summary["warnings"] = [*summary["warnings"], text]
        if self.model.springback is None:
            return summary
        way = np.linalg.norm(self._moved(), axis=1)
        at, deviation = int(np.argmax(way)), self._deviation()
        progress = self._released.implicit.state[Progress]
        return summary | {
            NAME: {
                "largest_mm": float(way[at]),
                "at_mm": [
                    float(x) for x in self.mesh.points[at] + self._released.implicit.state.nodes.displacement[at, :3]
                ],
                "at_blank_mm": [float(x) for x in self.mesh.points[at]],
                "deviation_mm": [float(deviation.min()), float(deviation.max())],
                "increments": progress.increments,
                "iterations": progress.iterations,
                "cutbacks": progress.cutbacks,
            }
        }
