# SPDX-License-Identifier: Apache-2.0
"""Show what the tangent must know of friction: residuals of Newton's method in the ring test, by friction tangent.

After Cheng (1995), chapter 3: with friction in the residual only the iteration oscillates already at small m, for every
guess turns the slip, and with it the friction, round; a spring in the tangent (bond element) or the derivative of the
friction law (return mapping) holds it. The packaged ring 6:3:2, its first 120 iterations.
Run: python examples/friction_in_the_tangent.py docs/img/friction_tangents.png
"""

from __future__ import annotations

import sys
from importlib.resources import files
from typing import Any

from presswork.case import Case, build_model
from presswork.implicit.newton import Converged
from presswork.implicit.stepping import GaveUpError, ImplicitProcedure

TANGENTS = {
    "residual": "friction in the residual only",
    "bond": "bond element",
    "return_mapping": "return mapping",
}
FRICTION = (0.1, 0.2, 0.3, 0.5)
MOST, ENOUGH = 40, 120
FORCE_TOLERANCE = 1e-4


Attempt = tuple[list[float], bool]
"""Residuals of one attempt at an increment, and whether it converged."""


def record(m: float, tangent: str) -> tuple[list[Attempt], float]:
    """Return the attempts, in order, and the part of the stroke that they have computed in about ENOUGH iterations.

    A residual is the largest out-of-balance force over the largest nodal force. An attempt that fails is followed by
    one in which friction is soft at first, or by a smaller increment.
    """
    overrides = [f"tools.punch.m={m}", f"solver.friction_tangent={tangent}", f"solver.max_iterations={MOST}"]
    overrides += [f"solver.target_iterations={MOST // 2}"]
    case = Case.from_toml(str(files("presswork.examples") / "ring_compression.toml"), overrides=overrides)
    procedure = ImplicitProcedure(build_model(case), threads=1)
    attempts: list[Attempt] = []
    solve = procedure.equilibrium.solve

    def listen(*arguments: Any, **options: Any) -> Any:
        if sum(len(residuals) for residuals, _ in attempts) > ENOUGH:
            raise StopIteration
        outcome = solve(*arguments, **options)
        attempts.append((outcome.log.residual, isinstance(outcome, Converged)))
        return outcome

    procedure.equilibrium.solve = listen  # type: ignore[method-assign]
    try:
        for _ in procedure.advance():
            pass
    except (GaveUpError, RuntimeError):  # RuntimeError: StopIteration inside the generator
        pass
    return attempts, 1.0 - procedure.remaining()


def draw(path: str, found: dict[tuple[float, str], tuple[list[Attempt], float]]) -> None:
    """Draw a panel for each m and tangent: residual against iteration, the attempts one after the other."""
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(len(FRICTION), 3, figsize=(11, 9), sharex=True, sharey=True, layout="constrained")
    for row, m in zip(axes, FRICTION, strict=True):
        for axis, (tangent, name) in zip(row, TANGENTS.items(), strict=True):
            start = 0
            attempts, reached = found[m, tangent]
            for residuals, converged in attempts:
                places = [start + i for i, r in enumerate(residuals) if r > 0]
                colour = "C0" if converged else "C3"
                axis.semilogy(places, [r for r in residuals if r > 0], ".-", ms=4, lw=1, color=colour)
                start += len(residuals)
            axis.axhline(FORCE_TOLERANCE, color="0.5", lw=0.8, ls=":")
            axis.set_title(f"m = {m:g}, {name}: {100 * reached:.3g} % of the stroke", fontsize=8.5)
            axis.grid(True, color="0.93", lw=0.7)
            axis.spines[["top", "right"]].set_visible(False)
        row[0].set_ylabel("out-of-balance force", fontsize=8)
    for axis in axes[-1]:
        axis.set_xlabel("iteration (red: an attempt that fails)", fontsize=8)
    axes[0, 0].set_ylim(1e-8, 10)
    figure.savefig(path, dpi=110)


def main() -> None:
    """Print the iterations of each attempt; draw if a file is named."""
    found = {(m, tangent): record(m, tangent) for m in FRICTION for tangent in TANGENTS}
    for (m, tangent), (attempts, reached) in found.items():
        done = [len(residuals) for residuals, converged in attempts if converged]
        lost = [len(residuals) for residuals, converged in attempts if not converged]
        print(
            f"m = {m:g}, {TANGENTS[tangent]}: {100 * reached:.3g} % of the stroke, {sum(done)} iterations in "
            f"{len(done)} increments, {sum(lost)} in {len(lost)} attempts that failed"
        )
    if len(sys.argv) > 1:
        draw(sys.argv[1], found)


if __name__ == "__main__":
    main()
