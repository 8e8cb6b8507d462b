# SPDX-License-Identifier: Apache-2.0
"""A process that reads mutants one after the other, so that one that kills it or never ends is seen from outside.

Run as a module. Each request is a pickled (kind, content); each answer a line of JSON, of "taken", "refused" or
"traceback" and what was said.
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


def answer(kind: str, content: bytes, folders: dict[str, Path]) -> tuple[str, str]:
    """Read one mutant; return the verdict and what was said."""
    from tests.mutants.kinds import KINDS, REFUSALS

    if kind not in folders:
        folders[kind] = Path(tempfile.mkdtemp(prefix="mutants_"))
        KINDS[kind].make(folders[kind])
    path = folders[kind] / KINDS[kind].name
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
    folders: dict[str, Path] = {}
    while True:
        try:
            kind, content = pickle.load(sys.stdin.buffer)
        except EOFError:
            return
        print(json.dumps(answer(kind, content, folders)), file=replies, flush=True)


if __name__ == "__main__":
    main()
