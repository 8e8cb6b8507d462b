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


@dataclass
class Steps:
    """Gathers steps, and what is prescribed in them."""

    notes: Notes
    _times: list[float] = field(default_factory=list)
    _boundaries: list[_Entry] = field(default_factory=list)
    _forces: list[_Entry] = field(default_factory=list)
    _named: list[tuple[Block, str, tuple[bool, ...]]] = field(default_factory=list)
    _amplitudes: dict[str, tuple[FloatArray, bool, Place]] = field(default_factory=dict)
    _last: Block | None = None

    def take(self, block: Block) -> bool:
        """Take a keyword of steps; return whether it was one. Raises DataError."""
        if block.name not in _KEYWORDS:
            return False
        match block.name:
            case "STEP":
                self._times.append(0.0)
                self._last = block
                self.notes.see(block.place, "*STEP", "ends a stage, unless tools go on alike")
            case "STATIC" | "DYNAMIC":
                rows = block.rows()
                words = [word for word in rows[0][1:2] if word] if rows else []
                self._times[-1] = float(words[0]) if words else 1.0
                self.notes.see(block.place, f"*{block.name}", f"the step takes {self._times[-1]:g}")
            case "END STEP":
                self.notes.see(block.place, "*END STEP", "how the deck is put together")
            case "AMPLITUDE":
                if block.name_of("DEFINITION") not in ("", "TABULAR", "SMOOTH STEP"):
                    self.notes.refuse(block.place, "*AMPLITUDE", "an amplitude that is no table", "give it as a table")
                    return True
                values = [float(word) for word in block.labels()]
                if len(values) < 2 or len(values) % 2:
                    raise DataError("pairs of time and value are cut short")
                is_total = block.name_of("TIME") == "TOTAL TIME"
                self._amplitudes[block.name_of("NAME")] = np.array(values).reshape(-1, 2), is_total, block.place
                text = "no motion and no force of a tool names it"
                self.notes.see(block.place, "*AMPLITUDE", text, "dropped")
            case "BOUNDARY" | "CLOAD":
                text = "holds tools, which move as stages say" if block.name == "BOUNDARY" else "pushes no tool"
                self.notes.see(block.place, f"*{block.name}", text, "dropped")
                self._take_rows(block)
        return True

    def _take_rows(self, block: Block) -> None:
        for row in block.rows():
            kind = "force" if block.name == "CLOAD" else block.name_of("TYPE").lower() or "displacement"
            if kind not in ("force", "displacement", "velocity"):
                self.notes.refuse(
                    block.place, "*BOUNDARY", f"prescribed by {kind}", "give TYPE=DISPLACEMENT or VELOCITY"
                )
                continue
            target, word = row[0].upper(), row[1].upper()
            if word in _NAMED:
                self._named.append((block, target, _NAMED[word]))
                continue
            if not word.isdigit():
                self.notes.refuse(block.place, "*BOUNDARY", f"a support of another kind: {word}")
                continue
            first = int(word)
            if block.name == "CLOAD":
                last, value = first, float(row[2])
            else:
                last = int(row[2]) if len(row) > 2 and row[2] else first
                value = float(row[3]) if len(row) > 3 and row[3] else 0.0
            entries = self._forces if block.name == "CLOAD" else self._boundaries
            for freedom in range(first, last + 1):
                step = len(self._times) - 1
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
        part_of = {node: part for part, nodes in bodies.items() for node in nodes}
        held: dict[tuple[int, ...], list[bool]] = {}
        blocks: dict[tuple[int, ...], Block] = {}
        driven: dict[tuple[int, int, str], list[_Entry]] = {}
        for entry in (*self._boundaries, *self._forces):
            nodes = self._nodes_of(assembly, entry.block, entry.target)
            parts = {part_of[node] for node in nodes if node in part_of}
            for part in parts:
                driven.setdefault((part, entry.freedom, entry.kind), []).append(entry)
            if not parts:
                self._hold(entry, tuple(nodes), held, blocks)
        for block, target, fixed in self._named:
            nodes = self._nodes_of(assembly, block, target)
            if not any(node in part_of for node in nodes):
                own = np.searchsorted(labels, np.array(nodes)) + 1
                deck.held.append(Held(own, fixed, block.place, "*BOUNDARY"))
        for key, fixed_list in held.items():
            own = np.searchsorted(labels, np.array(key)) + 1
            deck.held.append(Held(own, tuple(fixed_list), blocks[key].place, "*BOUNDARY"))
        for (part, freedom, kind), entries in driven.items():
            self._drive(deck, part, freedom, kind, entries)

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

    def _drive(self, deck: Deck, part: int, freedom: int, kind: str, entries: list[_Entry]) -> None:
        """Add the motion or the push of a tool along a freedom, as a curve over the whole time."""
        if not any(entry.value for entry in entries):
            return
        first = entries[0].block
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
        deck.motions.append(Motion(part, axis, shown, number, 1.0, 0.0, _FOREVER, first.place, keyword))

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
                rows += [
                    (float(t), entry.value * float(v)) for t, v in zip(times[inside], table[inside, 1], strict=True)
                ]
                end = begin + duration
                value = entry.value * float(np.interp(end, times, table[:, 1]))
                rows.append((end, value))
            elif kind == "displacement":
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
        return self._amplitudes[entry.amplitude]
