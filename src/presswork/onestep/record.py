# SPDX-License-Identifier: Apache-2.0
"""A one-step run into an output folder: the results file of every procedure, blank.csv, blank.dxf, summary."""

from __future__ import annotations

import hashlib
import platform
import sys
from collections.abc import Callable
from dataclasses import fields
from functools import partial
from pathlib import Path
from time import perf_counter

import numpy as np

from presswork import __version__
from presswork.fields.formability_fields import judge_fields
from presswork.fields.instant import Instant
from presswork.fields.table import compute_fields
from presswork.mesh.topology import find_boundary_edges
from presswork.model import CellBlock, FloatArray, Mesh, OneStepModel, Section
from presswork.onestep.outline import BlankOutline, nest
from presswork.onestep.solve import OneStepResult, solve_one_step
from presswork.results import History, OutputError, append_step, open_output_folder, write_outline, write_summary
from presswork.results.folder import CASE, HISTORY, LOG, RESULTS, SUMMARY
from presswork.results.whole_file import write_whole

STRAIGHT = "one step knows the strains of the part alone: it judges them as if every path had been straight"
"""Note on the forming limit."""
BLANK_POINTS, BLANK_DRAWING = "blank.csv", "blank.dxf"


def run_one_step(
    model: OneStepModel,
    folder: Path | str,
    *,
    overwrite: bool = False,
    threads: int = 0,
    on_iteration: Callable[[int, float], None] | None = None,
) -> tuple[OneStepResult, BlankOutline]:
    """Find a part's blank and write everything to the folder. Raises OutputError, OneStepError, MeshError."""
    started = perf_counter()
    path = open_output_folder(folder, overwrite=overwrite)
    result = solve_one_step(model, threads=threads, on_iteration=on_iteration)
    outline = BlankOutline(tuple(result.blank[rim] for rim in model.rims)).mirrored(model.symmetry)
    write_whole(path / CASE, model.case_text.encode())
    _write_results(path / RESULTS, result)
    write_outline(outline.loops, path / BLANK_POINTS)
    warnings = [*model.notes, *result.notes]
    try:
        write_outline(outline.loops, path / BLANK_DRAWING)
    except OutputError as error:
        warnings.append(str(error))
    write_summary(path / SUMMARY, _summarise(result, outline, warnings, perf_counter() - started))
    history = History(path / HISTORY, ["iteration", "unbalanced"])
    for i, unbalanced in enumerate(result.residuals, start=1):
        history.append({"iteration": i, "unbalanced": unbalanced})
    lines = [f"{i:3d}  unbalanced {r:.2e}" for i, r in enumerate(result.residuals, start=1)]
    write_whole(path / LOG, "\n".join([f"presswork {__version__}: {model.title}", *lines, ""]).encode())
    return result, outline


def identify_model(model: OneStepModel) -> str:
    """Return a digest of all that the blank depends on."""
    digest = hashlib.sha256()
    with np.printoptions(threshold=sys.maxsize, floatmode="unique"):
        for part in fields(model):
            if part.name in ("title", "notes", "case_text"):
                continue
            value = getattr(model, part.name)
            digest.update(f"{part.name} ".encode())
            digest.update(
                np.ascontiguousarray(value).tobytes() if isinstance(value, np.ndarray) else repr(value).encode()
            )
    return digest.hexdigest()


def blank_mesh(result: OneStepResult) -> Mesh:
    """Return the flat blank as a mesh of shells in the part's numbering, at the level of the part's rim."""
    model = result.model
    level = float(np.median(model.points[model.rims[0], 2]))
    points = np.column_stack([result.blank, np.full(len(result.blank), level)])
    section = Section(model.thickness, max(2, model.layers))
    cells = [("shell3_mitc", model.triangles), ("shell4_mitc", model.quadrilaterals)]
    blocks = tuple(CellBlock(name, c, 0, section) for name, c in cells if len(c))
    boundary = find_boundary_edges([block.connectivity for block in blocks])
    everything = np.arange(len(points), dtype=np.int32)
    return Mesh(points, blocks, {"all": everything}, {"boundary": boundary}, boundary)


def _write_results(path: Path, result: OneStepResult) -> None:
    """Write two steps: the flat blank, and the part."""
    mesh = blank_mesh(result)
    flat = {name: np.zeros_like(values) for name, values in result.fields.items()}
    flat["thickness"] = np.full_like(flat["thickness"], result.model.thickness)
    info: dict[str, str | float | FloatArray] = {"title": result.model.title, "analysis": "onestep", "depth": 1.0}
    info |= result.model.material.formability.to_info()
    info["symmetry"] = "".join(axis for axis, wanted in zip("xy", result.model.symmetry, strict=True) if wanted)
    steps: list[tuple[float, FloatArray, dict[str, FloatArray]]] = [
        (0.0, np.zeros_like(mesh.points), flat),
        (1.0, result.model.points - mesh.points, result.fields),
    ]
    for time, displacement, cells in steps:
        now = Instant(result.model, displacement, judged=[(result.model.material.formability, 0)])
        now.find_sheet = partial(dict, cells)
        append_step(path, mesh, time, *compute_fields(now), info=info)


def _summarise(result: OneStepResult, outline: BlankOutline, warnings: list[str], total: float) -> dict[str, object]:
    model, nesting = result.model, nest(outline)
    verdict = judge_fields(result.fields, blank_mesh(result).blocks, model.points, [(model.material.formability, 0)])
    assert verdict is not None, "the fields hold principal strains"
    unheld = float(np.linalg.norm(result.held_force[:2]))
    if result.punch_force > 0 and unheld > 0.1 * result.punch_force:
        warnings.append(
            f"the part would not stay where it is: it needs {unheld / 1e3:.3g} kN sideways beside friction. Is it a "
            "half of a symmetric part, or drawn along another direction?"
        )
    return {
        "status": "completed",
        "reason": "",
        "title": model.title,
        "version": __version__,
        "model": identify_model(model),
        "work": f"{result.iterations} iterations, {result.passes} passes of friction",
        "warnings": warnings,
        "iterations": result.iterations,
        "passes": result.passes,
        "stages": result.stages,
        "cells": len(model.triangles) + len(model.quadrilaterals),
        "wall_seconds": {"total": total, **result.seconds},
        "extremes": {name: [float(v.min()), float(v.max())] for name, v in result.fields.items()},
        "formability": verdict.to_summary() | {"paths": STRAIGHT},
        "punch_force_kN": result.punch_force / 1e3,
        "held_force_N": result.held_force,
        "blank": {
            "area_mm2": outline.area,
            "extent_mm": outline.extent,
            "mass_of_steel_g": outline.area * model.thickness * 7.85e-3,
            "strip": {
                "angle_degree": nesting.angle,
                "pitch_mm": nesting.pitch,
                "width_mm": nesting.width,
                "utilisation_percent": 100.0 * nesting.utilisation,
            },
        },
        "machine": platform.machine(),
    }
