"""What scatters."""

from truing import Tolerance

TOLERANCES: list[Tolerance] = []
