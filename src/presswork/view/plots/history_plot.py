# SPDX-License-Identifier: Apache-2.0
"""Curves of history.csv: force against stroke, of one run or of several."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from presswork.model import FloatArray
from presswork.results import Result, ResultError
from presswork.view.history_marks import mark_history
from presswork.view.plots.operation_plot import choose_strokes, find_idle, find_operations
from presswork.view.style import (
    begin_at_zero,
    break_at_parts,
    clean_axes,
    name_part,
    new_figure,
    require_matplotlib,
)
from presswork.view.tool_course import count_operations

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def plot_history(
    results: Result | Sequence[Result],
    x: str | None = None,
    y: str | None = None,
    ax: Axes | None = None,
    *,
    labels: Sequence[str] | None = None,
) -> Axes:
    """Draw columns of the history against each other; several runs go into one diagram.

    Without x and y: force [kN] against stroke [mm] of every tool that moves, and of a stamping's beads, or against the
    angle of those that turn; without such tools reaction against displacement of every set that is moved.
    With `y` alone, x is the angle or stroke of the same tool, the displacement of the same set, or the time. `labels`
    name the runs, by default after their folders. Raises ResultError for an unknown column, or if nothing moves.
    """
    runs = [results] if isinstance(results, Result) else list(results)
    names = list(labels) if labels is not None else name_runs(runs)
    require_matplotlib()
    ax = new_figure(6.4, 4.2).subplots() if ax is None else ax
    drawn: list[tuple[str, str]] = []
    for run, name in zip(runs, names, strict=True):
        history = run.history
        curves = _choose_columns(run, history, x, y)
        for abscissa, ordinate in curves:
            parts = [name] if len(runs) > 1 else []
            parts += [ordinate.partition(".")[0]] if len(curves) > 1 else []
            shown = break_at_parts(history, _values(history, ordinate))
            abscissae = np.array(_values(history, abscissa))
            shown[1:][np.diff(count_operations(run)) > 0] = np.nan  # no line where tools are placed
            abscissae[find_idle(run, ordinate.partition(".")[0])] = np.nan
            ax.plot(abscissae, shown, label=", ".join(parts), linewidth=1.8)
        drawn += curves
    ax.set_xlabel(_label(sorted({abscissa for abscissa, _ in drawn})))
    parts_of_whole = {name_part(run) for run in runs if any(is_of_part(run.history, name) for _, name in drawn)}
    ax.set_ylabel(_label(sorted({ordinate for _, ordinate in drawn}), ", ".join(sorted(parts_of_whole - {""}))))
    if len(runs) == 1:
        ax.set_title(str(runs[0].info.get("title", "")))
        mark_history(ax, runs[0], drawn)
    if len(drawn) > 1:
        ax.legend(frameon=False)
    begin_at_zero(ax)
    clean_axes(ax)
    return ax


def plot_energies(result: Result, ax: Axes | None = None) -> Axes:
    """Draw energies and work [J] against time; of dynamics 5 % of the internal one too: kinetic should lie below."""
    require_matplotlib()
    ax = new_figure(6.4, 4.2).subplots() if ax is None else ax
    history = result.history
    time = 1e3 * history["time"]
    for column in find_energies(history):
        ax.plot(time, 1e-3 * history[column], label=column.removesuffix("_energy").replace("_", " "), linewidth=1.6)
    if "kinetic_energy" in history:
        ax.plot(time, 0.05e-3 * history["internal_energy"], "k--", linewidth=0.9, label="5 % of internal")
    ax.set_xlabel("time [ms]")
    ax.set_ylabel(f"energy {part} [J]" if (part := name_part(result)) else "energy [J]")
    ax.set_title(str(result.info.get("title", "")))
    ax.legend(frameon=False, fontsize="small")
    begin_at_zero(ax)
    clean_axes(ax)
    return ax


def find_dies(history: dict[str, NDArray[Any]]) -> list[str]:
    """Return the tools with a cavity that metal fills."""
    return [name.removesuffix(".fill") for name in history if name.endswith(".fill")]


def find_energies(history: dict[str, NDArray[Any]]) -> list[str]:
    """Return the columns of energies and work."""
    return [name for name in history if name.endswith(("_energy", "_work"))]


def find_moving_tools(history: dict[str, NDArray[Any]]) -> list[str]:
    """Return the tools whose stroke is not zero throughout."""
    tools = [name.removesuffix(".stroke") for name in history if name.endswith(".stroke")]
    return [tool for tool in tools if np.any(history[f"{tool}.stroke"] != 0)]


def find_turning_tools(history: dict[str, NDArray[Any]]) -> list[str]:
    """Return the tools whose angle is not zero throughout."""
    tools = [name.removesuffix(".angle") for name in history if name.endswith(".angle")]
    return [tool for tool in tools if np.any(history[f"{tool}.angle"] != 0)]


def find_moved_sets(history: dict[str, NDArray[Any]]) -> list[tuple[str, str]]:
    """Return the columns of displacement or rotation, and of reaction, of every set that is moved."""
    pairs = []
    for name in history:
        base, _, quantity = name.rpartition(".")
        for moved, force in (("displacement_", "force_"), ("rotation_", "moment_")):
            reaction = f"{base}.{force}{quantity.removeprefix(moved)}"
            if quantity.startswith(moved) and reaction in history and np.any(history[name] != 0):
                pairs.append((name, reaction))
    return pairs


def plot_stress_strain(result: Result, name: str = "", ax: Axes | None = None) -> Axes:
    """Draw nominal stress [MPa] over nominal strain [%] of a set that is moved along one axis, as a tension test does.

    Nominal stress is the reaction over the undeformed area of the set, nominal strain its displacement over the
    undeformed length of the body. The highest stress is marked. name: of the set, by default the first. Raises
    ResultError if no set moves so.
    """
    curves = stress_strain(result)
    if not curves or (name and name not in curves):
        raise ResultError(f"{result.folder}: no set {name or 'at all'} is moved along one axis")
    require_matplotlib()
    ax = new_figure(6.4, 4.2).subplots() if ax is None else ax
    strain, stress = curves[name or next(iter(curves))]
    ax.plot(100 * strain, stress, linewidth=1.8)
    top = int(np.argmax(np.abs(stress)))
    if 0 < top < len(stress) - 1:
        ax.plot(100 * strain[top], stress[top], "o", markersize=4, color="black")
        text = f"{stress[top]:.4g} MPa at {100 * strain[top]:.3g} %"
        ax.annotate(text, (100 * strain[top], stress[top]), (0, -24), textcoords="offset points", ha="center")
    ax.set_xlabel("nominal strain [%]")
    ax.set_ylabel("nominal stress [MPa]")
    ax.set_title(str(result.info.get("title", "")))
    clean_axes(ax)
    return ax


def stress_strain(result: Result) -> dict[str, tuple[FloatArray, FloatArray]]:
    """Return nominal strain and stress [MPa] of every set that is moved along one axis, from nothing on (n + 1,)."""
    history, found = result.history, {}
    for moved, force in find_moved_sets(history):
        name = moved.rpartition(".")[0]
        gauge = result.info.get(f"gauge_{name}")
        if gauge is not None and ".force_" in force:
            area, length, side = gauge
            strain, stress = side * history[moved] / length, side * history[force] / area
            found[name] = (np.append(0.0, strain), np.append(0.0, stress))
    return found


def _choose_columns(
    result: Result, history: dict[str, NDArray[Any]], x: str | None, y: str | None
) -> list[tuple[str, str]]:
    """Return the pairs of columns to draw, all of them in the history."""
    if y is not None:
        tool = y.partition(".")[0]
        strokes = [f"{tool}.{quantity}" for quantity in ("angle", "stroke") if f"{tool}.{quantity}" in history]
        strokes += [moved for moved, force in find_moved_sets(history) if force == y]
        pairs = [(x or [*strokes, "time"][0], y)]
    else:
        moving = find_moving_tools(history)
        if result.is_stamping and moving and not result.is_line:  # holders hardly move: all over one stroke
            main = max(moving, key=lambda tool: float(np.abs(history[f"{tool}.stroke"]).max()))
            beads = [name for name in history if name.startswith("bead_") and name.endswith(".force")]
            return [(x or f"{main}.stroke", name) for name in (*(f"{tool}.force" for tool in moving), *beads)]
        turning = [(x or f"{tool}.angle", f"{tool}.force") for tool in find_turning_tools(history)]
        own = find_operations(result) if result.is_line else []
        over = {tool: stroke for each in own for tool, stroke in choose_strokes(result, each).items()}
        pairs = turning or [(x or f"{over.get(tool, tool)}.stroke", f"{tool}.force") for tool in moving]
        pairs = pairs or [(x or moved, force) for moved, force in find_moved_sets(history)]
    if not pairs:
        raise ResultError(f"{result.folder}: nothing has moved, there is no curve of force; choose x and y")
    for name in {name for pair in pairs for name in pair}:
        if name not in history or name == "stage":
            known = ", ".join(column for column in history if column != "stage")
            raise ResultError(f"{result.folder} has no history column {name}; there are: {known}")
    return pairs


def name_runs(runs: Sequence[Result]) -> list[str]:
    """Return the runs' folder names, with their parents where they would be the same."""
    folders = [run.folder.resolve() for run in runs]
    names = [folder.name for folder in folders]
    return names if len(set(names)) == len(names) else [f"{folder.parent.name}/{folder.name}" for folder in folders]


def _values(history: dict[str, NDArray[Any]], column: str) -> FloatArray:
    """Return a column, forces in kN, torques in N m."""
    return np.asarray(history[column] * (1e-3 if _is_large(column) else 1.0), dtype=np.float64)


def _is_large(column: str) -> bool:
    quantity = column.rpartition(".")[2]
    return "force" in quantity or "moment" in quantity or quantity == "torque"


def is_of_part(history: Mapping[str, NDArray[Any]], column: str) -> bool:
    """Return whether a column counts what is computed alone, not the whole: energies, work, heat, reactions of sets."""
    name, _, quantity = column.rpartition(".")
    if quantity.startswith(("force_", "moment_")):
        return bool(name) and f"{name}.force" not in history  # tools have their force, of the whole
    return quantity.endswith(("_energy", "_work")) or quantity.startswith("heat_")


def _label(columns: Sequence[str], part: str = "") -> str:
    """Return a label with unit; a tool is named if there is only one; part: of the whole that the columns are of."""
    tool, _, quantity = columns[0].rpartition(".")
    units = {f"displacement_{axis}": " [mm]" for axis in "xyz"}
    units |= {f"rotation_{axis}": " [degree]" for axis in "xyz"} | {f"moment_{axis}": " [N m]" for axis in "xyz"}
    units |= {
        "flash_thickness": " [mm]",
        "fill": " [part of the cavity's wall]",
        "stroke": " [mm]",
        "time": " [s]",
        "angle": " [degree]",
        "torque": " [N m]",
    }
    unit = " [kN]" if "force" in quantity else units.get(quantity, "")
    own = f"{tool} " if tool and len(columns) == 1 else ""
    return f"{own}{quantity.replace('_', ' ')}{' ' + part if part else ''}{unit}"
