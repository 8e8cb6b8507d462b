# SPDX-License-Identifier: Apache-2.0
"""Problems set up for more than one test: meshes, models, loads, and what is measured on them."""
