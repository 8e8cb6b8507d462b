# SPDX-License-Identifier: Apache-2.0
"""What the server answers: pages, runs piece by piece, and what is to be done with a run."""

from __future__ import annotations

import os
import re
from collections.abc import Callable
from datetime import UTC, datetime
from importlib.resources import files
from pathlib import Path

from pydantic_core import PydanticCustomError

from presswork import __version__
from presswork.case import CaseError
from presswork.report import ServedRun, assemble_page, make_policy
from presswork.report.pack import Blocks
from presswork.results.folder import CASE, CHECKPOINT, RESULTS
from presswork.server.drafts import Drafts
from presswork.server.http import Request, Response, answer_json
from presswork.server.jobs import Jobs
from presswork.server.material_curves import describe_material, list_materials
from presswork.server.material_fit import fit_test
from presswork.server.opened_folder import OpenedFolder, RefusedError, read_case_data, require_no_code
from presswork.server.processes.metals import make_hot
from presswork.server.run_list import RunList
from presswork.server.scratch import Scratch
from presswork.server.sweeps import read_curves, read_sweep

_PAGE = files("presswork.server") / "page"
_KINDS = {"html": "text/html", "js": "text/javascript", "css": "text/css", "svg": "image/svg+xml"}
_MODULES = ("colours.js", "elements.js", "chart.js", "theme.js", "theme.css")
"""Files of the report's page that the pages of lists share with it."""


class Site:
    """One opened folder in the browser."""

    def __init__(self, root: Path) -> None:
        self.opened = OpenedFolder(root)
        self.scratch = Scratch()
        self.jobs = Jobs(self.opened.root, self.scratch.folder)
        self.list = RunList(self.opened, self.jobs)
        self.drafts = Drafts(self.opened, self.scratch.folder)
        self._runs: dict[str, ServedRun] = {}
        get: dict[str, Callable[[Request], Response]] = {
            "": lambda _: self._page("list.html"),
            "runs": lambda _: answer_json(self.list.list_all()),
            "run": self._run_page,
            "state": self._state,
            "news": self._news,
            "array": self._array,
            "range": lambda r: answer_json(self._run(r.get("run")).range(r.get("field"))),
            "picture": self._picture,
            "sweep": lambda _: self._page("sweep.html"),
            "new": lambda _: self._page("new.html"),
            "edit": lambda _: self._page("edit.html"),
            "starters": lambda _: answer_json(self.drafts.list_starters()),
            "draft": lambda r: answer_json(self.drafts.open(r.get("case"))),
            "drawing": lambda _: Response(self.drafts.draw_page().encode(), "text/html", make_policy()),
            "materials": lambda _: answer_json(list_materials()),
            "table": lambda r: answer_json(read_sweep(self.opened, r.get("sweep"))),
            "curves": lambda r: answer_json(read_curves(self.opened, r.get("sweep"))),
        }
        post: dict[str, Callable[[Request], Response]] = {
            "pause": lambda r: self._act(r, self.jobs.pause),
            "stop": lambda r: self._act(r, self.jobs.stop),
            "resume": self._resume,
            "create": lambda r: answer_json({"name": self.drafts.create(r.get("starter"), r.get("name"))}),
            "setup": self._set_up,
            "upload": lambda r: answer_json({"name": self.drafts.upload(r.get("case"), r.get("name"), r.body)}),
            "fit": self._fit,
            "complete": lambda r: answer_json(make_hot(r.get("name"))),
            "material": lambda r: answer_json(describe_material(r.get_json())),
            "check": self._check,
            "save": self._save,
            "begin": self._begin,
        }
        self.answers = {"GET": get, "POST": post}

    def answer(self, request: Request) -> Response:
        """Answer a request. Raises RefusedError or OutputError."""
        if request.method == "GET" and request.name.startswith("files/"):
            return self._page(request.name.removeprefix("files/"))
        answer = self.answers[request.method].get(request.name)
        if answer is None:
            raise RefusedError("there is no such page", 404)
        return answer(request)

    # --- pages -------------------------------------------------------------------------------------------------------

    def _page(self, name: str) -> Response:
        """Return a file of the pages."""
        known = {entry.name for entry in _PAGE.iterdir()}
        if name in known and "." in name:
            return Response((_PAGE / name).read_bytes(), _KINDS[name.rpartition(".")[2]])
        if name in _MODULES or name == "libraries/uplot.js":
            module = files("presswork.report") / "page"
            return Response(module.joinpath(*name.split("/")).read_bytes(), _KINDS[name.rpartition(".")[2]])
        raise RefusedError("there is no such file", 404)

    def _run_page(self, request: Request) -> Response:
        runs = [self._run(name) for name in request.query.get("run", [])[:8]]
        if not runs:
            raise RefusedError("the address names no run")
        header = {
            "version": __version__,
            "written": datetime.now(UTC).strftime("%Y-%m-%d %H:%M UTC"),
            "runs": [{**run.header(), "edit": self._find_case(run.folder)} for run in runs],
            "served": {"generations": [run.generation for run in runs]},
        }
        page = assemble_page(header, Blocks(), is_served=True)
        return Response(page.encode(), "text/html", make_policy(is_served=True))

    def _find_case(self, folder: Path) -> str:
        """Return the case file beside a run's folder that it was computed from, by its name; empty if there is none."""
        names = (folder.name, re.sub(r"_\d+$", "", folder.name))
        paths = (folder.with_name(f"{name}.toml") for name in names if folder != self.opened.root)
        return next((self.opened.name(p) for p in paths if p.is_file() and not p.is_symlink()), "")

    # --- runs --------------------------------------------------------------------------------------------------------

    def _run(self, name: str) -> ServedRun:
        folder = self.opened.find_run(name)
        key = self.opened.name(folder)
        if key not in self._runs:
            self._runs[key] = ServedRun(folder, key)
        return self._runs[key]

    def _state(self, request: Request) -> Response:
        folder = self.opened.find(request.get("run"))
        state = self.jobs.state(folder, self.list.read_summary(folder))
        return answer_json({**state, "has_results": (folder / RESULTS).is_file()})

    def _news(self, request: Request) -> Response:
        run = self._run(request.get("run"))
        state = self.jobs.state(run.folder, self.list.read_summary(run.folder))
        news = run.news(request.get_number("steps"), request.get_number("rows"))
        return answer_json({**news, "state": state})

    def _array(self, request: Request) -> Response:
        run = self._run(request.get("run"))
        if request.get_number("of") != run.generation:
            raise RefusedError("the results were replaced", 409)
        return answer_json(run.array(request.get("what"), request.get_number("step"), request.get("field", "")))

    def _picture(self, request: Request) -> Response:
        path = self.list.find_picture(self.opened.find(request.get("run")))
        if path is None:
            raise RefusedError("there is no picture", 404)
        return Response(path.read_bytes(), "image/png")

    def _act(self, request: Request, action: Callable[[Path], None]) -> Response:
        action(self.opened.find(request.get("run")))
        return answer_json({})

    def _resume(self, request: Request) -> Response:
        folder = self.opened.find(request.get("run"))
        data = read_case_data(self.opened.find(f"{request.get('run')}/{CASE}"))
        require_no_code(data)
        self.opened.require_own_files(data, folder)
        self.jobs.resume(folder)
        return answer_json({})

    # --- cases -------------------------------------------------------------------------------------------------------

    def _set_up(self, request: Request) -> Response:
        """Write the case of a process; an answer that will not do is a fault for the page to show."""
        starter, name, given = request.get("starter"), request.get("name"), request.get_json()
        try:
            return answer_json({"name": self.drafts.set_up(starter, name, given)})
        except RefusedError as error:
            if error.status != 400:
                raise
            return answer_json({"fault": str(error)})

    def _fit(self, request: Request) -> Response:
        """Fit laws to a file beside a case; a name under `save` writes them there as a material of that name."""
        asked, folder = request.get_json(), self.opened.find(request.get("case")).parent
        path = self.opened.find(f"{self.opened.name(folder)}/{request.get('file')}")
        if not path.is_file():
            raise RefusedError("there is no such file", 404)
        name = str(asked.get("save") or "")
        try:
            target = self.drafts.find_free(name, folder) if name else None
            found = fit_test(path, asked, target)
        except (CaseError, PydanticCustomError, RefusedError) as error:
            return answer_json({"fault": str(error)})
        return answer_json({**found, "saved": target.name if target else ""})

    def _check(self, request: Request) -> Response:
        asked = request.get_json()
        data = asked.get("data")
        found = self.drafts.check(
            request.get("case"),
            str(asked.get("text", "")),
            data if isinstance(data, dict) else None,
            keep=asked.get("keep") is True,
        )
        return answer_json(found)

    def _save(self, request: Request) -> Response:
        asked = request.get_json()
        self.drafts.save(request.get("case"), str(asked.get("text", "")), str(asked.get("before", "")))
        return answer_json({})

    def _begin(self, request: Request) -> Response:
        """Run a case into the first folder of its name that holds no results."""
        case = self.opened.find(request.get("case"))
        data = read_case_data(case)
        require_no_code(data)
        self.opened.require_own_files(data, case.parent)
        names = [case.with_suffix(""), *(case.with_name(f"{case.stem}_{i}") for i in range(2, 10_000))]
        used = (RESULTS, CHECKPOINT)
        free = (path for path in names if not (path.is_file() or path.is_symlink()))
        folder = next(path for path in free if not any(os.path.lexists(path / file) for file in used))
        self.jobs.begin(case, folder)
        return answer_json({"run": self.opened.name(folder)})

    def close(self) -> None:
        """Stop the runs begun here, at their checkpoints, and remove drawings."""
        self.jobs.close()
        self.drafts.close()
        self.scratch.close()
