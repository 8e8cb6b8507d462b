# SPDX-License-Identifier: Apache-2.0
"""Explicit dynamics: central differences over blocks of elements, `n` cycles a call in C++ (cpp/explicit/loop.hpp).

What runs in the plane (solids.py) and in space (space.py, shells.py) share. Units are mm, s, t, N, MPa.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from presswork import _core, stop
from presswork.explicit.arrays import LoopState, RunArrays, to_loop, to_state
from presswork.explicit.divided import DividedLoop
from presswork.explicit.energy import EnergyBalance, MassScaling, compute_balance, sum_energies
from presswork.explicit.input_checks import ExplicitError
from presswork.explicit.motion import Motion
from presswork.explicit.nodal_motion import Array, NodalMotion, Numbers
from presswork.explicit.resident import ResidentLoop
from presswork.law.umat import STATUS_MESSAGES
from presswork.state import State

Loop = _core.PlaneLoop | _core.SpaceLoop | _core.SpaceLoopSingle | DividedLoop
Failed = tuple[int, _core.LawStatus, int]
"""Element that has failed, what its law reported, and the cycle; the element is -1 where none has."""
SAFETY = 0.9
"""Time step over the bound of the stable one."""
RENEWAL = 10
"""Cycles after which `run_to` finds the stable step anew."""
LONGER = 0.01
"""Part by which the elements must allow a longer step before one is taken."""
CRUSHED = 1e-3
"""Least stable step over the first step: a cell that needs a shorter one gives no useful result and would take for
ever."""
PHASES = ("nodes", "elements", "contact", "waiting")


def count_even_steps(span: float, allowed: float, before: float) -> int:
    """Return into how many equal steps a span of time [s] is divided, none of them longer than allowed [s].

    before: the last step [s], which is kept where it can be. Steps that change again and again feed energy into
    vibrations (docs/theory/explicit.md), so a longer one is taken only where LONGER more is allowed.

    >>> count_even_steps(10.5, allowed=1.0, before=1.0)
    11
    >>> count_even_steps(10.5, allowed=1.05, before=10.5 / 11)
    11
    >>> count_even_steps(10.5, allowed=1.07, before=10.5 / 11)
    10
    """
    longest = min(max(before, (1.0 - LONGER) * allowed), allowed)
    return int(np.ceil(span / longest * (1 - 1e-9)))


class Dynamics(NodalMotion):
    """Blocks of elements in explicit dynamics."""

    safety: float = SAFETY
    """Time step of `run_to` over the bound of the stable one."""
    _resident: ResidentLoop | None = None
    """The loop on a device, where there is one."""

    def __init__(
        self,
        loop: Loop,
        nodes: Numbers,
        elements: Numbers,
        node_sets: Mapping[str, npt.NDArray[np.integer[Any]]] | None = None,
        fastest: float = np.inf,
    ) -> None:
        """Begin with a loop that has its blocks.

        nodes, elements: number, as given, of each in the order of the loop. node_sets: names of nodes. fastest: speed
        of sound [mm/s], beyond which a velocity must be a mistake.
        """
        super().__init__(loop, nodes, elements, node_sets, fastest)
        self._parts: DividedLoop | None = loop if isinstance(loop, DividedLoop) else None
        self._scales = (0.0, 1.0, 1.0)
        self.cycle = 0
        self.time = 0.0
        self.dt = SAFETY * self.stable_step()
        self._dt_before = self._first_dt = self.dt
        self._full_step = 0.0

    # --- time step and mass ------------------------------------------------------------------------------------------

    def bound_frequencies(self) -> Array:
        """Give the bound of each element's highest frequency squared (n) [1/s2] as it is now."""
        return self._by_element(self._loop.bound_frequencies())

    @property
    def first_step(self) -> float:
        """Stable time step of the elements as they were at first [s]."""
        return self._first_dt / SAFETY

    def stable_step(self) -> float:
        """Give the bound of the stable time step [s] of the elements as they are now."""
        highest = self._parts.highest_frequency if self._parts else self._loop.bound_frequencies().max()
        return float(2.0 / np.sqrt(highest))

    def scale_mass(self, target_step: float) -> MassScaling:
        """Add mass to elements whose stable step is below the target [s], take the target as the step; report the mass.

        The safety factor is kept: the elements' bound becomes target_step/safety. Mass once added stays. The kinetic
        energy that it brings is no error of the balance.
        """
        if not target_step > 0:
            raise ExplicitError(f"target_step = {target_step}: it must be above zero")
        before = self._energy_with_mass()
        factor = self._loop.bound_frequencies() * (0.5 * target_step / self.safety) ** 2
        self._loop.scale_mass(np.maximum(factor, 1.0))
        self.dt = target_step
        self._masses_have_changed()
        if self._reference:
            start, largest = self._reference
            self._reference = (start + self._energy_with_mass() - before, largest)
        return self.added_mass()

    def drop_added_mass(self, elements: npt.NDArray[np.bool_]) -> None:
        """Take from elements (n) what was added to their mass; the kinetic energy that it has is no error either."""
        before, true, added = self._energy_with_mass(), self._loop.true_mass, self._loop.added_mass
        self._loop.scale_mass(np.where(elements[self._elements], true / (true + added), 1.0))
        self._masses_have_changed()
        if self._reference:
            start, largest = self._reference
            self._reference = (start + self._energy_with_mass() - before, largest)

    def take_off(self, velocity: Array) -> None:
        """Take velocities (n_nodes, freedoms) [mm/s, 1/s] off those of the nodes; what energy goes is no error."""
        before, reference = self._energy_with_mass(), self._reference
        self.velocity = self.velocity - velocity
        if reference:
            self._reference = (reference[0] + self._energy_with_mass() - before, reference[1])

    def added_mass(self) -> MassScaling:
        """Give the state of mass scaling."""
        added = self._loop.added_mass
        return MassScaling(float(self._loop.true_mass.sum()), float(added.sum()), int((added > 0).sum()))

    @property
    def true_mass(self) -> Array:
        """Mass of each element without what was added (n) [t]."""
        return self._by_element(self._loop.true_mass)

    def _energy_with_mass(self) -> float:
        """Return the energy whose change by added mass is no error of the balance."""
        return sum_energies(self._energies(*self._scales))

    def _masses_have_changed(self) -> None:
        """Bring up to date what depends on masses."""

    # --- cycles ------------------------------------------------------------------------------------------------------

    def _last_step(self) -> float:
        """Return the step that has led here [s]: velocities stand half of it back."""
        return self._dt_before

    def _prepare(self, velocity_scale: Array) -> None:
        """Drive what acts on the nodes through the next cycles, one for each scale."""

    def _check(self) -> None:
        """Raise ExplicitError where a call has ended in what no result should be taken from."""

    def _advance_loop(self, force_scale: Array, velocity_scale: Array, damping: float) -> Failed:
        """Run a cycle for each scale."""
        failed: Failed = self._loop.advance(
            self.time, self.dt, self._last_step(), force_scale, velocity_scale, damping=damping
        )
        return failed

    def advance(
        self,
        n: int,
        *,
        force_scale: float | npt.ArrayLike = 1.0,
        velocity_scale: float | npt.ArrayLike = 1.0,
        damping: float = 0.0,
    ) -> None:
        """Advance n cycles of `dt`, which may be changed between calls.

        force_scale, velocity_scale: factors on force and on prescribed velocities (of walls and tools too), one or one
        a cycle. damping: mass damping [1/s]; a mode of angular frequency w loses the fraction damping/(2 w) of
        critical. Raises ExplicitError when an element is turned inside out, its law fails, or the motion is no longer
        finite.
        """
        if n < 1:
            raise ExplicitError(f"n = {n}: advance at least one cycle")
        force, velocity = np.empty(n), np.empty(n)
        force[:], velocity[:] = force_scale, velocity_scale
        self._prepare(velocity)
        if self._reference is None:
            self._begin_balance(damping, float(force[0]), float(velocity[0]))
        failed, status, cycle = self._advance_loop(force, velocity, damping)
        if failed >= 0:
            when = f"in cycle {self.cycle + cycle + 1} (t = {self.time + (cycle + 1) * self.dt:g} s)"
            raise ExplicitError(self._explain(int(self._elements[failed]), status, when))
        self._scales = (damping, float(force[-1]), float(velocity[-1]))
        self._dt_before = self.dt
        self.cycle += n
        self.time += n * self.dt
        gone = self._find_gone()
        if gone >= 0:
            allowed = self.safety * self.stable_step()
            now = f" (the elements allow {allowed:g} s now)" if np.isfinite(allowed) else ""
            raise ExplicitError(
                f"node {gone} has no finite position by cycle {self.cycle} (t = {self.time:g} s): the step "
                f"{self.dt:g} s is too long{now}, its elements have collapsed, or their material law has failed"
            )
        self._check()

    def _find_gone(self) -> int:
        """Return a node whose place is not finite; -1 where there is none."""
        if self._loop.is_finite:
            return -1
        gone = ~np.isfinite(self.position).all(axis=1)
        return int(np.argmax(gone)) if gone.any() else -1

    def _begin_balance(self, *scales: float) -> None:
        """Count the energies of the run from now on."""
        self._scales = (scales[0], scales[1], scales[2])
        start = sum_energies(self._energies(*self._scales))
        self._reference = (start, abs(start))

    def _explain(self, element: int, status: _core.LawStatus, when: str) -> str:
        """Return why an element has failed, and what to do."""
        if status == _core.LawStatus.done:
            return (
                f"cell {element} is turned inside out {when}: shorten the step {self.dt:g} s (the cells allow "
                f"{self.safety * self.stable_step():g} s now), refine the mesh, or set explicit.hourglass_stiffness "
                "higher"
            )
        return f"{STATUS_MESSAGES[status]} in cell {element} {when}: shorten the step {self.dt:g} s"

    def run_to(
        self, end: float, *, damping: float = 0.0, target_step: float | None = None, motion: Motion | None = None
    ) -> None:
        """Run to the time `end` [s], with an even step that follows the elements' own: found anew every 10 cycles.

        target_step [s]: where the elements' own is shorter, mass is added as by scale_mass. motion: how long walls and
        prescribed velocities have gone at their speed [s], by a time; e.g. SmoothStroke(T, T) starts them smoothly,
        stops them after T, and takes them as far as T at their speed would. Without it they go at their speed. Raises
        ExplicitError where an element is so crushed that its step is a thousandth of the first.
        """
        if not end > self.time:
            raise ExplicitError(f"end = {end:g} s: it must lie beyond the time reached, {self.time:g} s")
        while end - self.time > 1e-9 * end:
            self.dt = self.safety * self.stable_step()
            if target_step is not None and self.dt < target_step * (1 - 1e-9):
                self.scale_mass(target_step)
            if self.dt < CRUSHED * self._first_dt:
                raise ExplicitError(
                    f"cell {np.argmax(self.bound_frequencies())} is crushed at t = {self.time:g} s: its step is "
                    f"{self.dt:.3g} s, that of the mesh was {self._first_dt:.3g} s at first: refine the mesh, make it "
                    "coarser in the direction in which it is crushed, or give explicit.target_step"
                )
            self._full_step = self.dt  # before it is made shorter to end in time
            left = count_even_steps(end - self.time, self.dt, self._dt_before)
            self.dt = (end - self.time) / left
            n = min(left, RENEWAL)
            scale: float | Array = 1.0
            if motion is not None:
                scale = np.diff(motion.position(np.linspace(self.time, self.time + n * self.dt, n + 1))) / self.dt
            self.advance(n, velocity_scale=scale, damping=damping)
            stop.look()

    # --- what has come of it -----------------------------------------------------------------------------------------

    @property
    def seconds(self) -> dict[str, float]:
        """Wall time of `advance` by phase [s]: of nodes, elements, contact with tools and beads, and of waiting."""
        return dict(zip(PHASES, self._loop.seconds, strict=True))

    def _energies(self, damping: float, force_scale: float, velocity_scale: float) -> _core.Energies:
        # velocities stand half of the last step back: so long is the way to now, whatever the next step will be
        dt = self._last_step()
        energies: _core.Energies = self._loop.energies(
            dt, dt, damping=damping, force_scale=force_scale, velocity_scale=velocity_scale
        )
        return energies

    def energies(
        self, *, damping: float | None = None, force_scale: float | None = None, velocity_scale: float | None = None
    ) -> EnergyBalance:
        """Give the energies now; damping and scales of the next cycle are those of the last one unless given."""
        given = zip((damping, force_scale, velocity_scale), self._scales, strict=True)
        scales = tuple(last if value is None else value for value, last in given)
        balance, reference = compute_balance(self._energies(*scales), self._reference)
        if self._reference:
            self._reference = reference
        return balance

    def state(self) -> State:
        """Give everything that the next cycle depends on; nodes and cells are in the order of the loop.

        Left out is what the constructor, fix, force, and those who add tools, beads and walls are given again.
        """
        return self._name_state({**self._loop.state(), RunArrays.owner: self._dump_run()})

    def _name_state(self, arrays: LoopState) -> State:
        """Return the State of a loop's arrays and those of its run."""
        return to_state(arrays)

    def take_state(self, state: State) -> None:
        """Take over what state gave, and its arrays may have been changed since. Raises ExplicitError as restore."""
        self.restore(state.to_arrays())

    def state_as_given(self) -> State:
        """Give what state does, with nodes and cells in the order given: what another mesh takes over."""
        return self.state()

    def take_state_as_given(self, state: State) -> None:
        """Take over what state_as_given gave. Raises ExplicitError as restore does."""
        self.take_state(state)

    def dump(self) -> dict[str, npt.NDArray[np.generic]]:
        """Give the arrays of state as `owner.name`."""
        return self.state().to_arrays()

    def keep(self) -> Callable[[], dict[str, npt.NDArray[np.generic]]] | None:
        """Keep the present state where the cycles are computed, if not here; return what gives it, until kept anew.

        On a device, and on ranks, where a run is not restored otherwise until it has been given.
        """
        keeper = self._resident or self._parts
        if not keeper:
            return None
        run, kept = self._dump_run(), keeper.keep()
        return lambda: self._name_state({**kept(), RunArrays.owner: run}).to_arrays()

    def _dump_run(self) -> dict[str, Array]:
        """Return what the loop does not keep."""
        return {
            "clock": np.array([self.cycle, self.time, self.dt, self._dt_before]),
            "energy": np.array(self._reference or (np.nan, np.nan)),
            "scales": np.array(self._scales),
        }

    def restore(self, dump: Mapping[str, npt.NDArray[Any]]) -> None:
        """Take over what dump gave: the run goes on with the same bits as one never stopped.

        Names of other owners are left alone. Raises ExplicitError where mesh, elements, laws, walls, tools or beads are
        not those that it is of.
        """
        arrays = to_loop(dump)
        own = arrays.pop(RunArrays.owner, {})
        try:
            self._loop.restore(arrays)
        except ValueError as error:
            remedy = "" if "mesh" in str(error) else ": add them in the same order before restore"
            raise ExplicitError(f"{error}{remedy}") from None
        self._restore_run(own)

    def _restore_run(self, own: Mapping[str, Array]) -> None:
        cycle, self.time, self.dt, self._dt_before = own["clock"].tolist()
        self.cycle = int(cycle)
        start, largest = own["energy"].tolist()
        self._reference = None if np.isnan(start) else (start, largest)
        damping, force, velocity = own["scales"].tolist()
        self._scales = (damping, force, velocity)
