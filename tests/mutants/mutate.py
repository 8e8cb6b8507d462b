# SPDX-License-Identifier: Apache-2.0
"""Change a file: bytes, numbers, lines or, in TOML, values and keys."""

from __future__ import annotations

import re
import tomllib
from random import Random
from typing import Any

import tomli_w

NUMBERS = (
    "0", "-1", "1e308", "-1e308", "nan", "inf", "-inf", "1e-308", "1" + "0" * 400, "2147483648", "-2147483649",
    "18446744073709551616", "1e7", "1e-7", "0.5", "3", "", "x", "1e", "--1", "1.2.3", "²", "0x10",
)  # fmt: skip
VALUES: tuple[Any, ...] = (
    0, -1, 1, 2, 1e308, -1e308, float("nan"), float("inf"), 1e-300, 10**400, 2**63, 1e7, 1e-7, 0.5, True, False, "",
    "x", "1 mm", "1 furlong", "1 10**10**10*mm", "9" * 300, "../x", "a/b", "a\nb", "\0", [], {}, [[]], [0], [1, 2, 3],
    [0, 0], ["1 m", "2 s"], [[0, 0], [1, 1]], {"a": 1}, {"to": [0, 0]}, "steel", "left", "all", "quad", "tri3",
    "coulomb", "sticking", "explicit", "implicit", "file", "missing.msh", "/dev/zero", ".", "1e400", "-5 kN",
)  # fmt: skip
_NUMBER = re.compile(r"-?\d+(?:\.\d*)?(?:[eEdD][+-]?\d+)?")


def mutate(content: bytes, ending: str, random: Random) -> bytes:
    """Return the content with one to four changes."""
    for _ in range(random.choice((1, 1, 1, 2, 4))):
        changes = [_change_bytes]
        if ending == "toml":
            changes = [_change_toml, _change_toml, _change_toml, _change_text]
        elif ending not in ("vtkhdf", "h5", "bin"):
            changes = [_change_bytes, _change_text, _change_text]
        content = random.choice(changes)(content, random)
    return content


def _change_bytes(content: bytes, random: Random) -> bytes:
    at = random.randrange(len(content) + 1)
    length = random.choice((1, 1, 2, 8, 64, 512))
    way = random.randrange(6)
    if way == 0:
        return content[:at]
    if way == 1:
        return content[:at] + content[at + length :]
    if way == 2:
        return content[:at] + content[at : at + length] + content[at:]
    if way == 3:
        return content[:at] + bytes(random.randrange(256) for _ in range(min(length, 8))) + content[at:]
    changed = bytearray(content)
    for place in range(at, min(at + min(length, 8), len(content))):
        changed[place] = changed[place] ^ (1 << random.randrange(8)) if way == 4 else random.choice((0, 255))
    return bytes(changed)


def _change_text(content: bytes, random: Random) -> bytes:
    text = content.decode("latin-1")
    found = list(_NUMBER.finditer(text))
    lines = text.split("\n")
    at = random.randrange(len(lines))
    way = random.randrange(6)
    if way <= 2 and found:
        hit = random.choice(found)
        text = text[: hit.start()] + random.choice(NUMBERS) + text[hit.end() :]
        return text.encode("latin-1")
    if way == 3:
        del lines[at]
    elif way == 4:
        lines.insert(at, random.choice(lines))
    else:
        other = random.randrange(len(lines))
        lines[at], lines[other] = lines[other], lines[at]
    return "\n".join(lines).encode("latin-1")


def _change_toml(content: bytes, random: Random) -> bytes:
    try:
        data = tomllib.loads(content.decode())
        change_data(data, random)
        return tomli_w.dumps(data).encode()
    except (ValueError, IndexError, TypeError, OverflowError):  # no TOML any more
        return _change_text(content, random)


def change_data(data: Any, random: Random) -> None:
    """Change one place of a case's data: remove, rename, repeat, scale or replace what stands there."""
    here, key = random.choice(list(_places(data)))
    way = random.randrange(8)
    if way == 0:
        del here[key]
    elif way == 1 and isinstance(here, dict):
        here[random.choice((key + "x", "a/b", "", "left", "\0", "..", "²"))] = here.pop(key)
    elif way == 2 and isinstance(here, list):
        here.append(here[key])
    elif way == 3 and isinstance(here[key], int | float) and not isinstance(here[key], bool):
        here[key] *= random.choice((1e-9, 1e-3, 0.1, -1, 10, 1e3, 1e9))
    else:
        here[key] = random.choice(VALUES)


def _places(data: Any) -> list[tuple[Any, Any]]:
    """Return every table or list with each of its keys."""
    found = []
    for key in list(data) if isinstance(data, dict) else range(len(data)):
        found.append((data, key))
        if isinstance(data[key], dict | list):
            found += _places(data[key])
    return found
