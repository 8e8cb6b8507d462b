# SPDX-License-Identifier: Apache-2.0
"""Decks of other programs: what they hold, and the case that describes the same process.

`dyna/` and `abaqus/` read decks into a Deck (contents.py); `stamping.py` finds blank, tools and stages in it;
`write.py` leaves the case with its meshes, and every line of the deck that was changed or dropped.
"""
