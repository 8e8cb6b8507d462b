# SPDX-License-Identifier: Apache-2.0
"""What a tool is by the words of its title: whole words, or their ends as in `blankholder`, never letters inside."""

from __future__ import annotations

import re

_WORD = re.compile(r"[A-Z]?[a-z]+|[A-Z]+(?![a-z])")
_PUNCHES = frozenset({"punch", "punches", "stamp", "post"})
_HOLDERS = frozenset({"holder", "holders", "hold", "holddown", "binder", "binders", "pad", "ring", "clamp", "clamps"})
_PUNCH_ENDS = ("punch",)
_HOLDER_ENDS = ("holder", "binder")


def is_punch(title: str) -> bool:
    """Return whether a title names a punch; the holder of a punch is none."""
    return _has_word(title, _PUNCHES, _PUNCH_ENDS) and not is_holder(title)


def is_holder(title: str) -> bool:
    """Return whether a title names a holder: `spring` and `padding` do not, though `ring` and `pad` do."""
    return _has_word(title, _HOLDERS, _HOLDER_ENDS)


def _has_word(title: str, words: frozenset[str], ends: tuple[str, ...]) -> bool:
    return any(word in words or word.endswith(ends) for word in map(str.lower, _WORD.findall(title)))
