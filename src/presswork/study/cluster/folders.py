# SPDX-License-Identifier: Apache-2.0
"""Folders of attempts: each beside the member's place, `.member_003-1a2b3c4d`, until one takes the place."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

from presswork.results import open_output_folder


def put_in_place(folder: Path, place: Path, *, overwrite: bool) -> None:
    """Move the results of an attempt to where they belong. Raises OSError and OutputError.

    overwrite: delete results that are there; other files stay.
    """
    if not any(folder.iterdir()):
        folder.rmdir()  # it did not begin
        return
    if not place.exists():
        folder.rename(place)
        return
    open_output_folder(place, overwrite=overwrite, resume=not overwrite and (place / "checkpoint.h5").exists())
    for path in folder.iterdir():
        os.replace(path, place / path.name)
    folder.rmdir()


def clear_attempts(parent: Path) -> None:
    """Delete what attempts have left, those of workers that were lost; such a worker's member may still be writing."""
    for folder in parent.glob(".*-????????"):
        if (folder.name.startswith((".member_", ".draw_"))) and folder.is_dir():
            shutil.rmtree(folder, ignore_errors=True)
