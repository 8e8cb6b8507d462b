# SPDX-License-Identifier: Apache-2.0
"""Runs as one page that a browser opens without a network or a server.

`write_report` packs what a person looks at into the page of `page/`: outer surface and fields at the saved steps,
tools, history, contact stress, forming limit, case and summary. It reads output folders alone, through `results`.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
