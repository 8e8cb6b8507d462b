# SPDX-License-Identifier: Apache-2.0
"""Cases that are being edited: read, checked and drawn at every change, saved with their comments."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
import tempfile
import threading
import tomllib
from importlib.resources import files
from pathlib import Path
from typing import Any

from presswork import __version__
from presswork.case import json_schema
from presswork.case.case_file import write_as_run
from presswork.case.errors import CaseError, explain_syntax
from presswork.case.kinds import KINDS
from presswork.examples import copy_example, list_examples
from presswork.report import assemble_page
from presswork.report.pack import Blocks
from presswork.report.run_data import pack_run
from presswork.results import Result
from presswork.results.whole_file import write_whole
from presswork.server.drawing import MOTION
from presswork.server.opened_folder import OpenedFolder, RefusedError
from presswork.server.processes import PROCESSES
from presswork.server.toml_text import rewrite

_STARTERS = files("presswork.server") / "starters"
_LONGEST = 60.0
"""Seconds that a draft may take to be checked and drawn."""
_DRAWING_BYTES = 1_000_000
_LARGEST_CASE = 2_000_000
_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_. -]{0,80}")
_UPLOADS = ("stl", "step", "stp", "dxf", "csv", "txt", "inp", "msh", "unv", "vtk", "toml")


class Drafts:
    """The cases of an opened folder that are edited."""

    def __init__(self, opened: OpenedFolder, scratch: Path) -> None:
        """scratch: a folder for drawings."""
        self._opened = opened
        self.folder = scratch
        self._drawn = 0
        self._process: subprocess.Popen[str] | None = None
        self._lock = threading.Lock()

    # --- begin and save ----------------------------------------------------------------------------------------------

    def list_starters(self) -> list[dict[str, Any]]:
        """Return what a new case may begin with: the processes, with what each asks first, and the examples."""
        examples = list_examples().items()
        return [
            *(process.to_data() for process in PROCESSES.values()),
            *({"name": name, "title": title, "kind": "example"} for name, title in examples),
        ]

    def set_up(self, starter: str, name: str, given: dict[str, Any]) -> str:
        """Write a process's case, filled in with what was answered, into the folder; return the case's name.

        Raises RefusedError that names what an answer lacks.
        """
        process = PROCESSES.get(starter)
        if process is None:
            raise RefusedError(f"there is no process {starter}", 404)
        path = self.find_free(name)
        text = (_STARTERS / f"{starter}.toml").read_text(encoding="utf-8")
        data = tomllib.loads(text)
        process.fill(data, process.read(given))
        if name != starter:
            data["title"] = name
        content = rewrite(text, data).encode()
        write_whole(path, content)
        return self._opened.name(path)

    def create(self, starter: str, name: str) -> str:
        """Copy an example with its files, or set up a process, into the folder under a name; return the case's name."""
        if starter in PROCESSES:
            return self.set_up(starter, name, {})
        path = self.find_free(name)
        try:
            with tempfile.TemporaryDirectory(dir=self.folder) as place:
                copied = copy_example(starter, place)
                for file in Path(place).iterdir():
                    target = path if file == copied else self._new_file(file.name)
                    if not os.path.lexists(target):
                        content = file.read_bytes()
                        write_whole(target, _retitle(content, starter, name) if file == copied else content)
        except CaseError as error:
            raise RefusedError(str(error), 404) from error
        return self._opened.name(path)

    def find_free(self, name: str, folder: Path | None = None) -> Path:
        """Return where a new TOML file of a name goes. Raises RefusedError if there is one."""
        path = self._new_file(
            f"{name}.toml", "" if folder is None or folder == self._opened.root else self._opened.name(folder)
        )
        if os.path.lexists(path):
            raise RefusedError(f"{path.name} is there already; choose another name", 409)
        return path

    def _new_file(self, name: str, folder: str = "") -> Path:
        """Return where a file of that name goes. Raises RefusedError for a name that is none of a plain file."""
        if not _NAME.fullmatch(name) or ".." in name:
            raise RefusedError(
                "a name has letters, digits, blanks, points and hyphens, and begins with a letter or digit"
            )
        path = self._opened.find(f"{folder}/{name}" if folder else name)
        if (path.exists() and not path.is_file()) or not path.parent.is_dir():
            raise RefusedError(f"{name} cannot be a file here")
        return path

    def open(self, name: str) -> dict[str, Any]:
        """Return a case's text, its data and the schema of its kind."""
        path = self._find_case(name)
        if not path.is_file():
            raise RefusedError(f"there is no case {name}", 404)
        if path.stat().st_size > _LARGEST_CASE:
            raise RefusedError(f"{name} is too large to edit")
        text = path.read_text(encoding="utf-8")
        return {"text": text, "draft": self._read_draft(path, text), **self.read(text)}

    def read(self, text: str) -> dict[str, Any]:
        """Return the data of a text and the schema of its kind."""
        data = _parse(text)
        kind = next((kind for kind, entry in KINDS.items() if data.get("analysis") in entry.analyses), "plane")
        return {"data": data, "kind": kind, "schema": json_schema(kind)}

    def save(self, name: str, text: str, before: str) -> None:
        """Replace the case's file, unless someone has changed it since `before`."""
        path = self._find_case(name)
        _parse(text)
        if path.is_file() and path.read_text(encoding="utf-8") != before:
            raise RefusedError(f"{name} was changed elsewhere meanwhile; copy your text, and open it anew", 409)
        content = text.encode()
        write_whole(path, content)
        self._keep(path, text)

    def _keep(self, path: Path, text: str) -> None:
        """Keep a text as the draft of a case; none where it is that of the file."""
        draft = _draft_of(path)
        if draft.is_symlink() or (draft.exists() and not draft.is_file()):
            return
        if path.is_file() and path.read_text(encoding="utf-8") == text:
            draft.unlink(missing_ok=True)
        else:
            content = text.encode()
            write_whole(draft, content)

    def _read_draft(self, path: Path, text: str) -> str:
        """Return the draft of a case; empty if there is none, or it is the text."""
        draft = _draft_of(path)
        if not draft.is_file() or draft.is_symlink() or draft.stat().st_size > _LARGEST_CASE:
            return ""
        kept = draft.read_text(encoding="utf-8", errors="replace")
        return "" if kept == text else kept

    def _find_case(self, name: str) -> Path:
        path = self._opened.find(name)
        if path.suffix != ".toml":
            raise RefusedError("a case file ends with .toml", 403)
        return path

    def upload(self, case: str, name: str, content: bytes) -> str:
        """Write a file beside a case and return its name. Raises RefusedError for what no case could use."""
        folder = self._find_case(case).parent
        path = self._new_file(name, self._opened.name(folder) if folder != self._opened.root else "")
        ending = path.suffix.lower().removeprefix(".")
        if ending not in _UPLOADS:
            raise RefusedError(f"no case takes a .{ending} file; it may be {', '.join(_UPLOADS)}")
        _require_content(ending, content)
        if path.exists() and path.read_bytes() != content:
            raise RefusedError(f"another {name} exists there already; rename yours", 409)
        write_whole(path, content)
        return path.name

    # --- check and draw ----------------------------------------------------------------------------------------------

    def check(self, name: str, text: str, data: dict[str, Any] | None, *, keep: bool = False) -> dict[str, Any]:
        """Return the text with the data in it, and problems or the description; the start is drawn if it can be.

        keep: whether the text is kept as a draft beside the case, until it is saved.
        """
        path = self._find_case(name)
        try:
            text = text if data is None else rewrite(text, data)
            found = {"text": text, **self.read(text)}
        except RefusedError as error:
            return {"text": text, "problems": [{"key": "", "text": str(error)}]}
        data = found["data"]
        if keep:
            self._keep(path, text)
        try:
            self._opened.require_own_files({**data, "title": ""}, path.parent)
        except RefusedError as error:
            return {**found, "problems": [{"key": str(error).split(" ")[0], "text": str(error)}]}
        with self._lock:
            case = self.folder / "draft.toml"
            try:
                draft = write_as_run(data, path.parent)
            except (AttributeError, KeyError, TypeError, ValueError):  # tables where none belong: the schema reports it
                draft = text
            write_whole(case, draft.encode())
            answer = self._ask({"case": str(case), "folder": str(self.folder)})
            if answer.pop("is_drawn", False):
                self._drawn += 1
                answer["drawn"] = self._drawn
        plain = json.dumps(answer).replace(json.dumps(f"{case}: ")[1:-1], "").replace(f"{path.parent}/", "")
        return {**found, **json.loads(plain)}

    def draw_page(self) -> str:
        """Return the page of the last case that could be drawn. Raises OutputError if there was none."""
        with self._lock:
            blocks = Blocks()
            run = pack_run(Result(self.folder), blocks, _DRAWING_BYTES)
            motion = json.loads((self.folder / MOTION).read_text(encoding="utf-8"))
        run["steps"] = [{**run["steps"][0], **moment} for moment in motion["moments"]]
        run["symmetry"] = run["symmetry"] or motion["symmetry"]
        header = {"version": __version__, "written": "", "runs": [run], "is_drawing": True}
        return assemble_page(header, blocks)

    def _ask(self, request: dict[str, str]) -> dict[str, Any]:
        """Return the answer of the checking process; one that takes too long is ended."""
        if self._process is None or self._process.poll() is not None:
            command = [sys.executable, "-P", "-m", "presswork.server.drawing", str(self._opened.root), str(self.folder)]
            pipe = subprocess.PIPE
            self._process = subprocess.Popen(
                command, stdin=pipe, stdout=pipe, stderr=subprocess.DEVNULL, text=True, start_new_session=True
            )
        process = self._process
        assert process.stdin is not None
        assert process.stdout is not None
        timer = threading.Timer(_LONGEST, process.kill)
        timer.start()
        try:
            process.stdin.write(json.dumps(request) + "\n")
            process.stdin.flush()
            while line := process.stdout.readline():
                if line.startswith("{"):
                    answer: dict[str, Any] = json.loads(line)
                    return answer
        except BrokenPipeError:
            pass
        finally:
            timer.cancel()
        text = f"this case cannot be drawn: it takes longer than {_LONGEST:.0f} s, or more memory than there is"
        return {"problems": [{"key": "", "text": text}]}

    def close(self) -> None:
        """End the checking process."""
        if self._process is not None:
            self._process.kill()
            self._process.wait()


def _draft_of(path: Path) -> Path:
    """Return the hidden file beside a case that keeps what was typed and not saved."""
    return path.with_name(f".{path.name}.draft")


def _retitle(content: bytes, starter: str, name: str) -> bytes:
    """Return a case that has a name of its own with that as its title instead of the example's."""
    if name == starter:
        return content
    return re.sub(rb"^title *=.*$", f'title = "{name}"'.encode(), content, count=1, flags=re.MULTILINE)


def _parse(text: str) -> dict[str, Any]:
    """Return the data of TOML. Raises RefusedError."""
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise RefusedError(f"not valid TOML: {error}; {explain_syntax(text, error)}") from error
    except (ValueError, RecursionError) as error:
        raise RefusedError(f"not valid TOML: {error}") from error


def _require_content(ending: str, content: bytes) -> None:
    """Raise RefusedError for content that does not fit the name's ending."""
    if ending == "stl" and content.lstrip()[:5].lower() != b"solid":
        count = int.from_bytes(content[80:84], "little")
        if len(content) < 84 or len(content) != 84 + 50 * count or not count:
            raise RefusedError("this is not an STL file: its length is not that of its triangles")
    if ending in ("stl", "msh", "vtk"):
        return
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = content.decode("latin-1")
    if "\x00" in text:
        raise RefusedError(f"this is not a file of {ending.upper()}: it has bytes that are not text")
    if ending in ("step", "stp") and not text.lstrip().upper().startswith("ISO-10303-21"):
        raise RefusedError("this is not a STEP file: it does not begin with ISO-10303-21")
    if ending == "inp" and re.search(r"^\s*\*\s*include", text, re.IGNORECASE | re.MULTILINE):
        raise RefusedError("*INCLUDE takes in other files; join them into one first")
