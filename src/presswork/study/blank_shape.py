# SPDX-License-Identifier: Apache-2.0
"""The shape of a blank from the flange wanted: draw it, correct its outline, draw again.

DIR/draw_00 ... are the runs, DIR/blank_00.toml ... their cases; table.csv and outlines.png show the course, and the
best blank is left as blank.csv, blank.dxf and blank.toml.
"""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np
import tomli_w

from presswork.api import build
from presswork.case import CaseError, StampingCase
from presswork.case.case_file import write_as_run
from presswork.case.errors import Problem
from presswork.case.reader import read_tables
from presswork.case.stamping.plan_line import LineFile, draw_line
from presswork.case.stamping.tools import RectangularTool, RoundTool
from presswork.model import FloatArray, Model
from presswork.post import FlangeFit, fit_flange
from presswork.recorder import Progress
from presswork.results import OutputError, Result, open_output_folder, write_outline
from presswork.results.folder import delete_folder
from presswork.results.whole_file import write_whole
from presswork.study.cluster.connection import Cluster
from presswork.study.one_member import compute_member, open_search_folder
from presswork.study.open_runner import open_runner
from presswork.study.runner import Runner
from presswork.study.table import read_summary, write_table

TABLE, CASE, POINTS, DRAWING = "table.csv", "blank.toml", "blank.csv", "blank.dxf"
_KEPT = ("thickness", "material", "points", "rule", "rolling_direction", "symmetry", "element_size", "cells", "refine")
"""Keys of the case's blank that are kept whatever its new shape."""
_CHORD = 2.0
"""Degrees between points on the round corners of a target."""
_STUCK = 0.9
"""Largest deviation over the best before it, from which on a draw has not helped; two of them end the search."""

Status = Literal["completed", "gave_up", "interrupted"]


@dataclass(frozen=True)
class Draw:
    """One blank and the flange that it was drawn to."""

    number: int
    folder: Path
    fit: FlangeFit
    seconds: float


@dataclass(frozen=True)
class BlankShape:
    """Result of the search for a blank."""

    status: Status
    """"gave_up": no blank drew a flange within the tolerance."""
    reason: str
    folder: Path
    target: FloatArray
    """(n, 2) [mm]."""
    draws: tuple[Draw, ...]

    @property
    def best(self) -> Draw:
        """The draw whose flange came nearest to the target."""
        return min(self.draws, key=lambda draw: draw.fit.worst)


def find_blank_shape(
    case_file: Path | str,
    target: FloatArray,
    folder: Path | str,
    *,
    tolerance: float,
    most: int = 8,
    damping: float = 1.0,
    settings: Sequence[str] = (),
    threads: int = 0,
    cluster: Cluster | str | None = None,
    member_timeout: float | None = None,
    resume: bool = False,
    overwrite: bool = False,
    on_progress: Callable[[int, Progress], None] | None = None,
    on_draw: Callable[[Draw], None] | None = None,
) -> BlankShape:
    """Change the blank of a stamping until its drawn edge, from above, lies within a tolerance of a target.

    target: closed outline (n, 2) [mm] of the whole flange; tolerance: largest distance of an edge node from it [mm].
    The case's own blank is drawn first. most: draws; damping: part of each correction that is made, 0 to 1. settings:
    `key=value` texts that change the case. threads: of a draw, 0 for all of the machine or of a worker. cluster: a Dask
    cluster that computes the draws, or the address of its scheduler. member_timeout: longest time of a draw [s],
    which ends the search. Everything is written to the folder. With `resume` draws that are there are
    kept, and one that was stopped goes on. Raises CaseError for a case or target that cannot be used, OutputError for a
    folder that cannot, ClusterError for a cluster that cannot.
    """
    search = _Search(Path(case_file), settings, target, tolerance, damping)
    with open_runner(1 if cluster is None else 0, cluster, member_timeout, threads=threads) as runner:
        search.open_folder(Path(folder), resume, overwrite)
        status, reason = search.run(most, runner, resume, on_progress, on_draw)
    if search.draws:
        search.leave_best()
    return BlankShape(status, reason, search.folder, target, tuple(search.draws))


def read_target(path: Path) -> FloatArray:
    """Return the target's outline in a DXF or CSV file (n, 2) [mm]. Raises CaseError."""
    line = draw_line(LineFile(shape="file", path=str(path)), "--target", Path())
    if isinstance(line, Problem):
        raise CaseError([Problem("--target", line.expected, line.remedy)], path)
    return line


def surround_opening(case_file: Path | str, width: float, settings: Sequence[str] = ()) -> FloatArray:
    """Return the outline at a distance [mm] round the die's opening (n, 2) [mm]. Raises CaseError."""
    case = StampingCase.from_toml(case_file, settings)
    dies = [tool for tool in case.tools.values() if tool.kind == "die"]
    if len(dies) != 1 or not isinstance(dies[0], RoundTool | RectangularTool):
        raise CaseError(
            [Problem("--flange-width", "the case has no single round or rectangular die", "give --target FILE")],
            case.source,
        )
    half = np.array(dies[0].half_size())
    radius = float(half[0]) if isinstance(dies[0], RoundTool) else dies[0].corner_radius
    if width <= -radius:
        raise CaseError([Problem("--flange-width", f"{width:g} mm leaves no outline", "give more")], case.source)
    quarter = np.radians(np.arange(0.0, 90.0 + 0.5 * _CHORD, _CHORD))
    corners = []
    for k, (x, y) in enumerate(((1, 1), (-1, 1), (-1, -1), (1, -1))):
        angle = quarter + 0.5 * np.pi * k
        centre = (half - radius) * (x, y)
        corners.append(centre + (radius + width) * np.stack([np.cos(angle), np.sin(angle)], axis=1))
    points = np.concatenate(corners)
    apart = np.linalg.norm(points - np.roll(points, 1, axis=0), axis=1) > 1e-9 * half.max()
    return np.asarray(points[apart])


class _Search:
    """One search for a blank's shape."""

    def __init__(
        self, case_file: Path, settings: Sequence[str], target: FloatArray, tolerance: float, damping: float
    ) -> None:
        for key, fault, remedy in (
            ("--tolerance", "" if tolerance > 0 else f"{tolerance:g} is not > 0", "give a length in mm"),
            ("--damping", "" if 0 < damping <= 1 else f"{damping:g} is not in 0 to 1", "1 takes the whole correction"),
        ):
            if fault:
                raise CaseError([Problem(key, fault, remedy)])
        self.target, self.tolerance, self.damping = target, tolerance, damping
        tables = read_tables(case_file, settings)
        self.case = StampingCase.from_tables(tables)
        if self.case.trim:
            fault = "the drawn flange is compared with the target, and a trim line would cut it"
            raise CaseError([Problem("trim", fault, "leave the trim lines out")], case_file)
        model = build(self.case)
        self.data: dict[str, Any] = tomllib.loads(write_as_run(tables.data, case_file.parent))
        self.element_size = getattr(self.case.blank, "element_size", None) or _mean_size(model)
        self.draws: list[Draw] = []

    def open_folder(self, folder: Path, resume: bool, overwrite: bool) -> None:
        """Create the folder, or see that it may be used."""
        present = open_search_folder(folder, "draw_*", resume, overwrite)
        self.folder = open_output_folder(folder)
        for path in present if overwrite else ():
            delete_folder(path)

    def run(
        self,
        most: int,
        runner: Runner,
        resume: bool,
        on_progress: Callable[[int, Progress], None] | None,
        on_draw: Callable[[Draw], None] | None,
    ) -> tuple[Status, str]:
        """Draw and correct until the flange fits; return how it ended, and why not well."""
        from presswork.study.blank_plot import draw_outlines

        outline: FloatArray | None = None
        for number in range(most):
            folder = self.folder / f"draw_{number:02d}"
            try:
                model = build(self.write_case(number, outline))
                show = None if on_progress is None else lambda now, n=number: on_progress(n, now)
            except CaseError as error:
                return "gave_up", f"draw {number} cannot be started: {error}"
            ended, reason = compute_member(model, folder, runner, resume, show)
            if ended == "interrupted":
                return "interrupted", f"draw {number}: {reason}"
            if ended != "completed":
                reason_before = " cannot be started" if ended == "bad_input" else ""
                return "gave_up", f"draw {number}{reason_before}: {reason}"
            fit = fit_flange(Result(folder), self.target)
            self.draws.append(Draw(number, folder, fit, read_summary(folder)["wall_seconds"]["total"]))
            write_table(self.folder / TABLE, [self.row(draw) for draw in self.draws])
            draw_outlines(self.draws, self.target, self.folder)
            if on_draw is not None:
                on_draw(self.draws[-1])
            if fit.worst <= self.tolerance:
                return "completed", ""
            worst = [draw.fit.worst for draw in self.draws]
            if len(worst) > 2 and min(worst[-2:]) > _STUCK * min(worst[:-2]):
                return "gave_up", (
                    f"the last two corrections did not help: the flange is still {min(worst):.3g} mm off, near "
                    f"{self.place_of_worst()}. Smaller elements, a target without sharp corners or less damping may"
                )
            outline = fit.blank + self.damping * fit.correction
        return "gave_up", (
            f"the flange is still {self.draws[-1].fit.worst:.3g} mm off after {most} draws, "
            f"near {self.place_of_worst()}"
        )

    def place_of_worst(self) -> str:
        """Name where the last flange is farthest off."""
        fit = self.draws[-1].fit
        x, y = fit.drawn[int(np.argmax(np.abs(fit.deviation)))]
        return f"({x:.4g}, {y:.4g})"

    def write_case(self, number: int, outline: FloatArray | None) -> StampingCase:
        """Write the case of a draw, and read it back; without an outline that of the case's own blank."""
        name = f"blank_{number:02d}"
        if outline is not None:
            write_outline([outline], self.folder / f"{name}.csv")
        return StampingCase.from_toml(self._write(self.folder / f"{name}.toml", f"{name}.csv", outline is not None))

    def _write(self, path: Path, points: str, is_outlined: bool) -> Path:
        data = dict(self.data)
        if is_outlined:
            kept = {key: value for key, value in self.data["blank"].items() if key in _KEPT}
            data["blank"] = {"shape": "outline", "path": points, "element_size": self.element_size, **kept}
        write_whole(path, tomli_w.dumps(data).encode())
        return path

    def row(self, draw: Draw) -> dict[str, Any]:
        """Return a draw's row of the table."""
        fit = draw.fit
        worst = int(np.argmax(np.abs(fit.deviation)))
        return {
            "draw": draw.number,
            "largest_deviation_mm": float(fit.deviation[worst]),
            "at_x_mm": float(fit.drawn[worst, 0]),
            "at_y_mm": float(fit.drawn[worst, 1]),
            "rms_deviation_mm": float(np.sqrt(np.mean(fit.deviation**2))),
            "share_within_percent": 100.0 * float(np.mean(np.abs(fit.deviation) <= self.tolerance)),
            "blank_area_mm2": _area(fit.blank),
            "flange_area_mm2": _area(fit.drawn),
            "wall_seconds": draw.seconds,
        }

    def leave_best(self) -> None:
        """Write the blank that fitted best as points, drawing and case."""
        best = min(self.draws, key=lambda draw: draw.fit.worst)
        write_outline([best.fit.blank], self.folder / POINTS)
        self._write(self.folder / CASE, POINTS, True)
        try:
            write_outline([best.fit.blank], self.folder / DRAWING)
        except OutputError:
            (self.folder / DRAWING).unlink(missing_ok=True)  # without ezdxf: the points hold the same


def _mean_size(model: Model) -> float:
    """Return the side of a square as large as a blank's mean cell [mm]."""
    corners = model.mesh.points[:, :2][model.mesh.blocks[0].connectivity]
    one, other = corners[:, 2] - corners[:, 0], corners[:, -1] - corners[:, 1]
    return float(np.sqrt(np.mean(0.5 * np.abs(one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0]))))


def _area(outline: FloatArray) -> float:
    x, y = outline.T
    return 0.5 * abs(float(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1))))
