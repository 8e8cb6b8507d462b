# SPDX-License-Identifier: Apache-2.0
"""Members of studies on the workers of a Dask cluster (extra `cluster`)."""
