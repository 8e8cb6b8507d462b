# SPDX-License-Identifier: Apache-2.0
"""A die over a run as a table and in words."""

from __future__ import annotations

import csv
import io
from pathlib import Path

import numpy as np

from presswork.dies.life import judge_life
from presswork.dies.study import DieInstant, DieStudy, PartStress, name_part
from presswork.results.whole_file import write_whole


def write_table(study: DieStudy, path: Path) -> None:
    """Write a row for the joined die, step -1, and one for each instant: forces, deflection, stress and safety."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    names = [part.name.replace(" ", "_") for part in study.judge(study.joined)]
    kinds = ("von_mises_MPa", "x_mm", "y_mm", "tension_MPa", "tension_x_mm", "tension_y_mm", "safety_yield",
             "safety_tension")  # fmt: skip
    head = ["step", "time_s", "part", "force_x_N", "force_y_N", "deflection_mm"]
    writer.writerow([*head, *(f"{name}.{kind}" for name in names for kind in kinds)])
    writer.writerow([-1, 0, 0, 0, 0, 0, *_list_values(study.judge(study.joined))])
    for now in study.instants:
        first = [now.time, now.part, *now.force, study.find_deflection(now).value]
        writer.writerow([now.step, *map(_write, first), *_list_values(study.judge(now.answer))])
    write_whole(path, text.getvalue().encode())


def describe(study: DieStudy) -> list[str]:
    """Return lines for the printed summary: the joined die, if it has rings, then the largest values of each part."""
    lines = []
    if len(study.structure.body.parts) > 1:
        lines += [f"{study.tool}, joined: {_describe(part, part, '', '')}" for part in study.judge(study.joined)]
        joints = [study.find_joint(study.joined, ring)[0] for ring in range(1, len(study.structure.body.parts))]
        lines += [f"{study.tool}, joined: {name_part(n)} presses by {p:.4g} MPa" for n, p in enumerate(joints, 1)]
    hardest = max(study.instants, key=lambda now: float(np.linalg.norm(now.force)))
    x, y = hardest.force / 1e3
    moved = study.find_deflection(hardest).value
    lines.append(f"{study.tool}: largest force ({x:.4g}, {y:.4g}) kN{_when(hardest)}, profile moved by {moved:.4g} mm")
    judged = [study.judge(now.answer) for now in study.instants]
    for number in range(len(study.structure.body.parts)):
        own = [parts[number] for parts in judged]
        hard = max(range(len(own)), key=lambda k: own[k].von_mises.value)
        drawn = max(range(len(own)), key=lambda k: own[k].tension.value)
        when = [_when(study.instants[k]) for k in (hard, drawn)]
        lines.append(f"{study.tool}: {_describe(own[hard], own[drawn], *when)}")
    for part, life in zip(judged[0], judge_life(study), strict=True):
        if life is not None:
            parts = f"{life.value:.3g}" if np.isfinite(life.value) else "endless"
            x, y = life.place
            where = f" at ({x:.4g}, {y:.4g}) mm" if np.isfinite(life.value) else ""
            lines.append(f"{study.tool}: {part.name} parts until a crack begins: {parts}{where}")
    return lines


def _when(now: DieInstant) -> str:
    return f" at {100 * now.part:.0f} %"


def _describe(hard: PartStress, drawn: PartStress, when_hard: str, when_drawn: str) -> str:
    """Return the largest stresses of a part at two instants, and its safety, in words."""
    return f"{hard.name}" + ",".join(
        f" {name} {peak.value:.4g} MPa{when} at ({peak.place[0]:.4g}, {peak.place[1]:.4g}) mm{_write_safety(safety)}"
        for name, peak, when, safety in (
            ("von Mises", hard.von_mises, when_hard, hard.safety_yield),
            ("largest principal", drawn.tension, when_drawn, drawn.safety_tension),
        )
    )


def _write_safety(safety: float | None) -> str:
    return "" if safety is None else f" (safety {safety:.3g}{': FAILS' if safety < 1.0 else ''})"


def _list_values(parts: list[PartStress]) -> list[str]:
    """Return the columns of all parts."""
    values = [
        value
        for part in parts
        for value in (
            part.von_mises.value, *part.von_mises.place, part.tension.value, *part.tension.place, part.safety_yield,
            part.safety_tension,
        )
    ]  # fmt: skip
    return [_write(value) for value in values]


def _write(value: float | None) -> str:
    return "" if value is None else f"{value:.7g}"
