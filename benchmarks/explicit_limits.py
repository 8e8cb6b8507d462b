# SPDX-License-Identifier: Apache-2.0
"""How far the explicit loop's default shell stands from the limits of arithmetic and of memory.

    python -m benchmarks.explicit_limits

The operations of a shell and cycle are counted by a number that counts, sent through the same kernel (five points, all
plastic); the CPU's vector operations are timed on their own, eight that do not wait for each other. `limit`: all
operations one after the other at that pace, every addition fused with a multiplication as far as there are both, or
none of them. `kernel`: the shell with nothing to load. The loop: 10,000 and 1,000,000 shells, one and two threads.
Bytes of a cycle are counted from the arrays that it reads and writes, beside the machine's triad.
"""

from __future__ import annotations

from benchmarks.explicit_shells import SWIFT, time_cycle
from benchmarks.machine import measure_machine, run_program
from presswork.explicit.shells import ShellOptions

STATE = 8 * (18 + 5 * 4)
"""Bytes of a shell's state: 18 values of its own and 4 at each of five points."""
NODE = 8 * (8 + 4 + 6)
"""Bytes of a node's motion, position and internal force; there is a node a shell in a large sheet."""
LISTS = 4 * (4 + 4 + 3)
"""Bytes of connectivity and of the lists that sum up nodal forces, only read."""


def main() -> None:
    """Print the table."""
    printed, machine = run_program("explicit_limits.cpp"), measure_machine()
    if printed is None or machine is None:
        raise SystemExit("this needs a C++ compiler, and found none")
    count = {name: float(value) for name, value in (line.split() for line in printed.splitlines())}
    adds, multiplies, choices = count["adds"], count["multiplies"], count["choices"]
    print(
        f"a shell and cycle: {adds:.0f} additions, {multiplies:.0f} multiplications, {count['divides']:.0f} divisions, "
        f"{count['roots']:.0f} square roots, {choices:.0f} comparisons and choices"
    )
    slow = count["divides"] * count["divide"] + count["roots"] * count["root"] + choices * count["single"]
    fused = min(adds, multiplies) * count["fused"] + abs(adds - multiplies) * count["single"]
    limits = {"fused": fused + slow, "not fused": (adds + multiplies) * count["single"] + slow}
    print(
        f"vectors of {count['lanes']:.0f}: "
        + ", ".join(f"{n} {count[n]:.2f} ns" for n in ("fused", "single", "divide", "root"))
    )
    for name, limit in limits.items():
        print(f"limit of arithmetic, {name}: {limit / count['lanes']:.0f} ns a shell")
    print(f"kernel: {count['kernel']:.0f} ns a shell")
    moved = 2 * STATE + 2 * NODE + LISTS
    for n in (100, 1000):
        for threads in (1, 2):
            loop = time_cycle(n, threads, 7, SWIFT, ShellOptions())
            print(
                f"{n * n:9,} shells, {threads} thread{'s' if threads > 1 else ''}: {1000 * loop:.0f} ns, "
                f"{moved / loop / 1e3:.1f} GB/s of {machine[str(threads)]['bandwidth'] / 1e9:.0f}"
            )


if __name__ == "__main__":
    main()
