# SPDX-License-Identifier: Apache-2.0
"""A process that opens and changes no file of a user but those in the opened folder, whatever a case or a file holds.

Python reports every file that it opens, makes, renames or deletes; what libraries in C do by themselves (HDF5) it does
not see.
"""

from __future__ import annotations

import os
import sys
import sysconfig
import tempfile
from pathlib import Path

_FOLLOWED = {"open": (0,), "os.truncate": (0,), "os.chmod": (0,), "os.chown": (0,), "os.utime": (0,)}
"""Events by the places of their paths, whose links the call follows."""
_NOT_FOLLOWED = {
    "os.rename": (0, 1),
    "os.remove": (0,),
    "os.mkdir": (0,),
    "os.rmdir": (0,),
    "os.link": (0, 1),
    "os.symlink": (1,),
}
"""Events that act on an entry of a folder, not on what a link there leads to."""


def confine(root: Path, scratch: Path) -> None:
    """Raise PermissionError from now on where a file is opened or changed outside the folders and the program's own.

    root: the opened folder, where relative paths begin from now on. scratch: takes temporary files.
    """
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
    allowed = [os.path.realpath(str(path)) for path in (root, scratch, *own, *system, *settings)]
    tempfile.tempdir = os.environ["TMPDIR"] = str(scratch)
    os.chdir(root)

    def look(event: str, arguments: tuple[object, ...]) -> None:
        for place in _FOLLOWED.get(event, ()):
            _require_inside(arguments[place], allowed, is_followed=True)
        for place in _NOT_FOLLOWED.get(event, ()):
            _require_inside(arguments[place], allowed, is_followed=False, folder=arguments[-1])

    sys.addaudithook(look)


def _require_inside(named: object, allowed: list[str], *, is_followed: bool, folder: object = -1) -> None:
    """Raise PermissionError unless a path leads into the folders; folder: the open one where it begins, if not -1."""
    if isinstance(named, os.PathLike):
        named = named.__fspath__()
    if not isinstance(named, str | bytes):
        return
    path = os.fsdecode(named)
    if isinstance(folder, int) and folder >= 0:
        path = os.path.join(f"/proc/self/fd/{folder}", path)
    if is_followed:
        path = os.path.realpath(path)
    else:
        before, name = os.path.split(path.rstrip(os.sep))
        path = os.path.join(os.path.realpath(before), name)
    if not any(path == place or path.startswith(place + os.sep) for place in allowed):
        raise PermissionError(f"{path} is outside the folder that was opened")
