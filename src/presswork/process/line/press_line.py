# SPDX-License-Identifier: Apache-2.0
"""A press line: a part goes through one operation after another, each with tools of its own.

Every operation is a stamping that may be trimmed and released at its end (springback.py). The next one takes the sheet
as it is then: position, thickness, stresses and what the law keeps, on the undeformed mesh that trimming has left. So
strains, thinning and forming limits count from the first blank. Velocities are left behind. Energies in the history
count from the beginning of each operation, strokes from where its tools were laid.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from presswork.explicit.input_checks import ExplicitError
from presswork.mesh.files.dump import dump_mesh, load_mesh
from presswork.model import FloatArray, IntArray, Mesh, Model
from presswork.observe.contract import Observed, Row
from presswork.observe.formability import FormabilityObserver
from presswork.observe.ram import RAM_COLUMNS, has_ram
from presswork.observe.reactions import Reactions
from presswork.outcome import GaveUpError, StartError
from presswork.process.line.laying import LayingError, close_tools, find_plans, find_turn, lay_part, lay_tools, tip_onto
from presswork.process.line.part_fit import check_reach, explain_misfit
from presswork.process.line.sheet_dump import dump_sheet, load_sheet
from presswork.process.line.springback import LaidPart, ReleasedStamping, SpringbackReport, TrimReport
from presswork.process.mesh_change.transfer import TransferError
from presswork.process.model_run import ModelRun, NamedArrays
from presswork.process.run import Meta, Report, Snapshot
from presswork.process.space_surfaces import cut_tools
from presswork.process.stamping_tools import bead_columns, tool_columns
from presswork.ranks.world import World

LAID = "laid"
"""What the history calls the row of a part that lies on the tools of its next operation."""
NUMBER, BEFORE, TURNED, LEVEL = "number", "before", "turned", "level"
LINE, MESH, SHEET, NOW = "line.", "line.mesh.", "line.sheet.", "now."
"""Prefixes in a checkpoint: of the line, of the part that the present operation has begun with, of that operation."""
MISFIT = "misfit"
"""What the line keeps of warnings on the part in the operation after the one that is over."""
REPORTS = "line"
"""Name in the meta of a checkpoint."""


@dataclass(frozen=True)
class LineReport:
    """A step forward of the line."""

    number: int
    is_save_point: bool
    report: Report | None
    """Report of the operation; None where a part has been laid into it."""


class FollowedLine(Protocol):
    """What goes through the operations of a line beside its part."""

    def leave_operation(self) -> None:
        """Note where nodes are before the part is laid into the next operation."""

    def take_operation(self) -> None:
        """Go on in the operation that the line has begun."""

    def arrays(self) -> NamedArrays:
        """Return what a checkpoint keeps."""

    def go_to(self, arrays: Mapping[str, NDArray[Any]]) -> None:
        """Go on in the operation of a checkpoint, which the line has begun."""


class PressLine(ModelRun):
    """A part at work in one operation after another."""

    def __init__(self, model: Model, *, threads: int = 0, world: World | None = None) -> None:
        """world: ranks that share the cycles of explicit operations."""
        super().__init__(model)
        self._threads, self._world = threads, world
        self.operation, self._before, self._time_before = 0, 0, 0.0
        self._part: LaidPart | None = None
        self._files: dict[str, str] = {}
        self._reports: dict[str, dict[str, Any]] = {}
        """Summaries of operations that are over, by name, with their warnings."""
        self._releases = any(each is not None for each in (model.springback, *(o.springback for o in model.following)))
        self.now = self._make(0, None, model.mesh)
        """The operation at work."""
        self.timing = self.now.timing
        self._columns = self._find_columns()
        self.neighbours: FollowedLine | None = None
        """What goes through the operations beside the part."""

    # --- operations --------------------------------------------------------------------------------------------------

    @property
    def _name(self) -> str:
        return self.model.operations[self.operation]

    def _make(self, number: int, part: LaidPart | None, mesh: Mesh) -> ReleasedStamping:
        """Return an operation at its start. Raises LayingError, StartError, ExplicitError, TransferError."""
        own = self.model.of_operation(number)
        if part is not None:
            operation, with_edges = self.model.following[number - 1], own.explicit is not None
            tools = lay_tools(operation, part.state, with_edges=with_edges)
            stages = close_tools(operation, tools, own.thickest)
            check_reach(operation, tools, stages, part.state)
            own = replace(own, mesh=mesh, tools=tools, stages=stages)
        return ReleasedStamping(
            own, threads=self._threads, begin=part, shows_springback=self._releases, world=self._world
        )

    def begin_next(self) -> None:
        """Lay the part into the next operation. Raises GaveUpError."""
        before, next_one = self.now, self.model.following[self.operation]
        if self.model.output.dynain:
            self._files = {f"{self._name}.dynain": before.write_part()}
        turned = np.eye(3) if self._part is None else self._part.turned
        state, turn = lay_part(before.sheet(), next_one.place), find_turn(next_one.place)
        formed = before.formed_shape() @ turn.T + np.asarray(next_one.place.move)
        try:
            if next_one.place.tips:
                with_edges = self.model.explicit is not None
                state, tipped = tip_onto(next_one, state, self.model.symmetry, with_edges=with_edges)
                turn = tipped @ turn
            part = LaidPart(state, turn @ turned, before.level)
            now = self._make(self.operation + 1, part, before.mesh)
            laid = now.model
            misfit = explain_misfit(next_one, laid.tools, laid.stages, state, formed, stops=laid.limits.stop)
        except (LayingError, StartError, ExplicitError, TransferError) as error:
            raise GaveUpError(f"the operation {next_one.name} cannot begin: {error}") from error
        self._reports[self._name] = _summarise(before) | {MISFIT: misfit}
        self._before += before.number + 1
        self._time_before += before.time
        self.operation, self._part, self.now = self.operation + 1, part, now
        now.timing.go_on_from(self.timing)
        self.timing = now.timing

    def advance(self) -> Iterator[LineReport]:
        """Go on through the operations. Raises GaveUpError."""
        while True:
            for report in self.now.advance():
                yield LineReport(self._before + report.number, report.is_save_point, report)
            if self.operation == len(self.model.following):
                return
            if self.neighbours is not None:
                self.neighbours.leave_operation()
            self.begin_next()
            if self.neighbours is not None:
                self.neighbours.take_operation()
            yield LineReport(self._before, is_save_point=True, report=None)

    def files(self) -> dict[str, str]:
        """Return parts of operations that are over as dynain, where the case asks for it."""
        files, self._files = self._files, {}
        last = self.now.files() if self.operation == len(self.model.following) else {}
        return files | {f"{self._name}.dynain": text for text in last.values()}

    def remaining(self) -> float:
        """Return the part of the whole line still to be computed; operations count alike."""
        after = len(self.model.following) - self.operation
        return (after + self.now.remaining()) / (len(self.model.following) + 1)

    @property
    def number(self) -> int:
        """Reports so far."""
        return self._before + self.now.number

    # --- what is recorded --------------------------------------------------------------------------------------------

    @property
    def mesh(self) -> Mesh:
        """The undeformed sheet: the blank, and what trimming leaves of it."""
        return self.now.mesh

    @property
    def columns(self) -> list[str]:
        """Return the columns of history.csv: those of the first operation, then tools and beads of the others."""
        return self._columns

    def _find_columns(self) -> list[str]:
        columns = self.now.columns
        added = [name for number in range(len(self.model.following)) for name in self._columns_of(number + 1)]
        last = max(i for i, name in enumerate(columns) if name in {"increment", *self._columns_of(0)})
        new = [name for name in dict.fromkeys(added) if name not in columns]
        return [*columns[: last + 1], *new, *columns[last + 1 :]]

    def _columns_of(self, number: int) -> list[str]:
        own = self.model.of_operation(number)
        still = {t.name: np.zeros(3) for t in own.tools}
        tools = tool_columns(own, still, np.zeros((len(own.tools), 3)))
        ram = RAM_COLUMNS if has_ram(own) else ()
        reactions = Reactions(own).names
        return [*tools, *bead_columns(own, [0.0] * len(own.beads)), *ram, *reactions]

    def begin_log(self) -> str:
        """Name the operations, and the procedure that forms."""
        return f"operations: {', '.join(self.model.operations)}; {self.now.begin_log()}"

    def log_lines(self, report: LineReport) -> list[str]:
        """Describe in which operation the row or increment ended, and where."""
        if report.report is None:
            tools = ", ".join(f"{tool.name} at z = {tool.position[2]:.6g} mm" for tool in self.now.model.tools)
            warnings = self._reports[self.model.operations[self.operation - 1]][MISFIT]
            return [f"{self._name}: the part is laid in, {tools}", *(f"warning: {text}" for text in warnings)]
        return [f"{self._name}: {line}" for line in self.now.log_lines(report.report)]

    def progress_text(self, report: LineReport) -> str:
        """Name operation, stage and cycle or increment."""
        if report.report is None:
            return f"{self._name}: {LAID}"
        return f"{self._name}: {self.now.progress_text(report.report)}"

    def row(self, report: LineReport) -> Row:
        """Return the row of the history; tools that are not at work have stroke and force zero."""
        if report.report is None:
            row = self.now.forming.row_at_rest() | {"stage": f"{self._name}_{LAID}"}
        else:
            row = self.now.row(report.report)
            if isinstance(report.report, TrimReport | SpringbackReport):
                row |= {"stage": f"{self._name}_{row['stage']}"}
        nothing: Row = dict.fromkeys(self._columns, 0.0)
        return nothing | row | {"time": self._time_before + float(row["time"]), "increment": report.number}

    def at_work(self) -> Observed | None:
        """Return what observers see of the run that forms at present."""
        return self.now.at_work()

    def snapshot(self) -> Snapshot:
        """Return the fields of the present state; tools of other operations have no place (NaN)."""
        now, at_work = self.now.snapshot(), {tool.name: tool for tool in self.now.model.tools}
        surfaces: dict[str, tuple[FloatArray, IntArray]] = {}
        displacement: dict[str, FloatArray] = {}
        for number in range(len(self.model.following) + 1):
            own = self.model.of_operation(number)
            surfaces |= cut_tools(own)
            for tool in own.tools:
                displacement[tool.name] = np.full(3, np.nan)
                if tool.name in at_work:
                    laid = np.subtract(at_work[tool.name].position, tool.position)
                    displacement[tool.name] = now.tool_displacement.get(tool.name, np.zeros(3)) + laid
        laid_in = "\n".join(f"{each.name}_{LAID}" for each in self.model.following)  # from where strokes count
        return replace(
            now,
            time=self._time_before + now.time,
            surfaces=surfaces,
            tool_displacement=displacement,
            info={
                **now.info,
                "placing": laid_in,
                "operations": "\n".join(self.model.operations),
                "plans": find_plans(self.model.following),
            },
        )

    def to_arrays(self) -> NamedArrays:
        """Return the present operation, and the part that it has begun with; of neighbours theirs, too."""
        beside = self.neighbours.arrays() if self.neighbours else {}
        return self.line_arrays() | beside | {f"{NOW}{name}": values for name, values in self.now.to_arrays().items()}

    def line_arrays(self) -> NamedArrays:
        """Return which operation is at work, and the part that it has begun with."""
        arrays: dict[str, NDArray[Any]] = {
            f"{LINE}{NUMBER}": np.array(self.operation),
            f"{LINE}{BEFORE}": np.array([self._before, self._time_before]),
        }
        if self._part is not None:
            arrays |= {f"{LINE}{TURNED}": self._part.turned, f"{LINE}{LEVEL}": np.array(self._part.level)}
            arrays |= {f"{MESH}{name}": values for name, values in dump_mesh(self.now.first_mesh).items()}
            arrays |= {f"{SHEET}{name}": values for name, values in dump_sheet(self._part.state).items()}
        return arrays

    def load_arrays(self, arrays: Mapping[str, NDArray[Any]]) -> None:
        """Go back to the operation and the state of these arrays. Raises ValueError if they belong to another model."""
        self.go_to(arrays)
        if self.neighbours is not None:
            self.neighbours.go_to(arrays)
        self.now.load_arrays(_under(NOW, arrays))

    def go_to(self, arrays: Mapping[str, NDArray[Any]]) -> None:
        """Begin the operation of these arrays with its part. Raises ValueError if they belong to another model."""
        if f"{LINE}{NUMBER}" not in arrays:
            raise ValueError("the checkpoint does not name its operation")
        self.operation = int(arrays[f"{LINE}{NUMBER}"])
        before, self._time_before = (float(each) for each in arrays[f"{LINE}{BEFORE}"])
        self._before = int(before)
        if self.operation:
            sheet = load_sheet(_under(SHEET, arrays))
            self._part = LaidPart(sheet, arrays[f"{LINE}{TURNED}"], int(arrays[f"{LINE}{LEVEL}"]))
            self.now = self._make(self.operation, self._part, load_mesh(_under(MESH, arrays)))
            self.timing = self.now.timing

    def meta(self) -> Meta:
        """Return the summaries of operations that are over, and how the present part was cut."""
        return {REPORTS: json.dumps(self._reports), **self.now.meta()}

    def load_meta(self, meta: Mapping[str, Any]) -> None:
        """Take up what meta gave."""
        self._reports = json.loads(str(meta[REPORTS]))
        self.now.load_meta(meta)

    def summary(self, history: Mapping[str, NDArray[Any]]) -> dict[str, Any]:
        """Return the summary of the last operation, and what became of the others."""
        last = self.now.summary(history)
        warnings = []
        for name, report in self._reports.items():
            warnings += [f"{name}: {each}" for each in report["warnings"]] + report[MISFIT]
        kept = {"warnings", MISFIT}
        over = {
            name: {key: v for key, v in report.items() if key not in kept} for name, report in self._reports.items()
        }
        return last | {
            "increments": self.number,
            "operation": self._name,
            "operations": over,
            "warnings": [*warnings, *last["warnings"]],
        }


def _under(prefix: str, arrays: Mapping[str, NDArray[Any]]) -> dict[str, NDArray[Any]]:
    """Return the arrays whose names begin with a prefix, without it."""
    return {name.removeprefix(prefix): v for name, v in arrays.items() if name.startswith(prefix)}


def _summarise(over: ReleasedStamping) -> dict[str, Any]:
    """Return the summary of an operation that is over, with its warnings."""
    report, warnings = over.summarise_release()
    observers = over.forming.observers
    verdict = observers.find(FormabilityObserver).judge(over.forming)
    assert verdict is not None, "shells have principal strains"
    report |= over.summarise_hem()
    report |= {"formability": verdict.to_summary(), "reports": over.number}
    return report | {"warnings": [*verdict.warnings(), *warnings]}
