# SPDX-License-Identifier: Apache-2.0
"""The contract of an observer: its methods, and what it sees of a run."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal, Protocol, TypeVar

from numpy.typing import NDArray

from presswork.body.law_window import LawWindow
from presswork.fields.instant import Instant
from presswork.formability import Info
from presswork.implicit.heat_of_forming import HeatArrays, HeatOfForming
from presswork.interaction.heat.heat_of_sheet import HeatOfSheet, SheetHeatArrays
from presswork.model import FloatArray, IntArray, Mesh, Model

Row = dict[str, float | int | str]
History = Mapping[str, NDArray[Any]]
Kind = TypeVar("Kind", bound="Observer")
LimitName = Literal["penetration", "thinning", "hydrostatic_stress", "mean_pressure"]


@dataclass(frozen=True)
class Measure:
    """How far a state is towards a limit."""

    limit: LimitName
    value: float
    """Value in the unit of the limit."""
    fact: str
    """Fact in words, with its place."""


@dataclass(frozen=True)
class Metal:
    """Points of a body at an instant."""

    body: str
    stress: FloatArray
    """Mean of the three (n,) [MPa]."""
    flow_stress: FloatArray
    """(n,) [MPa]"""
    centres: FloatArray
    """Centres of their cells (n, 2 | 3) [mm]."""
    volume: FloatArray | None
    """(n,) [mm3]; None where a mean pressure means nothing."""


@dataclass(frozen=True)
class ToolGaps:
    """Where tools are, and bodies that may press on each other."""

    names: Sequence[str]
    profiles: Mapping[str, FloatArray]
    """Profiles of tools in the plane, where they are now (n_segments, 7)."""
    find: Callable[[FloatArray], FloatArray]
    """Return how far places are from each tool (n_tools, n) [mm]."""
    pairs: Sequence[Mapping[str, IntArray]] = ()
    """Boundary edges of two bodies each (n, 2 | 3)."""
    tolerance: float | None = None
    """Tolerance of contact at nodes [mm]; None where there is none, as in explicit runs."""


@dataclass(frozen=True)
class Ram:
    """The ram of a press at an instant."""

    speed: float
    """[mm/s]"""
    force: float
    """Against it [N]."""
    work: float
    """Spent on the workpiece since the start [N mm]."""
    blow: int
    """Number of the blow; 0 where there is none."""


@dataclass(frozen=True)
class Evolved:
    """What evolution laws keep at the points of the material."""

    values: Mapping[str, Sequence[FloatArray]]
    """Values by quantity and block (n_cells, p), for shells the layers of a point one after the other."""
    critical: Mapping[str, Sequence[float | None]]
    """The critical value in each block, by quantity."""


class Observed(Protocol):
    """A run as its observers see it, after an increment or an output interval."""

    model: Model
    observers: Observers

    @property
    def mesh(self) -> Mesh:
        """The present mesh, its points where their material was when the run began."""

    @property
    def number(self) -> int:
        """Increments or intervals so far."""

    @property
    def epoch(self) -> int:
        """How many meshes there were before the present one."""

    def current_stage(self) -> int:
        """Return the stage that the present state belongs to."""

    def positions(self) -> FloatArray:
        """Return where the nodes are (n_points, 2 | 3) [mm]."""

    def displacements(self) -> FloatArray:
        """Return displacements, of shells rotations, too, since the run began (n_points, freedoms) [mm, rad]."""

    def reactions(self) -> FloatArray:
        """Return the forces of what holds nodes, of an interval their mean (n_points, freedoms) [N, N mm]."""

    def tool_displacements(self) -> dict[str, FloatArray]:
        """Return how far each tool has moved since the run began (2 | 3,) [mm]."""

    def show(self) -> Instant:
        """Return what fields are computed from."""

    def evolved(self) -> Evolved:
        """Return what evolution laws keep."""

    def metal(self) -> list[Metal]:
        """Return the points of solids; none of a sheet."""

    def held_part(self) -> float | None:
        """Return the part of the surface of solids that tools and supports hold; None where it is not known."""

    def tool_gaps(self) -> ToolGaps | None:
        """Return where the tools of solids are; None of a sheet."""

    def sheet_fields(self, *, with_surface: bool) -> Mapping[str, FloatArray]:
        """Return the strains of a sheet's cells, with what is known of its surface; none of solids."""

    def tool_depths(self) -> Mapping[str, float]:
        """Return how deep each tool is in the surface of a sheet [mm]; none of solids."""

    def overlap(self) -> float:
        """Return by how much a sheet overlaps itself [mm]."""

    def sheet_pressures(self) -> Mapping[str, float]:
        """Return the pressures on a sheet by their names [MPa]; none of solids."""

    def held_rates(self) -> Mapping[str, float]:
        """Return the strain rates of a sheet that pressures hold by the names of these [1/s], of those that tools seal
        what has leaked off [MPa]; none of solids.
        """

    def body_heat(self) -> tuple[HeatOfForming, HeatArrays] | None:
        """Return the heat of solids, if they have any."""

    def sheet_heat(self) -> tuple[HeatOfSheet, SheetHeatArrays] | None:
        """Return the heat of a sheet, if it has any."""

    def ram(self) -> Ram:
        """Return the ram; it stands still where no press drives the stage."""

    def law_window(self) -> LawWindow:
        """Return what the materials have been through, by the material's number."""

    def warn_of_loose(self) -> list[str]:
        """Return what a user should know of bodies that nothing holds."""

    def plastic_shares(self) -> FloatArray:
        """Return the plastic work over the work of the ram in each stage (n_stages,)."""


class Observer:
    """Measures or follows something in a run. A subclass overrides what it has."""

    def columns(self, run: Observed) -> list[str]:
        """Return its columns of history.csv, the same in the whole run."""
        return []

    def row(self, run: Observed, *, is_released: bool = False) -> Row:
        """Return the values of its columns. is_released: the part lies free of tools and supports."""
        return {}

    def summary(self, run: Observed, history: History) -> dict[str, Any]:
        """Return its entries of summary.json."""
        return {}

    def warnings(self, run: Observed, history: History) -> list[str]:
        """Return what a user should know."""
        return []

    def take_mesh(self, before: FloatArray, mesh: Mesh, position: FloatArray) -> None:
        """Go on with another mesh of an implicit run.

        before, position: of the nodes of the old mesh and of the new one at this instant (n_points, 2 | 3) [mm].
        """

    def measures(self, run: Observed) -> list[Measure]:
        """Return how far the present state is towards limits; asked once after each increment or interval."""
        return []

    def hints(self, run: Observed) -> list[str]:
        """Return what may have made an increment fail."""
        return []

    def info(self, run: Observed) -> Info:
        """Return what a saved step stores about the run."""
        return {}

    def show(self, run: Observed, now: Instant) -> None:
        """Add to what fields are computed from."""

    def files(self, run: Observed) -> dict[str, str]:
        """Return the names and texts of further files of the run."""
        return {}

    def arrays(self) -> dict[str, NDArray[Any]]:
        """Return what it keeps from one instant to the next, for a checkpoint."""
        return {}

    def load_arrays(self, arrays: Mapping[str, NDArray[Any]]) -> None:
        """Take up what `arrays` gave; there may be others among them."""


class Observers:
    """The observers of a run, in the order of their columns."""

    def __init__(self, observers: Sequence[Observer]) -> None:
        self._observers = list(observers)

    def __iter__(self) -> Iterator[Observer]:
        return iter(self._observers)

    def add(self, observer: Observer) -> None:
        """Add an observer behind the others."""
        self._observers.append(observer)

    def find(self, kind: type[Kind]) -> Kind:
        """Return the observer of a kind."""
        return next(observer for observer in self._observers if isinstance(observer, kind))

    def columns(self, run: Observed) -> list[str]:
        """Return the columns of all."""
        return [name for observer in self._observers for name in observer.columns(run)]

    def row(self, run: Observed, *, is_released: bool = False) -> Row:
        """Return the values of all columns."""
        row: Row = {}
        for observer in self._observers:
            row |= observer.row(run, is_released=is_released)
        return row

    def summary(self, run: Observed, history: History) -> dict[str, Any]:
        """Return the entries of all."""
        found: dict[str, Any] = {}
        for observer in self._observers:
            found |= observer.summary(run, history)
        return found

    def warnings(self, run: Observed, history: History) -> list[str]:
        """Return the warnings of all."""
        return [text for observer in self._observers for text in observer.warnings(run, history)]

    def take_mesh(self, before: FloatArray, mesh: Mesh, position: FloatArray) -> None:
        """Let all go on with another mesh."""
        for observer in self._observers:
            observer.take_mesh(before, mesh, position)

    def measures(self, run: Observed) -> list[Measure]:
        """Return how far the present state is towards limits."""
        return [measure for observer in self._observers for measure in observer.measures(run)]

    def hints(self, run: Observed) -> list[str]:
        """Return what may have made an increment fail."""
        return [hint for observer in self._observers for hint in observer.hints(run)]

    def show(self, run: Observed, now: Instant) -> None:
        """Let all add to what fields are computed from."""
        for observer in self._observers:
            observer.show(run, now)

    def info(self, run: Observed) -> Info:
        """Return what a saved step stores about the run."""
        found: dict[str, str | float | FloatArray] = {}
        for observer in self._observers:
            found |= observer.info(run)
        return found

    def files(self, run: Observed) -> dict[str, str]:
        """Return the files of all."""
        return {name: text for observer in self._observers for name, text in observer.files(run).items()}

    def arrays(self) -> dict[str, NDArray[Any]]:
        """Return what all of them keep."""
        return {name: values for observer in self._observers for name, values in observer.arrays().items()}

    def load_arrays(self, arrays: Mapping[str, NDArray[Any]]) -> None:
        """Take up what `arrays` gave."""
        for observer in self._observers:
            observer.load_arrays(arrays)
