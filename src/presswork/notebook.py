# SPDX-License-Identifier: Apache-2.0
"""Results and cases as notebooks show them: the page in a frame."""

from __future__ import annotations

import tempfile
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

from presswork import __version__
from presswork.case import CaseError, build_model, describe
from presswork.model import OneStepModel
from presswork.outcome import StartError
from presswork.recorder import write_start
from presswork.report import assemble_page
from presswork.report.pack import Blocks
from presswork.report.run_data import pack_run
from presswork.results import OutputError, Result

if TYPE_CHECKING:
    from presswork.case.any_case import AnyCase

_BYTES = 6_000_000
"""Bytes of the numbers of a page at most: a notebook keeps what it shows."""


def show_result(result: Result) -> str:
    """Return the page of a run in a frame, as HTML; of results that cannot be read, why."""
    try:
        return _frame(result, 640)
    except OutputError as error:
        return f"<pre>{escape(str(error))}</pre>"


def show_case(case: AnyCase) -> str:
    """Return the case in words, below a drawing of its start, as HTML; of one that cannot be computed, why.

    A case whose materials are code of its own is described, not drawn: showing it runs nothing.
    """
    try:
        model = build_model(case, run_user_code=False)
        words = f"<pre>{escape(describe(model))}</pre>"
        if isinstance(model, OneStepModel) or any(material.umat for material in model.materials):
            return words
        with tempfile.TemporaryDirectory() as place:
            write_start(model, Path(place))
            return _frame(Result(place), 420, is_drawing=True) + words
    except (CaseError, StartError, OutputError) as error:
        return f"<pre>{escape(str(error))}</pre>"


def _frame(result: Result, height: int, **more: Any) -> str:
    blocks = Blocks()
    run = pack_run(result, blocks, _BYTES)
    page = assemble_page({"version": __version__, "written": "", "runs": [run], **more}, blocks)
    style = f"width: 100%; height: {height}px; border: 1px solid #d9dde3"
    name = escape(run["title"])
    return f'<iframe srcdoc="{escape(page)}" sandbox="allow-scripts" title="{name}" style="{style}"></iframe>'
