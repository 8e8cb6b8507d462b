# SPDX-License-Identifier: Apache-2.0
"""The arrays that data is made of."""

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int32]
IndexArray = NDArray[np.intp]
BoolArray = NDArray[np.bool_]
MaskArray = NDArray[np.uint8]
