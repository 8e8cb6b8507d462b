# SPDX-License-Identifier: Apache-2.0
"""A process that reads mutants one after the other, so that one that kills it or never ends is seen from outside.

Run as a module. Each request is a pickled (kind, content). An empty line says that the files which go with the mutant
are there; a line of JSON answers "taken", "refused" or "traceback" and what was said.
"""

from __future__ import annotations

import json
import os
import pickle
import resource
import sys
import tempfile
import traceback
import warnings
from pathlib import Path

MEMORY = 6_000_000_000
"""Bytes that a worker may take: what asks for more is a fault, not a wait."""


def make(kind: str) -> Path:
    """Write a valid file of a kind and what goes with it; return its path."""
    from tests.mutants.kinds import KINDS

    folder = Path(tempfile.mkdtemp(prefix="mutants_"))
    KINDS[kind].make(folder)
    return folder / KINDS[kind].name


def answer(kind: str, content: bytes, path: Path) -> tuple[str, str]:
    """Read one mutant; return the verdict and what was said."""
    from tests.mutants.kinds import KINDS, REFUSALS

    path.write_bytes(content)
    try:
        KINDS[kind].read(path)
    except REFUSALS as error:
        text = str(error)
        return ("refused", text) if "Traceback" not in text else ("traceback", text)
    except Exception:
        return "traceback", traceback.format_exc()
    return "taken", ""


def main() -> None:
    """Answer until the input ends; what the program prints goes nowhere."""
    replies = os.fdopen(os.dup(1), "w")
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    warnings.simplefilter("ignore")
    paths: dict[str, Path] = {}
    while True:
        try:
            kind, content = pickle.load(sys.stdin.buffer)
        except EOFError:
            return
        if kind not in paths:
            paths[kind] = make(kind)
        print(file=replies, flush=True)
        print(json.dumps(answer(kind, content, paths[kind])), file=replies, flush=True)


if __name__ == "__main__":
    main()
