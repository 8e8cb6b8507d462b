# SPDX-License-Identifier: Apache-2.0
"""Which libraries may run here: those compiled here, those allowed by name, all if the environment allows it.

The code of a library does whatever its author wants, so a case from elsewhere must not run it unasked. A library is
known by its content: one that is replaced has to be allowed anew.
"""

from __future__ import annotations

import hashlib
import os
from pathlib import Path

VARIABLE = "PRESSWORK_RUN_USER_CODE"
"""Environment variable: 1 allows all libraries of this process and those that it starts, as --run-user-code does."""


def allow_all() -> None:
    """Let this process, and those that it starts, run any library that a case names."""
    os.environ[VARIABLE] = "1"


def allow_library(library: Path | str) -> None:
    """Let cases of this user run a library from now on, as long as its content stays. Raises OSError."""
    path = Path(library).resolve()
    if not is_allowed(path):
        listed = _list_file()
        listed.parent.mkdir(parents=True, exist_ok=True)
        with listed.open("a", encoding="utf-8") as file:
            file.write(f"{_digest(path)}  {path}\n")


def is_allowed(library: Path) -> bool:
    """Return whether a library may run."""
    if os.environ.get(VARIABLE) == "1":
        return True
    try:
        return _digest(library) in _list_file().read_text(encoding="utf-8").split()
    except (OSError, UnicodeDecodeError):
        return False


def _list_file() -> Path:
    """Return the file of this user that lists libraries by SHA-256, with the paths that they had."""
    state = os.environ.get("XDG_STATE_HOME")
    return Path(state or Path.home() / ".local" / "state") / "presswork" / "allowed_libraries"


def _digest(library: Path) -> str:
    with library.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
