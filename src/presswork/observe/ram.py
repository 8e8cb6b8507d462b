# SPDX-License-Identifier: Apache-2.0
"""The ram of a press: its speed, force and energy."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswork.implicit.ram import SPENT
from presswork.model import Blow, Crank, Drive, FloatArray, Model
from presswork.observe.contract import History, Observed, Observer, Row

RAM_COLUMNS = ("ram_speed", "ram_force", "energy_spent", "blow")
"""Speed of the ram [mm/s], force against it [N], what it has spent on the workpiece since the start [N mm], and the
number of the blow, 0 where there is none."""
BORNE = "ram_force_borne"
"""Column of models with a press whose rating the case gives: force that it bears there [N]; nan in other stages."""
KILO = 1e-3
KILO_JOULE = 1e-6
IDLE = 0.01
"""Plastic work over the energy of a blow, below which the blow moves no metal."""


class RamObserver(Observer):
    """The ram of a model that a press drives in some stage."""

    def columns(self, run: Observed) -> list[str]:
        """Return RAM_COLUMNS where there is a ram, and BORNE where its press is rated."""
        return [*(RAM_COLUMNS if has_ram(run.model) else ()), *((BORNE,) if has_rating(run.model) else ())]

    def row(self, run: Observed, *, is_released: bool = False) -> Row:
        """Return what the ram does; it stands still once the part is released."""
        if not has_ram(run.model):
            return {}
        ram = run.ram()
        now = (0.0, 0.0, ram.work, 0) if is_released else (ram.speed, ram.force, ram.work, ram.blow)
        return dict(zip(RAM_COLUMNS, now, strict=True)) | self._find_borne(run, ram.speed, is_released=is_released)

    def _find_borne(self, run: Observed, speed: float, *, is_released: bool) -> Row:
        """Return what the press bears at a speed of the ram [mm/s], where some press is rated."""
        if not has_rating(run.model):
            return {}
        drive = None if is_released else run.model.stages[run.current_stage()].drive
        borne = math.inf if drive is None else drive.force_borne(speed)
        return {BORNE: borne if math.isfinite(borne) else math.nan}

    def summary(self, run: Observed, history: History) -> dict[str, Any]:
        """Return what the ram has done, stage by stage."""
        return summarise_ram(run.model, history)

    def warnings(self, run: Observed, history: History) -> list[str]:
        """Return what a user should know of the ram."""
        return warn_of_ram(run.model, history, run.plastic_shares()) if has_ram(run.model) else []


def has_ram(model: Model) -> bool:
    """Return whether a ram drives any stage."""
    return any(stage.drive is not None for stage in model.stages)


def has_rating(model: Model) -> bool:
    """Return whether the case gives the force that a press bears."""
    return any(stage.drive is not None and math.isfinite(stage.drive.rated_force) for stage in model.stages)


def force_on_ram(model: Model, stage: int, forces: FloatArray) -> float:
    """Return the force against the ram [N], by the forces of the workpiece on the tools (n_tools, 2 | 3) [N]."""
    drive, motions = model.stages[stage].drive, model.stages[stage].tool_motion
    assert drive is not None, "a stage without a ram"
    work = 0.0
    for tool, force in zip(model.tools, forces, strict=True):
        if tool.name in motions:
            work -= float(force @ np.array(motions[tool.name].move[: len(force)]))
    return drive.whole * work / drive.travel


def summarise_ram(model: Model, history: Mapping[str, NDArray[Any]]) -> dict[str, Any]:
    """Return what the ram has done, stage by stage that has one: time, peak force, energy, speed at the end."""
    if not has_ram(model):
        return {}
    found: list[dict[str, Any]] = []
    for name, drive, rows, before in _list_stages(model, history):
        time, energy = (history[column][rows] for column in ("time", "energy_spent"))
        entry: dict[str, Any] = {"stage": name}
        if drive.press:
            entry["press"] = drive.press
        if isinstance(drive.motion, Blow):
            entry |= {"blow": drive.motion.number, "energy_kJ": KILO_JOULE * drive.motion.energy}
        entry |= {
            "energy_spent_kJ": KILO_JOULE * (float(energy[-1]) - before["energy_spent"]),
            "time_s": float(time[-1]) - before["time"],
            "peak_force_kN": KILO * float(history["ram_force"][rows].max()),
            "final_speed_mm_s": float(history["ram_speed"][rows[-1]]),
            **_compare_with_rating(drive, history, rows, before),
        }
        found.append(entry)
    return {"press": found}


def _compare_with_rating(
    drive: Drive, history: Mapping[str, NDArray[Any]], rows: NDArray[np.intp], before: Mapping[str, float]
) -> dict[str, Any]:
    """Return how near the ram has come to the force and energy that its press bears, where the case gives limits."""
    found: dict[str, Any] = {}
    if math.isfinite(drive.rated_force):
        worst = rows[int(np.argmax(history["ram_force"][rows] / history[BORNE][rows]))]
        force, borne, time = (float(history[name][worst]) for name in ("ram_force", BORNE, "time"))
        found = {"force_kN": KILO * force, "rated_there_kN": KILO * borne, "time_s": time}
        if isinstance(drive.motion, Crank):
            found["above_bottom_mm"] = max(drive.motion.start - drive.motion.travel_at(time - before["time"]), 0.0)
    if math.isfinite(drive.rated_energy):
        found["rated_energy_kJ"] = KILO_JOULE * drive.rated_energy
    return {"nearest_to_rating": found} if found else {}


def _warn_of_rating(name: str, drive: Drive, found: Mapping[str, Any]) -> list[str]:
    """Return what a press cannot bear in a stage. found: the stage's entry in the summary."""
    near, warnings, who = found.get("nearest_to_rating", {}), [], f"stage {name!r}: the press {drive.press} "
    if "rated_there_kN" in near and near["force_kN"] > near["rated_there_kN"]:
        at = f", {near['above_bottom_mm']:.3g} mm above bottom dead centre" if "above_bottom_mm" in near else ""
        borne, rated = near["rated_there_kN"], KILO * drive.rated_force
        of = f" (rated {rated:.4g} kN)" if borne < rated else ""
        warnings.append(
            f"{who}bears {borne:.4g} kN{at}{of}, and the ram needs {near['force_kN']:.4g} kN: take a stronger press, "
            "or form lower in its stroke"
        )
    if found["energy_spent_kJ"] > near.get("rated_energy_kJ", math.inf):
        warnings.append(
            f"{who}gives {near['rated_energy_kJ']:.4g} kJ in one stroke, and forming takes "
            f"{found['energy_spent_kJ']:.4g} kJ: take a press with a larger flywheel, or form in more strokes"
        )
    return warnings


def warn_of_ram(model: Model, history: Mapping[str, NDArray[Any]], plastic_share: FloatArray) -> list[str]:
    """Return what a user should know of the ram: more than its press bears, energy that moves nothing or is left.

    plastic_share: plastic work over the work of the ram in each stage (n_stages,).
    """
    entries = summarise_ram(model, history).get("press", [])
    warnings = []
    shares = {stage.name: float(share) for stage, share in zip(model.stages, plastic_share, strict=True)}
    for (name, drive, rows, before), entry in zip(_list_stages(model, history), entries, strict=True):
        who = f"stage {name!r}: "
        warnings += _warn_of_rating(name, drive, entry)
        spent = float(history["energy_spent"][rows[-1]]) - before["energy_spent"]
        if not isinstance(drive.motion, Blow):
            continue
        left = drive.motion.energy - spent
        if left > 2.0 * SPENT * drive.motion.energy:
            if history["ram_force"][rows].max() <= 0.0:
                warnings.append(f"{who}the blow never met the workpiece within its travel of {drive.travel:g} mm")
                continue
            warnings.append(
                f"{who}{KILO_JOULE * left:.4g} of {KILO_JOULE * drive.motion.energy:.4g} kJ are left when the travel "
                f"of the ram, {drive.travel:g} mm, is complete: the dies would clash; take less energy, or more stroke"
            )
        elif shares[name] < IDLE:
            warnings.append(
                f"{who}the blow of {KILO_JOULE * drive.motion.energy:.4g} kJ ends within the elastic range, and moves "
                "no metal: take more energy"
            )
    return warnings


def _list_stages(
    model: Model, history: Mapping[str, NDArray[Any]]
) -> list[tuple[str, Drive, NDArray[np.intp], dict[str, float]]]:
    """Return name, ram and rows of the history of each stage with a ram that has begun, and what stood before it."""
    found = []
    for stage in model.stages:
        rows = np.flatnonzero(history["stage"] == stage.name)
        if stage.drive is None or not len(rows):
            continue
        first = int(rows[0])
        before = {name: float(history[name][first - 1]) if first else 0.0 for name in ("time", "energy_spent")}
        found.append((stage.name, stage.drive, rows, before))
    return found
