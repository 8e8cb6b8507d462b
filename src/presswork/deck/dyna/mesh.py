# SPDX-License-Identifier: Apache-2.0
"""Nodes and shells of LS-DYNA, with what their rows hold and the thickness of their own."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from presswork.deck.contents import Deck, Held, Shells
from presswork.deck.dyna.blocks import Block
from presswork.deck.fields import FieldError, read_table
from presswork.deck.notes import Notes
from presswork.model import BoolArray, FloatArray, IndexArray

_HELD = {
    0: (False, False, False),
    1: (True, False, False),
    2: (False, True, False),
    3: (False, False, True),
    4: (True, True, False),
    5: (False, True, True),
    6: (True, False, True),
    7: (True, True, True),
}
"""What codes of nodes hold: displacements or rotations along x, y, z."""


@dataclass
class MeshReader:
    """Gathers nodes and shells of a deck."""

    deck: Deck
    notes: Notes
    _labels: list[IndexArray] = field(default_factory=list)
    _points: list[FloatArray] = field(default_factory=list)
    _shells: list[IndexArray] = field(default_factory=list)
    _thickness: list[FloatArray] = field(default_factory=list)
    _angle: list[FloatArray] = field(default_factory=list)

    def take_nodes(self, block: Block) -> None:
        """Take a *NODE. Raises FieldError."""
        self.deck.node_place = self.deck.node_place or block.place
        n = 0
        label, number = (20, 20) if block.is_long else (10 if block.has_wide_labels else 8, 16)
        widths = (label, number, number, number)
        for rows in block.pieces():
            table = read_table(rows, widths, block.parameters)
            if any(row.count(b",") > 3 or row[sum(widths) :].strip(b" 0") for row in rows):
                self._hold(block, rows, widths)
            self._labels.append(table[:, 0].astype(np.intp))
            self._points.append(table[:, 1:])
            n += len(table)
        self.notes.see(block.place, f"*{block.name}", f"{n} nodes")

    def _hold(self, block: Block, rows: list[bytes], widths: tuple[int, ...]) -> None:
        """Take what the rows of nodes themselves hold (TC, RC)."""
        width = 20 if block.is_long else 8
        more = [text for row in rows if (text := row[sum(widths) + 2 * width :].strip(b" 0")) and b"," not in row]
        if more:
            self.notes.leave(block.place, f"*{block.name}", f"fields after RC: {more[0].decode('latin-1')}")
        codes = read_table(rows, (*widths, width, width), block.parameters)[:, [0, 4, 5]].astype(np.intp)
        for tc, rc in np.unique(codes[codes[:, 1:].any(axis=1)][:, 1:], axis=0).tolist():
            if tc not in _HELD or rc not in _HELD:
                raise FieldError(f"a node held by TC = {tc}, RC = {rc}: expected 0 to 7")
            nodes = codes[(codes[:, 1] == tc) & (codes[:, 2] == rc), 0]
            self.deck.held.append(Held(nodes, (*_HELD[tc], *_HELD[rc]), block.place, f"*{block.name}"))

    def take_shells(self, block: Block) -> None:
        """Take an *ELEMENT_SHELL. Raises FieldError."""
        options = block.name.removeprefix("ELEMENT_SHELL").split("_")[1:]
        if unknown := set(options) - {"THICKNESS"}:
            what = ", ".join(sorted(unknown))
            self.notes.refuse(block.place, f"*{block.name}", f"shells with options of their own: {what}")
            return
        width = 20 if block.is_long else 10 if block.has_wide_labels else 8
        n = 0
        for rows in block.pieces():
            cards = rows[::2] if options else rows
            if any(_has_more(row, width) for row in cards):
                self.notes.refuse(block.place, f"*{block.name}", "shells of more than four nodes", "take four of each")
            table = read_table(cards, (width,) * 6, block.parameters).astype(np.intp)
            table[:, 5] = np.where(table[:, 5] == 0, table[:, 4], table[:, 5])
            thickness, angle = np.full(len(table), np.nan), np.zeros(len(table))
            if options:
                first = read_table(rows[1::2], (16,) * 5, block.parameters)
                if len(first) != len(table):
                    raise FieldError("a shell without its row of thickness")
                thickness, angle = self._mean_thickness(block, first[:, :4], table[:, 4] == table[:, 5]), first[:, 4]
            self._shells.append(table)
            self._thickness.append(thickness)
            self._angle.append(angle)
            n += len(table)
        self.notes.see(block.place, f"*{block.name}", f"{n} shells")

    def _mean_thickness(self, block: Block, corners: FloatArray, is_triangle: BoolArray) -> FloatArray:
        """Return the mean thickness of shells at their corners (n, 4), three of which a triangle has; NaN for none."""
        corners = np.where(corners > 0.0, corners, np.nan)
        corners[is_triangle, 3] = np.nan
        n = np.isfinite(corners).sum(axis=1)
        mean = np.where(n > 0, np.nansum(corners, axis=1) / np.maximum(n, 1), np.nan)
        differs = int((np.abs(corners - mean[:, None]) > 1e-6 * mean[:, None]).any(axis=1).sum())
        if differs:
            text = f"{differs} shells whose thickness differs from corner to corner have its mean"
            self.notes.change(block.place, f"*{block.name}", text)
        return np.asarray(mean)

    # --- the whole ---------------------------------------------------------------------------------------------------

    def finish(self) -> None:
        """Give the deck its nodes and shells. Raises CaseError for none, or two of one label."""
        deck, notes = self.deck, self.notes
        if not self._labels:
            raise notes.fail(None, "no *NODE in it", "give the whole deck, with the files that it includes")
        labels, points = np.concatenate(self._labels), np.concatenate(self._points)
        order = np.argsort(labels, kind="stable")
        same = np.concatenate([[False], labels[order][1:] == labels[order][:-1]])
        apart = same & np.concatenate([[False], (points[order][1:] != points[order][:-1]).any(axis=1)])
        if apart.any():
            text = f"a second node {labels[order][apart][0]}, at another place"
            raise notes.fail(deck.node_place, text, "give nodes of all files numbers of their own")
        keep = order[~same] if same.any() else slice(None)
        deck.labels, deck.points = labels[keep], points[keep]
        if not self._shells:
            return
        table = np.concatenate(self._shells)
        numbers, count = np.unique(table[:, 0], return_counts=True)
        if (count > 1).any():
            text = f"a second shell {numbers[count > 1][0]}"
            raise notes.fail(None, text, "give shells of all files numbers of their own")
        thickness, angle = np.concatenate(self._thickness), np.concatenate(self._angle)
        deck.shells = Shells(table[:, 1], table[:, 2:], thickness, table[:, 0], angle)


def _has_more(row: bytes, width: int) -> bool:
    """Return whether the row of a shell has nodes after its fourth."""
    rest = b"".join(row.split(b",")[6:]) if b"," in row else row[6 * width :]
    return bool(rest.strip(b" 0\r"))
