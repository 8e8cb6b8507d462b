# SPDX-License-Identifier: Apache-2.0
from .write import write_report

__all__ = ["write_report"]
