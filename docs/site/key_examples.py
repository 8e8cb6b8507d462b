# SPDX-License-Identifier: Apache-2.0
"""Examples of the keys of case files, which the pages of the reference show below the heading of each table.

They stand in examples/*.toml by the names of the tables' classes; tests/unit/test_keys.py has each class read its own.
"""

from __future__ import annotations

import re
import tomllib
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

FILES = Path(__file__).parent / "examples"
BEGINS = re.compile(r"^\[\[(\w+)\]\](.*)$", re.MULTILINE)


@dataclass(frozen=True)
class Block:
    """An example of one table."""

    name: str
    """Name of the table's class."""
    remark: str
    """What it is an example of, as a comment; may be empty."""
    text: str
    """Its keys, as the file has them."""
    data: dict[str, Any]

    def write(self, place: str) -> str:
        """Return the block as it stands in a case file, at a place as `stages[].tools.NAME`; empty: the whole case."""
        path = place.replace("[]", "")
        text = re.sub(rf"^(\[+){self.name}\.", rf"\1{path}." if path else r"\1", self.text, flags=re.MULTILINE)
        head = f"[[{path}]]" if place.endswith("[]") else f"[{path}]"
        lines = [f"{head}{self.remark}" if path else self.remark.strip(), text]
        return "```toml\n" + "\n".join(line for line in lines if line) + "\n```\n"


@cache
def read_blocks() -> dict[str, tuple[Block, ...]]:
    """Return the examples by the names of the classes."""
    blocks: dict[str, tuple[Block, ...]] = {}
    for path in sorted(FILES.glob("*.toml")):
        text = path.read_text("utf-8")
        begins = list(BEGINS.finditer(text))
        data = {name: list(rows) for name, rows in tomllib.loads(text).items()}
        for begin, end in zip(begins, [*(found.start() for found in begins[1:]), len(text)], strict=True):
            name = begin[1]
            block = Block(name, begin[2], text[begin.end() : end].strip(), data[name].pop(0))
            blocks[name] = (*blocks.get(name, ()), block)
    return blocks


def find_blocks(name: str, keys: set[str]) -> list[Block]:
    """Return the examples of a class that has these keys: two kinds of case may have classes of one name."""
    return [block for block in read_blocks().get(name, ()) if set(block.data) <= keys]
