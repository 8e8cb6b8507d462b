# SPDX-License-Identifier: Apache-2.0
"""Results of a member that lie on a worker, and a folder that a worker needs."""

from __future__ import annotations

import io
import tarfile
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from presswork.results import OutputError
from presswork.results.whole_file import create_file
from presswork.study.cluster.on_worker import delete_folder, read_part

if TYPE_CHECKING:
    from distributed import Client

PART = 8 << 20
"""Bytes that pass through the scheduler at a time."""


def bring_back(client: Client, news: Mapping[str, Any], place: Path) -> Path:
    """Fetch the files of an attempt into a folder beside the member's place, and return it.

    news: the worker's last report. Raises ConnectionError if the worker is gone, OSError if the files cannot be written
    here, OutputError for names that lead elsewhere.
    """
    folder = place.with_name(f".{place.name}-{news['attempt']}")
    if any(Path(name).name != name for name in (folder.name, *(name for name, _ in news["files"]))):
        raise OutputError(f"worker {news['worker']} names files outside its folder")
    folder.mkdir()
    worker = news["worker"]
    for name, size in news["files"]:
        with create_file(folder / name) as file:
            for offset in range(0, size, PART):
                file.write(_ask(client, worker, read_part, f"{news['folder']}/{name}", offset, PART))
    _ask(client, worker, delete_folder, news["folder"])
    return folder


def _ask(client: Client, worker: str, function: Any, *arguments: object) -> Any:
    """Call a function on a worker. Raises ConnectionError if that cannot be done."""
    try:
        return client.run(function, *arguments, workers=[worker])[worker]
    except (OSError, KeyError, ValueError) as error:
        raise ConnectionError(str(error)) from error


def pack_folder(folder: Path) -> bytes:
    """Return the files of a folder as a tar file."""
    packed = io.BytesIO()
    with tarfile.open(fileobj=packed, mode="w") as archive:
        for path in sorted(folder.iterdir()):
            if path.is_file() and not path.is_symlink():
                archive.add(path, path.name)
    return packed.getvalue()
