# SPDX-License-Identifier: Apache-2.0
"""Cost of a shell in the explicit loop: microseconds per shell and cycle, the whole cycle counted.

    python -m benchmarks.explicit_shells
    python -m benchmarks.explicit_shells --threads 1 --sizes 100
    python -m benchmarks.explicit_shells --tables      what looking hardening up in a table saves, by law
    python -m benchmarks.explicit_shells --gain        two threads against one, in turn, on the wall clock

A flat sheet is stretched equally in both directions, five points through the thickness, Swift hardening, every point
plastic in every cycle (checked), no contact; double precision but for the column that says single. One thread: CPU
time, which other processes on the machine disturb least; more threads: wall time. Each figure is the least of the
repeats; the columns with one layer, and with an elastic sheet, say what the layers and the plastic update cost.
"""

from __future__ import annotations

import argparse
import time
from itertools import product

import numpy as np

from presswork import _core
from presswork.explicit.shells import Device, ExplicitShells, Precision, ShellOptions

MISES = _core.YieldFunction.hill1948([0.5, 0.5, 0.5, 1.5, 1.5, 1.5])
SWIFT = _core.SheetLaw(207e3, 0.3, MISES, _core.HardeningLaw.swift, [565.0, 0.007, 0.26])
ELASTIC = _core.SheetLaw(207e3, 0.3, MISES, _core.HardeningLaw.linear, [1e9, 0.0])
RATE = 200.0
"""Stretching [1/s]; a step strains by 3e-5."""


def stretched_sheet(
    n: int, law: _core.SheetLaw, options: ShellOptions, precision: Precision = "double", device: Device = "cpu"
) -> ExplicitShells:
    """Return n x n shells of 1 mm, 0.8 mm thick, in uniform stretching, edges driven."""
    x, y = np.meshgrid(np.arange(n + 1.0), np.arange(n + 1.0))
    points = np.stack([x.ravel(), y.ravel(), 0 * x.ravel()], axis=1)
    first = (np.arange(n)[None, :] + (n + 1) * np.arange(n)[:, None]).ravel()
    cells = np.stack([first, first + 1, first + n + 2, first + n + 1], axis=1).astype(np.int32)
    shells = ExplicitShells(points, cells, 0.8, law, 7.85e-9, options=options, precision=precision, device=device)
    velocity = np.zeros((len(points), 6))
    velocity[:, :2] = RATE * (points[:, :2] - n / 2)
    shells.velocity = velocity
    edge = np.flatnonzero((points[:, :2] == 0).any(axis=1) | (points[:, :2] == n).any(axis=1))
    for i, letter in enumerate("uvwpqr"):
        shells.fix(edge, letter, velocity[edge, i])
    return shells


def time_cycle(
    n: int, threads: int, repeats: int, law: _core.SheetLaw, options: ShellOptions, precision: Precision = "double"
) -> float:
    """Return microseconds per shell and cycle, the least of the repeats."""
    _core.set_threads(threads)
    clock = time.process_time if threads == 1 else time.perf_counter
    shells = stretched_sheet(n, law, options, precision)
    shells.advance(max(4, round(0.005 / RATE / shells.dt)))
    before = shells.equivalent_plastic_strain
    cycles = max(4, round(1.2e6 / n**2))
    best = np.inf
    for _ in range(repeats):
        started = clock()
        shells.advance(cycles)
        best = min(best, clock() - started)
    if law is SWIFT:
        plastic = (shells.equivalent_plastic_strain > before).mean()
        assert plastic == 1.0, f"{plastic:.1%} of the points are plastic"
    return best / cycles / n**2 * 1e6


def print_gain_of_tables(repeats: int, n: int = 60) -> None:
    """Print microseconds per shell and cycle of general sheet laws, by formula and by table, measured in turn."""
    alpha = [0.4865, 1.3783, 0.7536, 1.0246, 1.0363, 0.9036, 1.2321, 1.4858]
    yields = {
        "Hill 1948": _core.YieldFunction.hill1948([0.36, 0.36, 0.64, 1.5, 1.5, 1.4]),
        "Barlat 1989, 8": _core.YieldFunction.barlat1989(1.1, 1.05, 0.97, 1.02, 8),
        "Yld2000-2d, 8": _core.YieldFunction.yld2000(alpha, 8),
    }
    points = [value for p in np.linspace(0, 1, 6) for value in (p, 160 + 400 * p, 400.0)]
    curves = {
        "swift": [565.32, 0.007117, 0.2589],
        "voce": [160.0, 400.0, 12.0],
        "swift_voce": [0.4, 565.32, 0.007117, 0.2589, 160.0, 400.0, 12.0],
        "monotone_table": points,
    }
    _core.set_threads(1)
    for name, function in yields.items():
        for curve, parameters in curves.items():
            law = _core.SheetLaw(207e3, 0.3, function, _core.HardeningLaw[curve], parameters)
            runs = [stretched_sheet(n, law, ShellOptions(tabulate=tabulate)) for tabulate in (False, True)]
            best = [np.inf, np.inf]
            for shells in runs:
                shells.advance(max(4, round(0.005 / RATE / shells.dt)))
            for _ in range(repeats):
                for i, shells in enumerate(runs):
                    started = time.process_time()
                    shells.advance(30)
                    best[i] = min(best[i], (time.process_time() - started) / 30 / n**2 * 1e6)
            print(f"{name:15} {curve:15} {best[0]:8.3f} {best[1]:8.3f}  {100 * (1 - best[1] / best[0]):4.0f} %")


def print_gain_of_threads(sizes: list[int], rounds: int = 60) -> None:
    """Print microseconds per shell and cycle, of one thread and two in turn, and how many times faster two are."""
    print(f"{'shells':>9} {'precision':>9} {'one':>16} {'two':>16} {'ratio':>16}   each: least, lower quartile, median")
    precisions: list[Precision] = ["double", "single"]
    for n, precision in product(sizes, precisions):
        shells = stretched_sheet(n, SWIFT, ShellOptions(), precision)
        shells.advance(max(4, round(0.005 / RATE / shells.dt)) if n < 500 else 8)
        cycles, taken = max(2, round(3e5 / n**2)), np.empty((2, rounds if n < 500 else rounds // 5))
        for k in range(taken.shape[1]):
            for threads in (1, 2):
                _core.set_threads(threads)
                started = time.perf_counter()
                shells.advance(cycles)
                taken[threads - 1, k] = (time.perf_counter() - started) / cycles / n**2 * 1e6
        one, two = np.quantile(taken, [0, 0.25, 0.5], axis=1).T
        ratio = (one[0] / two[0], one[1] / two[1], np.median(taken[0] / taken[1]))
        figures = [" ".join(f"{x:.3f}" for x in one), " ".join(f"{x:.3f}" for x in two)]
        print(f"{n * n:9,} {precision:>9} {figures[0]:>16} {figures[1]:>16} {' '.join(f'{x:.2f}' for x in ratio):>16}",
              flush=True)  # fmt: skip


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--sizes", type=int, nargs="+", default=[50, 100, 200, 400], help="shells along an edge")
    parser.add_argument("--threads", type=int, nargs="+", default=[1, 2])
    parser.add_argument("--repeats", type=int, default=7)
    parser.add_argument("--tables", action="store_true", help="compare hardening by formula and by table instead")
    parser.add_argument("--columns", nargs="+", help="some of the columns")
    parser.add_argument("--gain", action="store_true", help="compare two threads with one instead")
    given = parser.parse_args()
    if given.gain:
        return print_gain_of_threads(given.sizes)
    if given.tables:
        return print_gain_of_tables(given.repeats)
    columns: dict[str, tuple[_core.SheetLaw, ShellOptions] | tuple[_core.SheetLaw, ShellOptions, Precision]] = {
        "BT": (SWIFT, ShellOptions(warping=False, hourglass="stiffness")),
        "BWC": (SWIFT, ShellOptions(hourglass="stiffness")),
        "physical": (SWIFT, ShellOptions()),
        "single": (SWIFT, ShellOptions(), "single"),
        "general law": (SWIFT, ShellOptions(tabulate=False)),
        "elastic": (ELASTIC, ShellOptions()),
        "one layer": (SWIFT, ShellOptions(n_points=1)),
        "MITC4+": (SWIFT, ShellOptions(element="shell4_mitc_plus")),
        "MITC4+ single": (SWIFT, ShellOptions(element="shell4_mitc_plus"), "single"),
    }
    columns = {name: columns[name] for name in given.columns or columns}
    print(f"{_core.architecture}, packs of {_core.pack_width}; microseconds per shell and cycle")
    print(f"{'shells':>9} {'threads':>8} " + " ".join(f"{name:>13}" for name in columns))
    for n in given.sizes:
        for threads in given.threads:
            figures = [time_cycle(n, threads, given.repeats, *what) for what in columns.values()]
            print(f"{n * n:9,} {threads:8} " + " ".join(f"{figure:13.4f}" for figure in figures), flush=True)


if __name__ == "__main__":
    main()
