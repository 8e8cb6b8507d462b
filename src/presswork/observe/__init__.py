# SPDX-License-Identifier: Apache-2.0
"""What is measured and followed in a run, one file an observer. No engine names one: `of_model.py` lists them."""
