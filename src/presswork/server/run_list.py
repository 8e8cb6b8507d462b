# SPDX-License-Identifier: Apache-2.0
"""What lies in the opened folder: runs, sweeps, case files."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from presswork.results.folder import CASE, RESULTS, SUMMARY
from presswork.server.jobs import Jobs
from presswork.server.opened_folder import OpenedFolder, RefusedError, read_case_data
from presswork.server.sweeps import TABLE
from presswork.text_file import UnreadableError, read_text

_PICTURES = ("mesh_formability", "mesh_", "shell_", "section", "force")
"""Beginnings of names of pictures, the most telling first."""
_MOST_BYTES = 16_000_000


class RunList:
    """Reads what there is; a file that has changed is read again."""

    def __init__(self, opened: OpenedFolder, jobs: Jobs) -> None:
        self._opened = opened
        self._jobs = jobs
        self._known: dict[Path, tuple[int, dict[str, Any]]] = {}

    def list_all(self) -> dict[str, Any]:
        """Return runs, sweeps and case files, each with what a list shows of it."""
        runs, sweeps, cases = [], [], []
        for folder in self._opened.walk():
            if (folder / RESULTS).is_file() or (folder / SUMMARY).is_file():
                runs.append(self._describe_run(folder))
                continue
            if (folder / TABLE).is_file() and any(folder.glob("member_*")):
                sweeps.append({"name": self._opened.name(folder), "members": len(list(folder.glob("member_*")))})
            cases += [self._describe_case(path) for path in sorted(folder.glob("*.toml")) if not path.is_symlink()]
        return {"folder": self._opened.root.name, "runs": runs, "sweeps": sweeps, "cases": [c for c in cases if c]}

    def _describe_run(self, folder: Path) -> dict[str, Any]:
        summary = self.read_summary(folder)
        state = self._jobs.state(folder, summary)
        case = self._read(folder / CASE, read_case_data)
        seconds = summary.get("wall_seconds")
        return {
            "name": self._opened.name(folder),
            "title": str(summary.get("title") or case.get("title", "")),
            "analysis": str(case.get("analysis", "")),
            "status": state["word"],
            "fraction": state["fraction"],
            "seconds": seconds.get("total") if isinstance(seconds, dict) else None,
            "warnings": len(summary.get("warnings") or []),
            "changed": max((p.stat().st_mtime for p in (folder / RESULTS, folder / SUMMARY) if p.is_file()), default=0),
            "picture": self.find_picture(folder) is not None,
        }

    def read_summary(self, folder: Path) -> dict[str, Any]:
        """Return a run's summary; empty without one, or if it is damaged."""
        return self._read(folder / SUMMARY, lambda path: json.loads(read_text(path)))

    def _describe_case(self, path: Path) -> dict[str, Any]:
        data = self._read(path, read_case_data)
        if not isinstance(data.get("analysis"), str) or "title" not in data:
            return {}
        return {"name": self._opened.name(path), "title": str(data["title"]), "analysis": data["analysis"]}

    def _read(self, path: Path, read: Any) -> dict[str, Any]:
        """Return the contents of a small file; empty if it cannot be read, or is a link out of the folder."""
        try:
            stat = path.stat()
            if path in self._known and self._known[path][0] == stat.st_mtime_ns:
                return self._known[path][1]
            self._opened.find(str(path))
            found = read(path) if stat.st_size < _MOST_BYTES else {}
        except (OSError, UnreadableError, ValueError, RecursionError, RefusedError):
            found = {}
            stat = None
        found = found if isinstance(found, dict) else {}
        if stat is not None:
            self._known[path] = (stat.st_mtime_ns, found)
        return found

    def find_picture(self, folder: Path) -> Path | None:
        """Return the picture that shows most of a run."""
        pictures = sorted((folder / "plots").glob("*.png"), reverse=True)
        pictures = [path for path in pictures if path.is_file() and not (path.is_symlink() or path.parent.is_symlink())]
        for start in _PICTURES:
            found = next((path for path in pictures if path.name.startswith(start)), None)
            if found:
                return found
        return pictures[0] if pictures else None
