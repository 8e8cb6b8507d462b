# SPDX-License-Identifier: Apache-2.0
"""Write runs as one page."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path

from presswork import __version__
from presswork.report.pack import Blocks
from presswork.report.page_file import assemble_page
from presswork.report.run_data import pack_run
from presswork.results import Result
from presswork.results.whole_file import write_whole

BUDGET = 20_000_000
"""Bytes of a page at most, as long as two steps with their first fields fit."""
_FRAME = 1_000_000
"""Bytes for the program of the page, meshes, history and case."""


def write_report(results: Result | Sequence[Result], path: Path | str | None = None, *, budget: int = BUDGET) -> Path:
    """Write one HTML page of a run, or of several to compare, and return its path.

    path: by default report.html in the first run's folder. budget: size [bytes] by which fields and saved steps are
    chosen, half a megabyte of it for the program of the page; the page lists what was left out. The page holds
    everything it shows and needs no network. Raises OutputError if results cannot be read or the page not be written.
    """
    runs = [results] if isinstance(results, Result) else list(results)
    target = runs[0].folder / "report.html" if path is None else Path(path)
    blocks = Blocks()
    share = max(budget - _FRAME, 0) // len(runs)
    header = {
        "version": __version__,
        "written": datetime.now(UTC).strftime("%Y-%m-%d %H:%M UTC"),
        "runs": [pack_run(run, blocks, share) for run in runs],
    }
    content = assemble_page(header, blocks).encode()
    write_whole(target, content)
    return target
