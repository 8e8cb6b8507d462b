# SPDX-License-Identifier: Apache-2.0
"""The output folder: written by a run, a whole file at a time, and read back by `Result`."""

from presswork.results.checkpoint import load_checkpoint, save_checkpoint
from presswork.results.folder import occupy, open_output_folder
from presswork.results.history import History, history_columns, read_history
from presswork.results.outline_file import write_outline
from presswork.results.reader import Result, ResultBlock, ResultError, ResultMesh
from presswork.results.summary import write_summary
from presswork.results.vtkhdf import append_step, count_steps, truncate_steps
from presswork.results.whole_file import OutputError

__all__ = [
    "History",
    "OutputError",
    "Result",
    "ResultBlock",
    "ResultError",
    "ResultMesh",
    "append_step",
    "count_steps",
    "history_columns",
    "load_checkpoint",
    "occupy",
    "open_output_folder",
    "read_history",
    "save_checkpoint",
    "truncate_steps",
    "write_outline",
    "write_summary",
]
