# SPDX-License-Identifier: Apache-2.0
"""Dies corrected for springback: form, release, move the tools against the deviation, form again.

Displacement adjustment (Gan and Wagoner 2004, Die design method for sheet springback, Int. J. Mech. Sci. 46, 1097),
then by how each place's curvature answers (`curvature_steps`). DIR/loop_00 ... are the runs, DIR/case_00.toml and
DIR/tools_00 ... their cases and tools; table.csv and deviation.png show the course. The best tools are left as
TOOL.stl, TOOL.step and compensated.toml.
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
from presswork.case.stamping.target_part import read_target_part
from presswork.mesh.files.stl_file import pack_stl
from presswork.model import FloatArray, IntArray, Model
from presswork.post.released_part import Misfit, ReleasedPart, read_face_strain, read_released
from presswork.post.springback import find_formed_step
from presswork.recorder import Progress
from presswork.results import Result, open_output_folder
from presswork.results.folder import delete_folder, find_members
from presswork.results.whole_file import write_whole
from presswork.study.compensated_tools import (
    PressedTool,
    Undercut,
    bend_tools,
    cut_into_triangles,
    find_closed,
    find_gap_change,
    find_room,
    find_undercut,
    place_tools,
)
from presswork.study.compensation_goal import Goal, NotThePartError, check_case, set_goal
from presswork.study.curvature_steps import CurvatureSteps
from presswork.study.one_member import compute_member, open_search_folder
from presswork.study.open_runner import open_runner
from presswork.study.runner import Runner
from presswork.study.table import read_summary, write_table
from presswork.study.tool_faces import SheetInTools, write_faces

TABLE, CASE = "table.csv", "compensated.toml"
_STUCK, _PATIENCE = 0.9, 3
"""Deviation over the best before it, from which on a loop has not helped; so many of them end the search."""
_LONGEST = 1.0
"""Edges of the tools' triangles over those of the blank's cells: at 1.5 facets move the part by 0.01 mm."""
_SLAMS_REFUSED = 0.5
"""Thicknesses of free travel from which on a holder is closed by distance, where a case has been refused."""
_LEANS_MOST, _ROOM, _HALVINGS = 6.0, 0.9, 3
"""Lean of tools [degree] from which on their stroke must leave this room, over the thickness, and how often steps to
tools that leave less are cut."""
_NEAR = 3.0
"""Gap between tools over the thickness within which it counts."""

Status = Literal["completed", "gave_up", "interrupted"]


@dataclass(frozen=True)
class Loop:
    """One set of tools and the part that they made."""

    number: int
    """0: the tools as drawn."""
    folder: Path
    misfit: Misfit
    correction: float
    """Largest displacement of the tools' working faces [mm]."""
    gap_change: float
    """Largest change of the distance between upper tools and die [mm]."""
    undercut: Undercut
    seconds: float

    @property
    def worst(self) -> float:
        """Largest deviation [mm]."""
        return float(np.abs(self.misfit.deviation).max())


@dataclass(frozen=True)
class Compensation:
    """Result of the search for tools."""

    status: Status
    """"gave_up": no tools made a part within the tolerance."""
    reason: str
    folder: Path
    goal: Goal | None
    """None: not even the tools as drawn have made a part."""
    loops: tuple[Loop, ...]

    @property
    def best(self) -> Loop:
        """The loop whose part came nearest to the goal."""
        return min(self.loops, key=lambda loop: loop.worst)


def compensate_springback(
    case_file: Path | str,
    folder: Path | str,
    *,
    tolerance: float,
    target: Path | None = None,
    unit: str = "mm",
    most: int = 6,
    fix_binder: bool = False,
    settings: Sequence[str] = (),
    threads: int = 0,
    member_timeout: float | None = None,
    resume: bool = False,
    overwrite: bool = False,
    on_progress: Callable[[int, Progress], None] | None = None,
    on_loop: Callable[[Loop, dict[str, Any]], None] | None = None,
) -> Compensation:
    """Correct the tools of a stamping until its part, after springback, lies within a tolerance of a goal.

    tolerance: largest distance from the goal along its normal after the best fit [mm]. target: STL, STEP or IGES file
    of a face or the middle of the wanted part, in this unit; None: the part as the tools as drawn form it, closed.
    most: corrections at most.
    fix_binder: the binder under holders stays as it is. settings: `key=value` texts that change the case. threads: of a
    run, 0 for all of the machine. member_timeout: longest time of a run [s], which ends the search. With `resume` runs
    that are there are kept, and one that was stopped goes on. on_loop: called after each, with its row of the table.
    Raises CaseError for a case that cannot be used, OutputError for a folder that cannot.
    """
    search = _Search(Path(case_file), settings, tolerance, target, unit, fix_binder=fix_binder)
    with open_runner(1, None, member_timeout, threads=threads) as runner:
        search.open_folder(Path(folder), resume, overwrite)
        status, reason = search.run(most, runner, resume, on_progress, on_loop)
    if search.loops:
        search.leave_best()
    return Compensation(status, reason, search.folder, search.goal, tuple(search.loops))


class _Search:
    """One search for tools."""

    def __init__(
        self,
        case_file: Path,
        settings: Sequence[str],
        tolerance: float,
        target: Path | None,
        unit: str,
        *,
        fix_binder: bool,
    ) -> None:
        if not tolerance > 0:
            raise CaseError([Problem("--tolerance", f"{tolerance:g} is not > 0", "give a length in mm")])
        self.tolerance, self.fix_binder = tolerance, fix_binder
        tables = read_tables(case_file, settings)
        self.case = StampingCase.from_tables(tables)
        check_case(self.case, fix_binder)
        model = build(self.case)
        self.data: dict[str, Any] = tomllib.loads(write_as_run(tables.data, case_file.parent))
        self.planes = model.symmetry
        size = np.ptp(model.mesh.points[:, :2], axis=0) * np.where(self.planes, 2.0, 1.0)
        self.target = None if target is None else read_target_part(target, unit, float(np.linalg.norm(size)))
        points, cells = model.mesh.points, model.mesh.blocks[0].connectivity
        edge = np.linalg.norm(points[cells[:, 0]] - points[cells[:, 1]], axis=1)
        strokes = sum(abs(a.stroke) for stage in self.case.stages for a in stage.tools.values() if a.stroke)
        self.drawn = cut_into_triangles(model, _LONGEST * float(np.median(edge)), self.case.blank.thickest, strokes)
        self.goal: Goal | None = None
        self.loops: list[Loop] = []
        self.made: list[tuple[PressedTool, ...]] = []
        """Tools of the loops."""

    def open_folder(self, folder: Path, resume: bool, overwrite: bool) -> None:
        """Create the folder, or see that it may be used."""
        present = open_search_folder(folder, "loop_*", resume, overwrite)
        find_members(folder, "tools_*")
        self.folder = open_output_folder(folder)
        for path in present if overwrite else ():
            delete_folder(path)

    def run(
        self,
        most: int,
        runner: Runner,
        resume: bool,
        on_progress: Callable[[int, Progress], None] | None,
        on_loop: Callable[[Loop, dict[str, Any]], None] | None,
    ) -> tuple[Status, str]:
        """Form and correct until the part is within the tolerance; return how it ended, and why not well."""
        from presswork.study.compensation_plot import draw_deviation

        correction: FloatArray | None = None
        steps: CurvatureSteps | None = None
        for number in range(most + 1):
            tools = self.drawn if correction is None else self.bend(correction)
            folder = self.folder / f"loop_{number:02d}"
            try:
                model, lower = self.build_loop(number, tools)
            except CaseError as error:
                return "gave_up", f"loop {number} cannot be started: {self.explain_undercut(tools)}{error}"
            show = None if on_progress is None else lambda now, n=number: on_progress(n, now)
            ended, reason = compute_member(model, folder, runner, resume, show)
            if ended == "interrupted":
                return "interrupted", f"loop {number}: {reason}"
            if ended != "completed":
                reason_before = " cannot be started" if ended == "bad_input" else ""
                return "gave_up", f"loop {number}{reason_before}: {reason}"
            result = Result(folder)
            part, points, triangles = read_released(result)
            if self.goal is None:
                tools = self.drawn = find_closed(self.drawn, result, find_formed_step(result))
                self.goal = self.set_goal(part, points, triangles)
                flat = np.asarray(result.mesh_at(find_formed_step(result)).points)[:, :2]
                self.sheet = SheetInTools(points, flat, triangles, self.planes, self.case.blank.thickest)
                correction = np.zeros_like(points)
                steps = self.goal.begin_steps(self.case.blank.thickest, read_face_strain(result, points))
            assert correction is not None
            assert steps is not None
            misfit = self.goal.measure(part, correction, lower)
            self.add_loop(number, folder, misfit, tools)
            row = self.row(self.loops[-1])
            write_table(self.folder / TABLE, [self.row(loop) for loop in self.loops])
            draw_deviation(self.goal, self.loops, self.tolerance, self.folder)
            if on_loop is not None:
                on_loop(self.loops[-1], row)
            if self.loops[-1].worst <= self.tolerance:
                return "completed", ""
            if self.is_stuck():
                return "gave_up", self.explain_no_help()
            correction = self.shorten(correction, self.goal.advance(steps, correction, misfit.off))
        return "gave_up", (
            f"the part is still {self.loops[-1].worst:.3g} mm off after {most} corrections, "
            f"near {self.place_of_worst()}"
        )

    def is_stuck(self) -> bool:
        """Return whether the last corrections have lowered neither the largest deviation nor the mean."""
        share = self.goal.weight / self.goal.weight.sum() if self.goal else np.zeros(0)
        return len(self.loops) > _PATIENCE and all(
            min(course[-_PATIENCE:]) > _STUCK * min(course[:-_PATIENCE])
            for course in ([loop.worst for loop in self.loops], [_rms(loop, share) for loop in self.loops])
        )

    def bend(self, correction: FloatArray) -> tuple[PressedTool, ...]:
        """Return the tools as drawn with a correction (n_points, 3) [mm]."""
        assert self.goal is not None
        warp = self.goal.make_warp(correction)
        return bend_tools(self.drawn, warp, self.case.blank.thickest, fix_holders=self.fix_binder)

    def shorten(self, before: FloatArray, after: FloatArray) -> FloatArray:
        """Return the next correction, halfway to it where its tools would leave so little room that they tear."""
        for _ in range(_HALVINGS):
            if self.may_pass(self.bend(after)):
                break
            after = 0.5 * (before + after)
        return after

    def may_pass(self, tools: tuple[PressedTool, ...]) -> bool:
        """Return whether tools lean over so little, or leave so much room along the stroke, that the sheet passes."""
        if self.find_undercut(tools, uprights=True).angle <= _LEANS_MOST:
            return True
        assert self.goal is not None
        height = float(np.ptp(self.goal.points[:, 2]))
        return find_room(tools, self.drawn, self.case.blank.thickest, height) >= _ROOM

    def set_goal(self, part: ReleasedPart, points: FloatArray, triangles: IntArray) -> Goal:
        """Return the goal by the part of the tools as drawn. Raises CaseError for a target that is not this part."""
        held = tuple(tool for tool in self.drawn if tool.kind == "holder") if self.fix_binder else ()
        thickness = self.case.blank.thickest
        try:
            return set_goal(part, (points, triangles), held, thickness, self.planes, self.target)
        except NotThePartError as error:
            raise CaseError([Problem("--target", str(error), "give the part that the tools make")]) from error

    def add_loop(self, number: int, folder: Path, misfit: Misfit, tools: tuple[PressedTool, ...]) -> None:
        """Note what tools have made, and what they are like."""
        assert self.goal is not None
        moved = [
            np.linalg.norm(a.shape.points - b.shape.points, axis=1).max()
            for a, b in zip(tools, self.drawn, strict=True)
        ]
        self.made.append(tools)
        self.loops.append(
            Loop(
                number,
                folder,
                misfit,
                float(max(moved)),
                find_gap_change(tools, self.drawn, self.goal.points, _NEAR * self.case.blank.thickest, self.planes),
                self.find_undercut(tools),
                read_summary(folder)["wall_seconds"]["total"],
            )
        )

    def find_undercut(self, tools: tuple[PressedTool, ...], *, uprights: bool = False) -> Undercut:
        """Return where tools lean over farthest against the part; uprights: or a punch above its wall."""
        if self.goal is None:
            return Undercut("", 0.0, np.zeros(3))
        sheet = self.goal.points
        corners = sheet[self.goal.triangles]
        longest = float(np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max())
        reach = _NEAR * self.case.blank.thickest + longest
        return find_undercut(tools, self.drawn, sheet, reach, self.planes, uprights=uprights)

    def explain_undercut(self, tools: tuple[PressedTool, ...]) -> str:
        """Explain tools that lean over so far that others cannot pass; empty where there are none."""
        return self.find_undercut(tools).explain()

    def explain_no_help(self) -> str:
        """Return why the search ends after corrections that did not help."""
        undercut = max((loop.undercut for loop in self.loops), key=lambda found: found.angle)
        return (
            f"the last {_PATIENCE} corrections did not help: {undercut.explain()}the part is still "
            f"{min(loop.worst for loop in self.loops):.3g} mm off, near {self.place_of_worst()}. Smaller elements, "
            "slower tools or a larger tolerance may"
        )

    def place_of_worst(self) -> str:
        """Name where the last part is farthest off."""
        assert self.goal is not None
        x, y, z = self.goal.wanted[int(np.argmax(np.abs(self.loops[-1].misfit.deviation)))]
        return f"({x:.4g}, {y:.4g}, {z:.4g})"

    def build_loop(self, number: int, tools: tuple[PressedTool, ...]) -> tuple[Model, FloatArray]:
        """Return the model of a loop, and by how much its tools close lower.

        Bent tools may leave less than the thickness beside the sheet or, by their facets, on it. As the next loop
        corrects that, too, they are run with a warning. Raises CaseError.
        """
        case, lower = self.write_case(number, tools)
        try:
            return build(case), lower
        except CaseError:
            if not number or not self.case.limits.stop or not self.may_pass(tools):
                raise
        case, lower = self.write_case(number, tools, runs_anyway=True)
        return build(case), lower

    def write_case(
        self, number: int, tools: tuple[PressedTool, ...], *, runs_anyway: bool = False
    ) -> tuple[StampingCase, FloatArray]:
        """Write case and tools of a loop, and read the case back; return by how much its tools close lower, too."""
        folder = self.folder / f"tools_{number:02d}"
        folder.mkdir(exist_ok=True)
        for tool in tools:
            write_whole(folder / f"{tool.name}.stl", pack_stl(tool.kind, tool.shape))
        paths = {tool.name: f"{folder.name}/{tool.name}.stl" for tool in tools}
        closes = {"slams": _SLAMS_REFUSED} if runs_anyway else {}
        data, lower = place_tools(self.case, self.data, tools, self.drawn, paths, **closes)
        if runs_anyway:
            data["limits"] = {**data.get("limits", {}), "stop": False}
        path = self.folder / f"case_{number:02d}.toml"
        write_whole(path, tomli_w.dumps(data).encode())
        return StampingCase.from_toml(path), lower

    def row(self, loop: Loop) -> dict[str, Any]:
        """Return a loop's row of the table."""
        assert self.goal is not None
        size = np.abs(loop.misfit.deviation)
        worst = int(np.argmax(size))
        share = self.goal.weight / self.goal.weight.sum()
        rms = _rms(loop, share)
        before = next((_rms(other, share) for other in self.loops if other.number == loop.number - 1), None)
        return {
            "loop": loop.number,
            "largest_deviation_mm": float(loop.misfit.deviation[worst]),
            **{f"at_{axis}_mm": float(x) for axis, x in zip("xyz", self.goal.wanted[worst], strict=True)},
            "mean_deviation_mm": float(share @ size),
            "rms_deviation_mm": rms,
            "rms_over_last": None if not before else rms / before,
            "share_within_percent": 100.0 * float(share @ (size <= self.tolerance)),
            "largest_correction_mm": loop.correction,
            "largest_gap_change_mm": loop.gap_change,
            "undercut_degrees": loop.undercut.angle,
            "undercut_tool": loop.undercut.tool,
            "wall_seconds": loop.seconds,
        }

    def leave_best(self) -> None:
        """Leave the tools that made the best part, and their case, beside the loops."""
        best = min(self.loops, key=lambda loop: loop.worst)
        text = (self.folder / f"case_{best.number:02d}.toml").read_text(encoding="utf-8")
        data = tomllib.loads(text)
        for name, tool in data["tools"].items():
            write_whole(self.folder / f"{name}.stl", (self.folder / tool["path"]).read_bytes())
            tool["path"] = f"{name}.stl"
        write_whole(self.folder / CASE, tomli_w.dumps(data).encode())
        write_faces(self.folder, self.made[self.loops.index(best)], self.drawn, self.sheet)


def _rms(loop: Loop, share: FloatArray) -> float:
    return float(np.sqrt(share @ loop.misfit.deviation**2))
