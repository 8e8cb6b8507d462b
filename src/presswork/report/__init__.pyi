# SPDX-License-Identifier: Apache-2.0
from .page_file import assemble_page, make_policy
from .served_run import ServedRun
from .write import write_report

__all__ = ["ServedRun", "assemble_page", "make_policy", "write_report"]
