# SPDX-License-Identifier: Apache-2.0
"""What each correction of an implicit draw is for, counted by cause: the packaged square cup, a quarter.

    python -m benchmarks.draw_causes [size of the shells in mm] [--stroke 27]

The cause of a correction is what has happened to the node that is most out of balance before it:

    first      the first correction of an attempt
    contact    it has come onto a tool, or left one, in the correction before
    friction   it has begun to slide or to stick
    parabola   it touches a tool where the law of contact begins
    deep       it touches a tool where the law is a straight line
    free       it touches none

Corrections of attempts that failed are counted apart. A row for each number of corrections follows.
"""

from __future__ import annotations

import argparse
import tempfile
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np

from presswork.case import build_model, read_case
from presswork.examples import copy_example
from presswork.implicit.stepping import GaveUpError, ImplicitProcedure
from presswork.interaction.space.space_contact import SpaceForces
from presswork.interaction.space.space_touch import limit_friction
from presswork.outcome import Converged
from presswork.process.implicit.stamping import make_shell_model

SLIDES = 1.0 - 1e-9
"""Of the limit of friction: a node with more slides."""


class Causes:
    """Watches the equilibrium of a procedure and counts."""

    def __init__(self, procedure: ImplicitProcedure) -> None:
        self._procedure, self._equilibrium = procedure, procedure.equilibrium
        self._attempt: list[tuple[str, np.ndarray, np.ndarray]] = []
        self.led_on: Counter[str] = Counter()
        self.in_vain: Counter[str] = Counter()
        self.corrections: Counter[tuple[bool, int]] = Counter()
        self._find, self._solve = self._equilibrium._find_balance, self._equilibrium.solve
        self._equilibrium._find_balance = self._watch
        self._equilibrium.solve = self._count

    def _watch(self, *arguments: Any) -> Any:
        point, balance, has_converged = found = self._find(*arguments)
        if not has_converged:
            own = next(f for f in point.forces if isinstance(f, SpaceForces))
            worst = int(np.abs(balance.lacking / balance.length).max(axis=1).argmax())
            self._attempt.append(self._name(own, worst))
        return found

    def _name(self, own: SpaceForces, worst: int) -> tuple[str, np.ndarray, np.ndarray]:
        """Return the cause, which nodes touch each tool, and which of these slide (n_tools, n_points)."""
        contact, tools = self._procedure.interactions.space_tools.contact, self._procedure.model.space_tools
        push = np.linalg.norm(own.by_tool - own.friction, axis=2)
        drag = np.linalg.norm(own.friction, axis=2)
        limit = np.array([limit_friction(tool.friction, p, None)[0] for tool, p in zip(tools, push, strict=True)])
        touches, slides = push > 0.0, (push > 0.0) & (drag >= SLIDES * limit)
        law = contact.touching(0)
        if not self._attempt:
            cause = "first"
        elif (touches != self._attempt[-1][1])[:, worst].any():
            cause = "contact"
        elif (slides != self._attempt[-1][2])[:, worst].any():
            cause = "friction"
        elif not touches[:, worst].any():
            cause = "free"
        else:
            cause = "deep" if (push > law.spring * law.rounding)[:, worst].any() else "parabola"
        return cause, touches, slides

    def _count(self, *arguments: Any, **options: Any) -> Any:
        self._attempt = []
        outcome = self._solve(*arguments, **options)
        succeeded = isinstance(outcome, Converged)
        (self.led_on if succeeded else self.in_vain).update(cause for cause, *_ in self._attempt)
        self.corrections[succeeded, len(self._attempt)] += 1
        return outcome


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("size", nargs="?", type=float, default=4.0)
    parser.add_argument("--stroke", type=float, default=27.0)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        keys = ['procedure="implicit"', f"stages.0.tools.punch.stroke={arguments.stroke}"]
        case = read_case(copy_example("square_cup", Path(folder)), [*keys, f"blank.element_size={arguments.size}"])
        procedure = ImplicitProcedure(make_shell_model(build_model(case)), threads=1)
    causes = Causes(procedure)
    try:
        for _ in procedure.advance():
            pass
    except GaveUpError as error:
        print(error)
    print("cause        led on  in vain")
    for cause in ("first", "contact", "friction", "parabola", "deep", "free"):
        print(f"{cause:12s}{causes.led_on[cause]:7d}{causes.in_vain[cause]:9d}")
    print("corrections  attempts that led on, that failed")
    for n in sorted({n for _, n in causes.corrections}):
        print(f"{n:11d}{causes.corrections[True, n]:8d}{causes.corrections[False, n]:9d}")


if __name__ == "__main__":
    main()
