"""Exact conversion factors, the only place a unit is a number."""

from typing import Final

MM_PER_UNIT: Final = {
    "um": 0.001,
    "mm": 1.0,
    "cm": 10.0,
    "dm": 100.0,
    "m": 1000.0,
    "km": 1_000_000.0,
    "in": 25.4,
    "ft": 304.8,
    "yd": 914.4,
    "mi": 1_609_344.0,
}
"""Millimetres in one drawing unit; the international inch (1959) is 25.4 mm by definition."""

MM2_PER_M2: Final = 1_000_000.0
