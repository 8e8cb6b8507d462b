# SPDX-License-Identifier: Apache-2.0
"""Heating and cooling without forming: stages in turn, time steps by their error.

Backward Euler adds an error of dt^2/2 d2T/dt2 a step. It is estimated from how far the temperatures lie from those that
the rate of the last step foretold, d = d2T/dt2 (dt^2 + dt dt_n / 2), so as d dt / (2 dt + dt_n); steps grow and shrink
with the square root of it. The first step of a stage has no foretelling: it is short and taken as it comes.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from presswork import _core
from presswork.implicit.heat_equation import PRESCRIBED, HeatEquation, HeatProblem, HeatStep
from presswork.implicit.stepping import IncrementReport
from presswork.interaction.heat_films import Film, make_contacts, make_films, read_at
from presswork.model import COLDEST, HOTTEST, FloatArray, HeatStage, MaskArray, Model
from presswork.outcome import Failed, GaveUpError
from presswork.threads import available_threads
from presswork.timing import Timing

KINDS = (PRESCRIBED, "flux", "convection", "radiation")
"""Ways by which heat comes in; what flows between bodies adds up to nothing."""
GROWTH, SHRINK, SAFETY = 2.0, 0.2, 0.9
REFUSED = 2.0
"""Times the tolerance: an error for which a step is taken again."""
SMALLEST = 1e-4
"""Of the first step: a run gives up below."""
ENOUGH_FOR_THREADS = 10_000
TIME, STAGE, FRACTION, STEPS, LAST, SIZE, ITERATIONS, CUTBACKS = range(8)
"""Places in `progress`; LAST and SIZE are parts of the stage, LAST is 0 where it begins."""


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
            "progress": np.zeros(8),
        }
        """temperature (n_points,) [degrees C]; rate of the last step (n_points,) [K/s]; heat that has come in so far by
        KINDS [N mm]; progress."""
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
        while True:
            step = min(size, target - fraction_n)
            if step * (1 + 1e-9) < target - fraction_n < 2 * step and self.heat.fixed_step is None:
                step = 0.5 * (target - fraction_n)
            fraction = target if step >= (target - fraction_n) * (1 - 1e-9) else fraction_n + step
            found = self._attempt(stage, fraction_n, fraction)
            if isinstance(found, Failed):
                reason, size = found.reason, step * found.factor
            else:
                error = self._estimate_error(stage, fraction_n, fraction, found.temperature)
                if error <= REFUSED * self.heat.tolerance:
                    break
                reason, size = f"an error of {error:.3g} K", step * self._find_factor(error)
            cutbacks.append(f"{duration * step:.3g} s: {reason}")
            if size < SMALLEST * self.heat.initial_step:
                where = f"stage {self.model.stages[stage].name!r} at {duration * fraction_n:.4g} s"
                raise GaveUpError(
                    f"{where}: even a step of {duration * step:.1e} s is not solved ({reason}). Look for tables that "
                    "jump, or for films that are out of proportion"
                )
        self._check_range(stage, duration * fraction, found.temperature)
        self._commit(found, stage, fraction_n, fraction, self._next_size(size, step, error), len(cutbacks))
        return IncrementReport(
            number=int(self.state["progress"][STEPS]),
            stage=self.model.stages[stage].name,
            fraction=fraction,
            time=float(self.state["progress"][TIME]),
            log=found.log,
            cutbacks=cutbacks,
            is_save_point=self._is_save_point(fraction == target),
        )

    def _attempt(self, stage: int, fraction_n: float, fraction: float) -> HeatStep | Failed:
        """Try a step."""
        duration = self.model.stages[stage].duration
        dt = duration * (fraction - fraction_n)
        entries = self.model.stages[stage].heat or HeatStage()
        mask, values = self._prescribe(entries, duration * fraction)
        temperature = self.state["temperature"]
        problem = HeatProblem(
            points=self._points,
            temperature_n=temperature,
            dt=dt,
            films=self._films_of(stage, entries),
            time=duration * fraction,
            mask=mask,
            prescribed=values,
        )
        return self.equation.solve(problem, temperature + dt * self._foretold(fraction_n))

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

    def _estimate_error(self, stage: int, fraction_n: float, fraction: float, temperature: FloatArray) -> float:
        """Return the largest error of a step at nodes that are free [K]; 0 where it is not told."""
        last, now = float(self.state["progress"][LAST]), fraction - fraction_n
        if last == 0.0 or self.heat.fixed_step is not None:
            return 0.0
        stage_now = self.model.stages[stage]
        mask, _ = self._prescribe(stage_now.heat or HeatStage(), 0.0)
        foretold = self.state["temperature"] + stage_now.duration * now * self.state["rate"]
        off = np.abs(temperature - foretold)[mask == 0]
        return float(off.max(initial=0.0)) * now / (2 * now + last)

    def _find_factor(self, error: float) -> float:
        if error == 0.0:
            return GROWTH
        return float(np.clip(SAFETY * np.sqrt(self.heat.tolerance / error), SHRINK, GROWTH))

    def _next_size(self, size: float, step: float, error: float) -> float:
        """Return the size of the next step; one cut short by a saved step says nothing against the size before."""
        if self.heat.fixed_step is not None:
            return self.heat.fixed_step
        if self.state["progress"][LAST] == 0.0:
            return size
        wanted = step * self._find_factor(error)
        return min(max(wanted, size) if step < size and wanted >= step else wanted, self.heat.max_step)

    def _commit(
        self, found: HeatStep, stage: int, fraction_n: float, fraction: float, size: float, cutbacks: int
    ) -> None:
        """Take up a converged step."""
        state, duration = self.state, self.model.stages[stage].duration
        dt = duration * (fraction - fraction_n)
        state["rate"] = (found.temperature - state["temperature"]) / dt
        state["temperature"] = found.temperature
        state["heat"] = state["heat"] + dt * np.array(
            [found.power[kind][0] if kind in found.power else 0.0 for kind in KINDS]
        )
        p = state["progress"]
        p[TIME] += dt
        p[STEPS] += 1
        p[ITERATIONS] += len(found.log)
        p[CUTBACKS] += cutbacks
        p[LAST], p[SIZE] = fraction - fraction_n, size
        p[STAGE], p[FRACTION] = stage, fraction
        if fraction == 1.0:
            p[STAGE], p[FRACTION], p[LAST], p[SIZE] = stage + 1, 0.0, 0.0, self._first_size()

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
