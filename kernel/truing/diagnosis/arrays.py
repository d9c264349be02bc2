"""The kinds of arrays that a diagnosis works with."""

import numpy as np
from numpy.typing import NDArray

Matrix = NDArray[np.float64]
Mask = NDArray[np.bool_]
Places = NDArray[np.intp]
Sides = NDArray[np.int8]
"""By row: 1 where the true value lies above the reading, -1 where it lies below, 0 where it was read."""
