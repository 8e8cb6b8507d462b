# SPDX-License-Identifier: Apache-2.0
"""Speed of a device in the explicit loop: shells a second, the whole cycle counted, by size, precision and tools.

    python -m benchmarks.explicit_device                       on the first NVIDIA card: 10,000 to 4 million shells
    python -m benchmarks.explicit_device --element shell4_mitc_plus
    python -m benchmarks.explicit_device --solids              hexahedra and tetrahedra in place of shells
    python -m benchmarks.explicit_device --device host --sizes 20 --repeats 2    the card's code on the CPU, a trial

The sheet of explicit_shells.py, stretched equally in both directions, every point plastic; with tools that of
explicit_contact.py between two planes, where every node is near both in every cycle. Wall time of a call, the least of
the repeats. With --solids the cube of explicit_space.py, with the CPU's loop on all threads beside it. Bytes are those
of the arrays that a cycle reads and writes, each counted once for either, so the share of the card's bandwidth is at
least what is printed. What crosses the bus is counted.
"""

from __future__ import annotations

import argparse
import time

import numpy as np

from benchmarks import explicit_contact, explicit_shells
from benchmarks.explicit_contact import pressed_sheet
from benchmarks.explicit_shells import SWIFT, stretched_sheet
from benchmarks.explicit_space import LAWS, upset_cube
from presswork import _core
from presswork.explicit.shells import Device, ExplicitShells, Precision, ShellOptions
from presswork.explicit.space_solids import ExplicitSpaceSolids
from presswork.model import ExplicitElement

BANDWIDTH = {"H200": 4.8e12, "H100": 3.35e12, "A100": 2.0e12}
"""By the makers' data sheets [bytes/s]; of another card give --bandwidth."""
HEAD_ROWS = {"shell4_1pt": 18, "shell4_mitc_plus": 39}
"""Of a shell's state before its layers."""
LAYER_ROWS, PAIR_BYTES = 4, 96


def count_bytes(run: ExplicitShells, precision: Precision) -> float:
    """Return the bytes that a cycle reads and writes for each shell of a large sheet, one node a shell."""
    real, options = (8 if precision == "double" else 4), run.options
    points = options.n_points * (4 if options.element == "shell4_mitc_plus" else 1)
    carried = 2 if precision == "single" else 1  # each value with what rounding has taken from it
    state = 2 * real * (HEAD_ROWS[options.element] + carried * LAYER_ROWS * points)
    corners = 2 * real * 6 * 4 + 2 * 4 * 4  # forces left and gathered, nodes and the list of corners
    move = 2 * (32 + 8 * real) + 6 * real * 3 + 1 + 2 * 16  # place, motion; forces, prescribed; held, work
    see = 32 + 8 * real + 6 * real  # by elements, and the gathered force
    tools = len(run.tools) * 2 * PAIR_BYTES + 32 + 8 * real + 2 * 6 * real if run.tools else 0
    return float(state + corners + move + see + tools)


def time_cycles(run: ExplicitShells | ExplicitSpaceSolids, cycles: int, repeats: int) -> tuple[float, float]:
    """Return the seconds of a cycle, the least of the repeats, and the bytes over the bus for each."""
    run.advance(max(4, cycles))
    best, before = np.inf, run.traffic
    for _ in range(repeats):
        started = time.perf_counter()
        run.advance(cycles)
        best = min(best, time.perf_counter() - started)
    now = run.traffic
    return best / cycles, (now.sent + now.fetched - before.sent - before.fetched) / repeats / cycles


def print_solids(device: Device, sizes: list[int], repeats: int) -> None:
    """Print the table of solids, on the device and by the CPU's loop."""
    print(f"{'element':>10} {'cells':>10} {'device':>6} {'M cells/s':>10} {'us a cycle':>11} {'bus [B a cycle]':>15}")
    devices: list[Device] = [device, "cpu"]
    for element in ("hex8_1pt", "tet4_nodal"):
        for n in sizes:
            for where in devices:
                run = upset_cube(n, element, LAWS["swift"], where)
                cells = len(run.mesh.blocks[0].connectivity)
                most = 3e-5 / run.dt / (repeats + 1)  # an upset by a third
                seconds, bus = time_cycles(run, round(max(4, min(most, 2e7 / cells))), repeats)
                print(f"{element:>10} {cells:10,} {where:>6} {cells / seconds * 1e-6:10.3f} {seconds * 1e6:11.1f} "
                      f"{bus:15.0f}", flush=True)  # fmt: skip


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--device", choices=["cuda", "host"], default="cuda")
    parser.add_argument("--sizes", type=int, nargs="+", help="shells along an edge, or cells")
    parser.add_argument("--solids", action="store_true", help="in place of shells")
    parser.add_argument("--element", choices=list(HEAD_ROWS), default="shell4_1pt")
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--bandwidth", type=float, help="of the device's memory [bytes/s]")
    given = parser.parse_args()
    device: Device = given.device
    element: ExplicitElement = given.element
    cards, why = _core.list_cuda_cards()
    if device == "cuda" and not cards:
        parser.error(f"{why}: on a machine without a card give --device host")
    name = cards[0][0] if device == "cuda" else f"host build on {_core.architecture}"
    bandwidth = given.bandwidth or next((rate for card, rate in BANDWIDTH.items() if card in name), None)
    explicit_shells.RATE = explicit_contact.RATE
    print(f"{name}, {'solids' if given.solids else element}; each cycle whole")
    if given.solids:
        return print_solids(device, given.sizes or [20, 40, 80, 120], given.repeats)
    print(f"{'shells':>10} {'precision':>9} {'tools':>5} {'M shells/s':>11} {'us a cycle':>11} {'bytes a shell':>13} "
          f"{'bandwidth':>9} {'bus [B a cycle]':>15}")  # fmt: skip
    precisions: list[Precision] = ["double", "single"]
    for n in given.sizes or [100, 316, 1000, 2000]:
        for precision in precisions:
            for tools in (False, True):
                if tools and element != "shell4_1pt":
                    continue
                run = (
                    pressed_sheet(n, False, False, precision, device)
                    if tools
                    else stretched_sheet(n, SWIFT, ShellOptions(element=element), precision, device)
                )
                seconds, bus = time_cycles(
                    run, max(4, min(1000, round(2e8 / n**2 if device == "cuda" else 4e4 / n**2))), given.repeats
                )
                size, rate = count_bytes(run, precision), n * n / seconds
                share = f"{size * rate / bandwidth:9.1%}" if bandwidth else f"{'-':>9}"
                print(f"{n * n:10,} {precision:>9} {'two' if tools else 'none':>5} {rate * 1e-6:11.3f} "
                      f"{seconds * 1e6:11.1f} {size:13.0f} {share} {bus:15.0f}", flush=True)  # fmt: skip


if __name__ == "__main__":
    main()
