# SPDX-License-Identifier: Apache-2.0
"""A process that opens no file of a user but those in the opened folder, whatever a case or a file that it names says.

Python reports every file that it opens; what libraries in C open by themselves (HDF5) it does not see.
"""

from __future__ import annotations

import os
import sys
import sysconfig
from pathlib import Path


def confine(*folders: Path) -> None:
    """From now on, raise PermissionError where a file is opened outside the folders and the program's own."""
    package = Path(__file__).parents[1]
    own = [sys.prefix, sys.base_prefix, *sysconfig.get_paths().values(), *filter(None, sys.path), package]
    system = [
        "/proc",
        "/sys",
        "/dev",
        "/usr",
        "/lib",
        "/lib64",
        "/etc/localtime",
        "/etc/mime.types",
        "/etc/fonts",
        "/var/cache",
    ]
    settings = [Path.home() / ".config" / "matplotlib", Path.home() / ".cache" / "matplotlib"]
    allowed = [os.path.realpath(str(path)) for path in (*folders, *own, *system, *settings)]

    def look(event: str, arguments: tuple[object, ...]) -> None:
        named = arguments[0] if event == "open" else None
        if isinstance(named, os.PathLike):
            named = named.__fspath__()
        if not isinstance(named, str | bytes):
            return
        path = os.path.realpath(os.fsdecode(named))
        if not any(path == folder or path.startswith(folder + os.sep) for folder in allowed):
            raise PermissionError(f"{path} is outside the folder that was opened")

    sys.addaudithook(look)
