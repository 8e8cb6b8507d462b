# SPDX-License-Identifier: Apache-2.0
from .checkpoint import load_checkpoint, save_checkpoint
from .folder import occupy, open_output_folder
from .history import History, history_columns, read_history
from .outline_file import write_outline
from .reader import Result, ResultBlock, ResultError, ResultMesh
from .summary import write_summary
from .vtkhdf import append_step, count_steps, truncate_steps
from .whole_file import OutputError

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
