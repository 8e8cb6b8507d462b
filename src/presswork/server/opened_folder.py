# SPDX-License-Identifier: Apache-2.0
"""The folder that was opened: what lies in it can be named, nothing else."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import h5py

from presswork.results.folder import CASE, CHECKPOINT, HISTORY, RESULTS, SUMMARY
from presswork.text_file import UnreadableError, read_text

MOST_DEEP = 5
"""Folders in each other that are searched for runs."""


class RefusedError(Exception):
    """A request that is not answered; status: as HTTP counts them."""

    def __init__(self, message: str, status: int = 400) -> None:
        super().__init__(message)
        self.status = status


class OpenedFolder:
    """A folder and what lies in it, links that lead out of it excepted."""

    def __init__(self, root: Path) -> None:
        self.root = root.resolve()
        self._plain: dict[Path, int] = {}

    def find(self, name: str) -> Path:
        """Return the path that a name stands for, links followed. Raises RefusedError if it is not in the folder."""
        try:
            path = (self.root / name).resolve()
            path.exists()  # raises for a name that no file can have
        except (OSError, ValueError, RuntimeError) as error:
            raise RefusedError("this is not the name of a file") from error
        if not path.is_relative_to(self.root):
            raise RefusedError("it is not in the folder that was opened", 403)
        return path

    def name(self, path: Path) -> str:
        """Return how pages name a path in the folder."""
        return path.relative_to(self.root).as_posix()

    def walk(self) -> Iterator[Path]:
        """Yield the folders in it, itself first, without following links or looking into hidden ones."""
        level = [self.root]
        for _ in range(MOST_DEEP + 1):
            below: list[Path] = []
            for folder in level:
                yield folder
                try:
                    entries = sorted(folder.iterdir())
                except OSError:
                    continue
                below += [e for e in entries if not e.name.startswith(".") and not e.is_symlink() and e.is_dir()]
            level = below

    def find_run(self, name: str) -> Path:
        """Return the folder of a run whose files are all its own. Raises RefusedError."""
        folder = self.find(name)
        path, *others = [self.find(f"{name}/{file}") for file in (RESULTS, SUMMARY, HISTORY, CASE, CHECKPOINT)]
        if odd := next((other for other in others if other.exists() and not other.is_file()), None):
            raise RefusedError(f"{self.name(odd)} is not a file", 403)
        if not path.is_file():
            raise RefusedError(f"{name} holds no results yet", 404)
        changed = path.stat().st_mtime_ns
        if self._plain.get(path) != changed:
            require_plain(path)
            self._plain[path] = changed
        return folder

    def require_own_files(self, data: object, folder: Path, key: str = "") -> None:
        """Raise RefusedError if a text of a case, read as a path from the case's folder, leads out of this one."""
        if isinstance(data, dict):
            for name, value in data.items():
                if not (name == "title" and not key):
                    self.require_own_files(value, folder, f"{key}.{name}" if key else str(name))
        elif isinstance(data, list):
            for i, value in enumerate(data):
                self.require_own_files(value, folder, f"{key}.{i}")
        elif isinstance(data, str):
            try:
                is_own = (folder / data).resolve().is_relative_to(self.root)
            except (OSError, ValueError, RuntimeError):
                is_own = False
            if not is_own:
                raise RefusedError(
                    f"{key} names a file outside the folder that was opened: open a folder with both", 403
                )


def require_plain(path: Path) -> None:
    """Raise RefusedError if an HDF5 file takes data from other files, which it could name anywhere."""

    def look(group: h5py.Group) -> None:
        for name in group:
            if isinstance(group.get(name, getlink=True), h5py.ExternalLink):
                raise RefusedError(f"{path.name} takes data from other files", 403)
            item = group.get(name)
            if isinstance(item, h5py.Group) and isinstance(group.get(name, getlink=True), h5py.HardLink):
                look(item)
            elif isinstance(item, h5py.Dataset) and (item.external or item.is_virtual):
                raise RefusedError(f"{path.name} takes data from other files", 403)

    try:
        with h5py.File(path, "r") as file:
            look(file)
    except (OSError, RuntimeError, RecursionError) as error:
        raise RefusedError(f"{path.name} cannot be read: {error}") from error


def read_case_data(path: Path) -> dict[str, Any]:
    """Return the data of a case file. Raises RefusedError."""
    try:
        return tomllib.loads(read_text(path))
    except (OSError, UnreadableError, ValueError, RecursionError) as error:
        raise RefusedError(f"{path.name} cannot be read: {error}") from error


def require_no_code(data: dict[str, Any]) -> None:
    """Raise RefusedError if a case names code of its own, which is run from a terminal only."""
    materials = data.get("materials")
    for name, material in materials.items() if isinstance(materials, dict) else ():
        if isinstance(material, dict) and "umat" in material:
            raise RefusedError(
                f"materials.{name}.umat is code, which is not run from the browser; use `presswork run` in a terminal",
                403,
            )
