# SPDX-License-Identifier: Apache-2.0
"""Runs and cases of one folder in the browser, served to this machine alone.

`http.py` admits requests, `site.py` answers them; what they name is found by `opened_folder.py`, inside the folder or
not at all. Computing happens in processes of its own (`jobs.py`), never here.
"""
