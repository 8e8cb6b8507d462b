# SPDX-License-Identifier: Apache-2.0
"""Heating and cooling without forming: stages in turn, time steps by their error.

A step takes the singly diagonally implicit method of two stages and second order that is L-stable (Alexander 1977),
with g = 1 - 1/sqrt(2), heat content H and heat flows f:

    H(T_1) = H(T_n) + g dt f(T_1)                              at t_n + g dt
    H(T)   = H(T_n) + (1 - g) dt f(T_1) + g dt f(T)            at t_n + dt

Each is a step of backward Euler over g dt, the second with a heat source. Their difference to first order,
T - T_n - (T_1 - T_n)/g = (1/2 - g) dt^2 d2T/dt2, is taken for the error of the step, which is far less; steps grow and
shrink with the square root of it.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from presswork import _core
from presswork.body.heat import measure_ranges, widen
from presswork.implicit.heat_equation import PRESCRIBED, HeatEquation, HeatProblem
from presswork.implicit.progress import IncrementReport
from presswork.interaction.heat.heat_films import Film, make_contacts, make_films, read_at
from presswork.model import COLDEST, HOTTEST, FloatArray, HeatStage, MaskArray, Model
from presswork.outcome import Failed, GaveUpError, IterationLog
from presswork.threads import available_threads
from presswork.timing import Timing

KINDS = (PRESCRIBED, "flux", "convection", "radiation")
"""Kinds of heat that come in; what flows between bodies adds up to nothing."""
GROWTH, SHRINK, SAFETY = 2.0, 0.2, 0.9
REFUSED = 2.0
"""Error over the tolerance above which a step is repeated."""
SMALLEST = 1e-4
"""Smallest time step over the first one: so short a step is taken whatever its error, and a run gives up below it."""
ENOUGH_FOR_THREADS = 10_000
TIME, STAGE, FRACTION, STEPS, SIZE, ITERATIONS, CUTBACKS = range(7)
"""Places in `progress`; SIZE is a part of the stage."""
FIRST_STAGE = 1.0 - np.sqrt(0.5)
"""g above."""


@dataclass(frozen=True)
class _TimeStep:
    """A converged step."""

    temperature: FloatArray
    """(n_points,) [degrees C]."""
    heat: FloatArray
    """Heat that came in by KINDS (4,) [N mm]."""
    error: float
    """Largest one at nodes that are free, as estimated [K]."""
    log: IterationLog


class HeatProcedure:
    """Advances the temperatures of one model through its stages."""

    def __init__(self, model: Model, *, threads: int = 0) -> None:
        assert model.heat is not None
        self.model, self.heat = model, model.heat
        n = len(model.mesh.points)
        threads = threads or (available_threads() if n > ENOUGH_FOR_THREADS else 1)
        _core.set_threads(threads)
        self.timing = Timing("assembly", "solve")
        self._contacts = make_contacts(model)
        pairs = np.concatenate([np.zeros((0, 2), dtype=np.int32), *(film.pairs for film in self._contacts)])
        self.equation = HeatEquation(model, pairs, self.timing, threads)
        self._points = np.ascontiguousarray(model.mesh.points)
        self.state: dict[str, NDArray[np.float64]] = {
            "temperature": self._initial(),
            "rate": np.zeros(n),
            "heat": np.zeros(len(KINDS)),
            "reached": measure_ranges(model, self._initial()),
            "progress": np.zeros(7),
        }
        """temperature (n_points,) [degrees C]; rate of the last step (n_points,) [K/s]; heat that has come in so far by
        KINDS [N mm]; lowest and highest temperature of each material (n_materials, 2) [degrees C]; progress."""
        self.state["progress"][SIZE] = self._first_size()
        self._films: tuple[int, list[Film]] = (-1, [])

    def _initial(self) -> FloatArray:
        model = self.model
        temperature = np.full(len(model.mesh.points), self.heat.initial[0])
        for body, value in zip(model.bodies, self.heat.initial, strict=False):
            temperature[body.points.start : body.points.stop] = value
        return temperature

    def _first_size(self) -> float:
        return self.heat.fixed_step or self.heat.initial_step

    def stored(self) -> float:
        """Heat stored since the start [N mm]."""
        stored, _ = self.equation.conduction.content(self.state["temperature"])
        before, _ = self.equation.conduction.content(self._initial())
        return float((stored - before).sum())

    def remaining(self) -> float:
        """Part of the whole process still to be computed, counted in stage durations."""
        stage, fraction = int(self.state["progress"][STAGE]), self.state["progress"][FRACTION]
        durations = np.array([s.duration for s in self.model.stages])
        done = durations[:stage].sum() + (durations[stage] * fraction if stage < len(durations) else 0.0)
        return float(1.0 - done / durations.sum())

    def advance(self) -> Iterator[IncrementReport]:
        """Compute step after step; self.state is a converged one at each yield. Raises GaveUpError."""
        while int(self.state["progress"][STAGE]) < len(self.model.stages):
            yield self._next_step()

    def _next_step(self) -> IncrementReport:
        progress = self.state["progress"]
        stage, fraction_n = int(progress[STAGE]), float(progress[FRACTION])
        duration = self.model.stages[stage].duration
        points = self._save_points(stage)
        target = float(points[np.searchsorted(points, fraction_n + 1e-12)])
        size, cutbacks = float(progress[SIZE]), []
        smallest, settings = SMALLEST * self.heat.initial_step, self.heat
        while True:
            step = min(size, target - fraction_n)
            if step * (1 + 1e-9) < target - fraction_n < 2 * step and settings.fixed_step is None:
                step = 0.5 * (target - fraction_n)
            fraction = target if step >= (target - fraction_n) * (1 - 1e-9) else fraction_n + step
            found = self._attempt(stage, fraction_n, fraction)
            if isinstance(found, Failed):
                reason, size = found.reason, step * found.factor
                if size < smallest:
                    where = f"stage {self.model.stages[stage].name!r} at {duration * fraction_n:.4g} s"
                    raise GaveUpError(
                        f"{where}: even a step of {duration * step:.1e} s is not solved ({reason}). Look for tables "
                        "that jump, or for films that are out of proportion"
                    )
            elif settings.fixed_step or found.error <= REFUSED * settings.tolerance or step <= smallest:
                break
            else:
                reason, size = f"an error of {found.error:.3g} K", step * self._find_factor(found.error)
                size = max(size, smallest)
            cutbacks.append(f"{duration * step:.3g} s: {reason}")
        self._check_range(stage, duration * fraction, found.temperature)
        self._commit(found, stage, fraction_n, fraction, self._next_size(size, step, found.error), len(cutbacks))
        return IncrementReport(
            number=int(self.state["progress"][STEPS]),
            stage=self.model.stages[stage].name,
            fraction=fraction,
            time=float(self.state["progress"][TIME]),
            log=found.log,
            cutbacks=cutbacks,
            is_save_point=self._is_save_point(fraction == target),
        )

    def _attempt(self, stage: int, fraction_n: float, fraction: float) -> _TimeStep | Failed:
        """Try a step."""
        duration = self.model.stages[stage].duration
        begun, dt, g = duration * fraction_n, duration * (fraction - fraction_n), FIRST_STAGE
        temperature_n, rate = self.state["temperature"], self._foretold(fraction_n)
        first = self._problem(stage, begun + g * dt, g * dt)
        middle = self.equation.solve(first, temperature_n + g * dt * rate)
        if isinstance(middle, Failed):
            return middle
        content, content_n = (self.equation.conduction.content(t)[0] for t in (middle.temperature, temperature_n))
        carried = (1.0 - g) / g * (content - content_n) / (g * dt)
        straight = temperature_n + (middle.temperature - temperature_n) / g
        last = replace(self._problem(stage, duration * fraction, g * dt), source=carried)
        end = self.equation.solve(last, straight)
        if isinstance(end, Failed):
            return end
        off = np.abs(end.temperature - straight)[last.mask == 0]
        log = IterationLog()
        log.extend(middle.log)
        log.extend(end.log)
        shares = (((1.0 - g) * dt, middle.power), (g * dt, end.power))
        heat = sum(
            time * np.array([power[kind][0] if kind in power else 0.0 for kind in KINDS]) for time, power in shares
        )
        return _TimeStep(end.temperature, np.asarray(heat), float(off.max(initial=0.0)), log)

    def _problem(self, stage: int, time: float, dt: float) -> HeatProblem:
        """Return what is asked of backward Euler over dt [s], from the present state to a time of the stage [s]."""
        entries = self.model.stages[stage].heat or HeatStage()
        mask, values = self._prescribe(entries, time)
        return HeatProblem(
            points=self._points,
            temperature_n=self.state["temperature"],
            dt=dt,
            films=self._films_of(stage, entries),
            time=time,
            mask=mask,
            prescribed=values,
        )

    def _check_range(self, stage: int, time: float, temperature: FloatArray) -> None:
        """Raise GaveUpError where a temperature is that of no forming."""
        worst = int(np.argmax(np.maximum(temperature - HOTTEST, COLDEST - temperature)))
        if not COLDEST <= temperature[worst] <= HOTTEST:
            where = ", ".join(f"{x:.4g}" for x in self._points[worst])
            raise GaveUpError(
                f"stage {self.model.stages[stage].name!r} at {time:.4g} s: {temperature[worst]:.5g} degrees C at "
                f"({where}) mm is a temperature of no forming ({COLDEST:g} to {HOTTEST:g}). Look at the fluxes, which "
                "are in kW/m^2, and at the duration"
            )

    def _films_of(self, stage: int, entries: HeatStage) -> list[Film]:
        """Return the films of a stage; the bodies do not move."""
        if self._films[0] != stage:
            self._films = stage, [*self._contacts, *make_films(self.model, entries, self._points)]
        return self._films[1]

    def _prescribe(self, entries: HeatStage, time: float) -> tuple[MaskArray, FloatArray]:
        """Return which nodes have a prescribed temperature, and which; a later entry goes before an earlier one."""
        mask, values = np.zeros(len(self._points), dtype=np.uint8), np.zeros(len(self._points))
        for entry in entries.temperatures:
            nodes = self.model.mesh.node_sets[entry.node_set]
            mask[nodes], values[nodes] = 1, read_at(entry.value, time)
        return mask, values

    def _foretold(self, fraction_n: float) -> FloatArray:
        """Return the rate by which the temperatures go on: none where a stage begins."""
        rate = self.state["rate"]
        return rate if fraction_n > 0.0 else np.zeros(len(rate))

    def _find_factor(self, error: float) -> float:
        if error == 0.0:
            return GROWTH
        return float(np.clip(SAFETY * np.sqrt(self.heat.tolerance / error), SHRINK, GROWTH))

    def _next_size(self, size: float, step: float, error: float) -> float:
        """Return the size of the next step; one cut short by a saved step does not reduce it."""
        if self.heat.fixed_step is not None:
            return self.heat.fixed_step
        wanted = step * self._find_factor(error)
        return min(max(wanted, size) if step < size and wanted >= step else wanted, self.heat.max_step)

    def _commit(
        self, found: _TimeStep, stage: int, fraction_n: float, fraction: float, size: float, cutbacks: int
    ) -> None:
        """Take up a converged step."""
        state, duration = self.state, self.model.stages[stage].duration
        dt = duration * (fraction - fraction_n)
        state["rate"] = (found.temperature - state["temperature"]) / dt
        state["temperature"] = found.temperature
        state["heat"] = state["heat"] + found.heat
        state["reached"] = widen(state["reached"], measure_ranges(self.model, found.temperature))
        p = state["progress"]
        p[TIME] += dt
        p[STEPS] += 1
        p[ITERATIONS] += len(found.log)
        p[CUTBACKS] += cutbacks
        p[SIZE] = size
        p[STAGE], p[FRACTION] = stage, fraction
        if fraction == 1.0:
            p[STAGE], p[FRACTION], p[SIZE] = stage + 1, 0.0, self._first_size()

    def _save_points(self, stage: int) -> FloatArray:
        """Stage fractions at which a step must end and fields are saved; the last is 1."""
        output = self.model.output
        points = list(np.linspace(0, 1, output.steps + 1)[1:]) if output.every == 0 else []
        if stage == len(self.model.stages) - 1:
            points += output.at
        return np.unique(np.round([*points, 1.0], 12))

    def _is_save_point(self, at_target: bool) -> bool:
        every = self.model.output.every
        return at_target or (every > 0 and int(self.state["progress"][STEPS]) % every == 0)
