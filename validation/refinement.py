# SPDX-License-Identifier: Apache-2.0
"""Blanks that are refined as they are formed beside blanks as fine from the start: what is lost, what is won.

    python -m validation.refinement OUT [docs/img/refinement.png]
    python -m validation.refinement OUT key=value ...

The first prints thickness strains, draw-in, punch force and time of the square cup and of the hemispherical punch, some
ten minutes on one core, and draws the cups' meshes. The second prints them for the refined cup as it is, and with each
key in turn.
"""

from __future__ import annotations

import sys
from pathlib import Path
from time import perf_counter, process_time

import numpy as np

from presswork import Result
from presswork.case import build_model, read_case
from presswork.examples import copy_example
from presswork.post.section import cut_sheet, measure_draw_in
from presswork.process.explicit.stamping import ExplicitStamping
from presswork.recorder import run_model
from presswork.results import load_checkpoint

CASES = {"square_cup": (4.0, 2), "hemispherical_punch": (6.0, 2)}
"""Side of the coarse shells [mm], and levels."""
ANGLE = 10
SIDE, DIAGONAL = 0.0, 0.25 * np.pi


def form(folder: Path, name: str, element_size: float, *overrides: str) -> Result:
    """Run a packaged example with another side of shells [mm]."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / f"{name}.toml").unlink(missing_ok=True)
    case = read_case(copy_example(name, folder), [f"blank.element_size={element_size}", *overrides])
    outcome = run_model(build_model(case), folder / "out", overwrite=True, threads=1)
    assert outcome.status == "completed", outcome.reason
    return outcome.result


def form_all(folder: Path, name: str, *overrides: str) -> dict[str, Result]:
    """Run a case coarse, refined and fine, without ironing, whose share of the holder's force depends on the shells."""
    size, levels = CASES[name]
    plain = ("explicit.ironing=false", *overrides)
    return {
        "coarse": form(folder / name / "coarse", name, size, *plain),
        "refined": form_refined(folder / name / "refined", name, *overrides),
        "fine": form(folder / name / "fine", name, size / 2**levels, *plain),
    }


def form_refined(folder: Path, name: str, *overrides: str) -> Result:
    size, levels = CASES[name]
    refine = f'blank.refine={{levels = {levels}, angle = "{ANGLE} deg"}}'
    return form(folder, name, size, "explicit.ironing=false", refine, *overrides)


def compare_keys(folder: Path, name: str, keys: list[str]) -> None:
    """Print the figures of a refined blank as it is, and with each of some keys."""
    for number, overrides in enumerate([(), *((key,) for key in keys)]):
        started = process_time()
        result = form_refined(folder / f"{number}", name, *overrides)
        print(*overrides or ("as it is",), f"{process_time() - started:.1f} s of CPU")
        print(f"  {'largest force':18s} {result.history['punch.force'].max():9.0f} N")
        for what, value in measure(result).items():
            print(f"  {what:18s} {value:9.4f}")


def time_shells(results: dict[str, Result], rounds: int = 6, cycles: int = 300) -> dict[str, float]:
    """Return the least time of a shell and cycle [us] of the final states, which are timed in turn."""
    at_end = {}
    for name, result in results.items():
        at_end[name] = ExplicitStamping(build_model(read_case(result.folder / "case.toml")), threads=1)
        at_end[name].load_arrays(load_checkpoint(result.folder / "checkpoint.h5")[0])
    least = dict.fromkeys(results, np.inf)
    for _ in range(rounds):
        for name, run in at_end.items():
            started = perf_counter()
            run.shells.advance(cycles, velocity_scale=0.0)
            each = (perf_counter() - started) / cycles / len(run.shells.connectivity)
            least[name] = min(least[name], 1e6 * each)
    return least


def thickness_along(result: Result, angle: float, ways: np.ndarray) -> np.ndarray:
    """Thickness strain at distances from the middle of the undeformed blank [mm], along a ray [rad]."""
    section = cut_sheet(result, angle)
    return np.interp(ways, section.distance, result.field("thickness_strain")[section.cell])


def count_shell_cycles(result: Result) -> float:
    """Cycles times shells, over the whole run."""
    words = result.summary["work"].split()  # N cycles of M shells, the mean of all cycles
    return float(words[0]) * float(words[3])


def measure(result: Result) -> dict[str, float]:
    """Figures to compare: thickness strain, draw-in [mm], mean punch force of the last tenth of the stroke [kN]."""
    force, wall = result.history["punch.force"], result.summary["wall_seconds"]
    strain = result.field("thickness_strain")
    return {
        "thinnest": float(strain.min()),
        "thickest": float(strain.max()),
        "draw-in, side": measure_draw_in(result, SIDE),
        "draw-in, diagonal": measure_draw_in(result, DIAGONAL),
        "punch force": 1e-3 * float(force[-len(force) // 10 :].mean()),
        "kinetic": float(result.history["kinetic_energy"].max() / result.history["internal_energy"][-1]),
        "balance": float(np.abs(result.history["energy_error_percent"]).max()),
        "shell cycles [1e6]": 1e-6 * count_shell_cycles(result),
        "seconds": float(wall["total"] - wall["output"]),
    }


def draw(results: dict[str, Result], path: str) -> None:
    """Draw the refined and the fine cup, coloured by thickness strain."""
    from presswork.view.plots.shell_plot import plot_shell
    from presswork.view.style import new_figure

    figure = new_figure(11.0, 4.6)
    for part, name in zip(figure.subfigures(1, 2), ("refined", "fine"), strict=True):
        plot_shell(results[name], "thickness_strain", figure=part)
    figure.savefig(path, dpi=130)


if __name__ == "__main__":
    if any("=" in given for given in sys.argv[2:]):
        sys.exit(compare_keys(Path(sys.argv[1]), "square_cup", sys.argv[2:]))
    for case_name in CASES:
        found = form_all(Path(sys.argv[1]), case_name)
        figures = {name: measure(result) for name, result in found.items()}
        print(case_name)
        for key in figures["fine"]:
            print(f"  {key:18s}", *(f"{name} {of[key]:9.4f}" for name, of in figures.items()))
        ways = np.linspace(2.0, 48.0, 47)
        for label, angle in (("side", SIDE), ("diagonal", DIAGONAL)):
            fine = thickness_along(found["fine"], angle, ways)
            off = {name: np.abs(thickness_along(found[name], angle, ways) - fine) for name in ("coarse", "refined")}
            parts = [f"{run} {values.max():.4f} (mean {values.mean():.4f})" for run, values in off.items()]
            print(f"  thickness strain along the {label}, off by", *parts)
        print("  microseconds a shell and cycle:", {name: round(t, 3) for name, t in time_shells(found).items()})
        print("  shells:", {name: result.summary["work"] for name, result in found.items()})
        if len(sys.argv) > 2 and case_name == "square_cup":
            draw(found, sys.argv[2])
