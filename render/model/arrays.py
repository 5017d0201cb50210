"""Names of array types by what their numbers are. Shapes stand in the docstrings of those that take or return them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

HalfArray = NDArray[np.float16]
FloatArray = NDArray[np.float32]
DoubleArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]
IntArray = NDArray[np.int32]
LongArray = NDArray[np.int64]
WordArray = NDArray[np.uint64]
IndexArray = NDArray[np.intp]
