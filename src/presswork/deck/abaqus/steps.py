# SPDX-License-Identifier: Apache-2.0
"""Steps of Abaqus: what boundary conditions and forces of rigid bodies come to over the whole time."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from presswork.deck.abaqus.assembly import Assembly
from presswork.deck.contents import Deck, Held, Motion, Push
from presswork.deck.notes import Notes
from presswork.keyword_file import Place
from presswork.mesh.files.abaqus_blocks import Block, DataError
from presswork.mesh.files.abaqus_places import to_float
from presswork.model import FloatArray, IndexArray

_NAMED = {
    "XSYMM": (True, False, False, False, True, True),
    "YSYMM": (False, True, False, True, False, True),
    "ZSYMM": (False, False, True, True, True, False),
    "ENCASTRE": (True,) * 6,
    "PINNED": (True, True, True, False, False, False),
}
_KEYWORDS = ("STEP", "END STEP", "STATIC", "DYNAMIC", "BOUNDARY", "CLOAD", "AMPLITUDE")
_FOREVER = 1e20


@dataclass(frozen=True)
class _Entry:
    """A row of *BOUNDARY or *CLOAD in a step, -1 before all of them."""

    step: int
    target: str
    freedom: int
    value: float
    kind: str
    amplitude: str
    block: Block


@dataclass(frozen=True)
class _Step:
    """How long a step takes, and whether loads without amplitude rise over it."""

    duration: float
    rises: bool


@dataclass
class Steps:
    """Gathers steps, and what is prescribed in them."""

    notes: Notes
    _steps: list[_Step] = field(default_factory=list)
    _boundaries: list[_Entry] = field(default_factory=list)
    _forces: list[_Entry] = field(default_factory=list)
    _named: list[tuple[int, Block, str, tuple[bool, ...]]] = field(default_factory=list)
    _amplitudes: dict[str, tuple[FloatArray, bool, Place]] = field(default_factory=dict)
    _smooth: set[str] = field(default_factory=set)
    """Amplitudes that are smooth between their points."""
    _last: Block | None = None
    _renewed: dict[tuple[int, str], Block] = field(default_factory=dict)
    """Steps, and keywords in them, at which what was given before ends (OP=NEW)."""

    is_explicit: bool = False
    """Whether a step is one of Abaqus/Explicit."""

    @property
    def _times(self) -> list[float]:
        return [step.duration for step in self._steps]

    def take(self, block: Block) -> bool:
        """Take a keyword of steps; return whether it was one. Raises DataError."""
        if block.name not in _KEYWORDS:
            return False
        match block.name:
            case "STEP":
                self._begin(block)
            case "STATIC" | "DYNAMIC":
                self._time(block)
            case "END STEP":
                self.notes.see(block.place, "*END STEP", "structure of the deck")
            case "AMPLITUDE":
                self._take_amplitude(block)
            case "BOUNDARY" | "CLOAD":
                text = "holds tools, which move by the stages" if block.name == "BOUNDARY" else "pushes no tool"
                self.notes.see(block.place, f"*{block.name}", text, "dropped")
                self._take_rows(block)
        return True

    def _begin(self, block: Block) -> None:
        words = block.name_of("AMPLITUDE")
        self._steps.append(_Step(0.0, words == "RAMP"))
        self._last = block
        name = block.parameters.get("NAME", "")
        self.notes.see(block.place, "*STEP", f"{name or 'it'} ends a stage, unless tools go on alike")
        if block.name_of("NLGEOM") == "NO":
            self.notes.change(block.place, "*STEP", "displacements are large here, also with NLGEOM = NO")
        if block.name_of("NLGEOM") not in ("", "YES", "NO"):
            raise DataError(f"NLGEOM = {block.name_of('NLGEOM')}")
        if "PERTURBATION" in block.parameters:
            self.notes.refuse(block.place, "*STEP", "a linear perturbation (PERTURBATION)")
        if words not in ("", "RAMP", "STEP"):
            self.notes.refuse(block.place, "*STEP", f"AMPLITUDE = {words}", "give RAMP or STEP")
        rows = [", ".join(row) for row in block.rows()]
        if rows:
            self.notes.leave(block.place, "*STEP", f"the text {'; '.join(rows)}")

    def _time(self, block: Block) -> None:
        """Read the duration of a step; in statics loads rise over it, unless *STEP has the parameter STEP."""
        words = block.first_row()
        duration = to_float(words[1]) if len(words) > 1 and words[1] else 1.0
        if duration <= 0.0:
            raise DataError(f"a time of {duration:g}")
        is_static = block.name == "STATIC"
        self.is_explicit |= "EXPLICIT" in block.parameters
        asked = self._last.name_of("AMPLITUDE") if self._last else ""
        self._steps[-1] = _Step(duration, is_static if not asked else asked == "RAMP")
        self.notes.see(block.place, f"*{block.name}", f"the step takes {duration:g}")
        more = [word for row in block.rows()[1:] for word in row]
        others = [word for word in (*words[:1], *words[2:], *more) if word]
        if others:
            self.notes.leave(block.place, f"*{block.name}", f"increments: {', '.join(others)}", "numerics")

    def _take_amplitude(self, block: Block) -> None:
        kind, place = block.name_of("DEFINITION"), block.place
        if kind not in ("", "TABULAR", "SMOOTH STEP"):
            self.notes.refuse(place, "*AMPLITUDE", f"an amplitude that is not a table ({kind})", "give it as a table")
            return
        if block.name_of("VALUE") not in ("", "RELATIVE"):
            self.notes.refuse(place, "*AMPLITUDE", f"VALUE = {block.name_of('VALUE')}", "give VALUE=RELATIVE")
        if kind == "SMOOTH STEP":
            self._smooth.add(block.name_of("NAME"))
        values = [to_float(word) for word in block.labels()]
        if len(values) < 2 or len(values) % 2:
            raise DataError("pairs of time and value are cut short")
        table = np.array(values).reshape(-1, 2)
        if (np.diff(table[:, 0]) < 0).any():
            raise DataError("times that do not increase")
        if block.name_of("TIME") not in ("", "STEP TIME", "TOTAL TIME"):
            raise DataError(f"TIME = {block.name_of('TIME')}")
        name = block.name_of("NAME")
        if name in self._amplitudes:
            raise DataError(f"a second amplitude {name}")
        self._amplitudes[name] = table, block.name_of("TIME") == "TOTAL TIME", place
        self.notes.see(place, "*AMPLITUDE", "no motion and no force of a tool names it", "dropped")

    def _take_rows(self, block: Block) -> None:
        if block.name_of("OP") == "NEW":
            self._renewed.setdefault((len(self._steps) - 1, block.name), block)
        if "FOLLOWER" in block.parameters:
            self.notes.refuse(block.place, f"*{block.name}", "a force that turns with its node (FOLLOWER)")
        for row in block.rows():
            kind = "force" if block.name == "CLOAD" else block.name_of("TYPE").lower() or "displacement"
            if kind not in ("force", "displacement", "velocity"):
                self.notes.refuse(
                    block.place, "*BOUNDARY", f"prescribed by {kind}", "give TYPE=DISPLACEMENT or VELOCITY"
                )
                continue
            self._take_row(block, row, kind)

    def _take_row(self, block: Block, row: list[str], kind: str) -> None:
        target, word = row[0].upper(), row[1].upper()
        if word in _NAMED and block.name == "BOUNDARY":
            self._named.append((len(self._steps) - 1, block, target, _NAMED[word]))
            return
        if not word.isdigit():
            self.notes.refuse(block.place, f"*{block.name}", f"a support or load of another kind: {word}")
            return
        first = last = int(word)
        if block.name == "CLOAD":
            value, more = to_float(row[2]), row[3:]
        else:
            last = int(row[2]) if len(row) > 2 and row[2] else first
            value, more = to_float(row[3] if len(row) > 3 else ""), row[4:]
        if any(more):
            self.notes.leave(block.place, f"*{block.name}", f"fields after the value: {', '.join(more)}")
        if not 1 <= first <= last <= 6:
            bad = first if first < 1 or first > 6 else last
            text = f"{target}: freedom {bad} is no displacement and no rotation"
            remedy = "freedoms are 1 to 6; take temperatures and pressures out of the deck"
            self.notes.refuse(block.place, f"*{block.name}", text, remedy)
            return
        entries = self._forces if block.name == "CLOAD" else self._boundaries
        for freedom in range(first, last + 1):
            step = len(self._steps) - 1
            entries.append(_Entry(step, target, freedom, value, kind, block.name_of("AMPLITUDE"), block))

    # --- over the whole time -----------------------------------------------------------------------------------------

    def finish(self, deck: Deck, assembly: Assembly, bodies: dict[int, list[int]], labels: IndexArray) -> None:
        """Add motions, pushes and supports to the deck.

        bodies: labels of the reference nodes of tools by part; labels: all of them, sorted (n,), whose places are the
        deck's own labels less one.
        """
        deck.end = float(sum(self._times)) or None
        deck.breaks = np.cumsum(self._times).tolist()
        deck.end_place = self._last.place if self._last else None
        released = self._end_by_renewal()
        part_of = {node: part for part, nodes in bodies.items() for node in nodes}
        held: dict[tuple[int, ...], list[bool]] = {}
        blocks: dict[tuple[int, ...], Block] = {}
        driven: dict[tuple[int, int, str], list[_Entry]] = {}
        idle: dict[tuple[Place, str, str], list[int]] = {}
        for step, target, _ in released:
            block = self._renewed[step, "BOUNDARY"]
            if not any(node in part_of for node in self._nodes_of(assembly, block, target)):
                text = f"OP=NEW releases {target}, which is no tool, while the sheet is formed"
                self.notes.refuse(block.place, "*BOUNDARY", text, "give its supports again, or OP=MOD")
        for entry in (*self._boundaries, *self._forces):
            nodes = self._nodes_of(assembly, entry.block, entry.target)
            parts = {part_of[node] for node in nodes if node in part_of}
            if entry.kind == "force" and len(nodes) > 1:
                self.notes.refuse(entry.block.place, "*CLOAD", f"{entry.target}: a force on each of {len(nodes)} nodes")
            if parts and not entry.value:
                idle.setdefault((entry.block.place, entry.block.name, entry.target), []).append(entry.freedom)
            for part in parts:
                driven.setdefault((part, entry.freedom, entry.kind), []).append(entry)
            if not parts:
                self._hold(entry, tuple(nodes), held, blocks)
        for _, block, target, fixed in self._named:
            nodes = self._nodes_of(assembly, block, target)
            if not any(node in part_of for node in nodes):
                own = np.searchsorted(labels, np.array(nodes)) + 1
                deck.held.append(Held(own, fixed, block.place, "*BOUNDARY"))
        for key, fixed_list in held.items():
            own = np.searchsorted(labels, np.array(key)) + 1
            deck.held.append(Held(own, tuple(fixed_list), blocks[key].place, "*BOUNDARY"))
        for (place, keyword, target), freedoms in idle.items():
            text = f"{target}: freedoms {', '.join(map(str, freedoms))} held or without load"
            self.notes.leave(place, f"*{keyword}", text, "tools move by the stages")
        for (part, freedom, kind), entries in driven.items():
            targets = {entry.target for entry in entries}
            ends = [step for step, target, own in released if own == freedom and target in targets]
            end = float(np.cumsum([0.0, *self._times])[min(ends)]) if ends and kind != "force" else _FOREVER
            if any(entry.value for entry in entries) or (part, freedom, "force") in driven:
                self._drive(deck, part, freedom, kind, entries, end)

    def _end_by_renewal(self) -> list[tuple[int, str, int]]:
        """Return step, target and freedom of supports and motions that OP=NEW releases; forces that end become 0."""
        named = [(s, t, i + 1) for s, _, t, fixed in self._named for i, is_fixed in enumerate(fixed) if is_fixed]
        released = []
        for (step, keyword), block in self._renewed.items():
            entries = self._forces if keyword == "CLOAD" else self._boundaries
            given = [(e.step, e.target, e.freedom) for e in entries] + (named if keyword == "BOUNDARY" else [])
            now = {(target, freedom) for s, target, freedom in given if s == step}
            for target, freedom in sorted({(target, freedom) for s, target, freedom in given if s < step} - now):
                if keyword == "CLOAD":
                    entries.append(_Entry(step, target, freedom, 0.0, "force", "", block))
                else:
                    released.append((step, target, freedom))
        return released

    def _nodes_of(self, assembly: Assembly, block: Block, target: str) -> list[int]:
        try:
            return assembly.nodes_of(target)
        except KeyError as error:
            fault = f"*{block.name}: there is no set of nodes {target}"
            raise self.notes.fail(block.place, fault, "check its name") from error

    def _hold(
        self,
        entry: _Entry,
        nodes: tuple[int, ...],
        held: dict[tuple[int, ...], list[bool]],
        blocks: dict[tuple[int, ...], Block],
    ) -> None:
        if entry.kind == "force" or entry.value != 0.0:
            self.notes.refuse(entry.block.place, f"*{entry.block.name}", "loads and motions of the sheet itself")
            return
        held.setdefault(nodes, [False] * 6)[entry.freedom - 1] = True
        blocks.setdefault(nodes, entry.block)

    def _drive(self, deck: Deck, part: int, freedom: int, kind: str, entries: list[_Entry], end: float) -> None:
        """Add the motion or the push of a tool along a freedom until a time, as a curve over the whole time."""
        first = entries[0].block
        for step in {entry.step for entry in entries}:
            own = {(e.value, e.amplitude, e.target if kind == "force" else "") for e in entries if e.step == step}
            if len({each for each in own if each[0]}) > 1:
                text = f"several {kind}s along freedom {freedom} of one tool in one step"
                self.notes.refuse(first.place, f"*{first.name}", text, "give one")
        for entry in entries:
            if entry.block.place != first.place:
                self.notes.belong(entry.block.place, f"*{first.name}", first.place)
        curve = self._join(entries, kind)
        number = len(deck.curves) + 1
        deck.curves[number] = curve
        axis, keyword = freedom - 1, f"*{first.name}"
        if kind == "force":
            deck.pushes.append(Push(part, axis, number, 1.0, first.place, keyword))
            return
        shown: Literal["velocity", "displacement"] = "velocity" if kind == "velocity" else "displacement"
        deck.motions.append(Motion(part, axis, shown, number, 1.0, 0.0, end, first.place, keyword))

    def _join(self, entries: list[_Entry], kind: str) -> FloatArray:
        """Return the curve (n, 2) over the whole time of one freedom, step after step."""
        starts = np.concatenate([[0.0], np.cumsum(self._times)])
        rows: list[tuple[float, float]] = []
        value = 0.0
        for step, duration in enumerate(self._times):
            own = [entry for entry in entries if entry.step == step]
            begin, tiny = float(starts[step]), 1e-9 * duration
            if not own:
                value = 0.0 if kind == "velocity" else value
                rows += [(begin + tiny, value), (begin + duration, value)]
                continue
            entry = own[-1]
            if entry.amplitude:
                table, is_total, place = self._find_amplitude(entry)
                self.notes.belong(place, "*AMPLITUDE", entry.block.place)
                times = table[:, 0] if is_total else table[:, 0] + begin
                inside = (times >= begin - tiny) & (times <= begin + duration + tiny)
                if not inside.any() or times[inside][0] > begin + tiny:
                    rows.append((begin + tiny, entry.value * float(np.interp(begin, times, table[:, 1]))))
                rows += [
                    (float(t), entry.value * float(v)) for t, v in zip(times[inside], table[inside, 1], strict=True)
                ]
                end = begin + duration
                value = entry.value * float(np.interp(end, times, table[:, 1]))
                rows.append((end, value))
            elif kind == "displacement" or (kind == "force" and self._steps[step].rises):
                rows += [(begin + tiny, value), (begin + duration, entry.value)]
                value = entry.value
            else:
                value = entry.value
                rows += [(begin + tiny, value), (begin + duration, value)]
        curve = np.array(sorted(rows))
        if curve[0, 0] > 0.0:
            curve = np.vstack([[0.0, curve[0, 1]], curve])
        return np.asarray(curve[np.concatenate([np.diff(curve[:, 0]) > 0, [True]])])

    def _find_amplitude(self, entry: _Entry) -> tuple[FloatArray, bool, Place]:
        if entry.amplitude not in self._amplitudes:
            fault = f"*{entry.block.name}: there is no amplitude {entry.amplitude}"
            raise self.notes.fail(entry.block.place, fault, "add *AMPLITUDE")
        found = self._amplitudes[entry.amplitude]
        if entry.amplitude in self._smooth:
            self.notes.change(found[2], "*AMPLITUDE", "straight lines between its points (DEFINITION = SMOOTH STEP)")
        return found
