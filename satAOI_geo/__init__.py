"""The part of a floor that a swing-arm troweling robot can trowel.

    from satAOI_adapters import read_plan, write_aoi
    from satAOI_geo import area_of_interest

    result = area_of_interest(read_plan("hall.dxf"))
    print(result.report.aoi.area_m2)
    write_aoi("aoi.dxf", result)

The names below are the public ones, in reading order. Each is imported when it is first used,
so that the command line starts without numpy, shapely and numba.
"""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from satAOI_geo.aoi import Aoi, Loop, Outline
    from satAOI_geo.errors import (
        DrawingError,
        EmptyPlanError,
        InputError,
        LimitError,
        NoRouteError,
        NothingFreeError,
        RobotError,
        SatAoiError,
        StartBlockedError,
        StartError,
        UnitError,
        UnreadableError,
    )
    from satAOI_geo.lattice import Lattice
    from satAOI_geo.pipeline import Result, area_of_interest
    from satAOI_geo.plan import Circle, Finding, FloorPlan, Frame, Kind, Obstacle, Source
    from satAOI_geo.reasons import Patch, Reason
    from satAOI_geo.report import Report
    from satAOI_geo.robot import ROBOTS, Pose, Robot
    from satAOI_geo.route import Route, RouteMap
    from satAOI_geo.search import Search
    from satAOI_geo.settings import Settings
    from satAOI_geo.start import Start, StartMark
    from satAOI_geo.units import MM_PER_UNIT
    from satAOI_geo.zones import SetDown, Zone

__version__ = "0.1.0"

__all__ = [
    "area_of_interest",
    "Settings",
    "StartMark",
    "Result",
    "FloorPlan",
    "Obstacle",
    "Kind",
    "Circle",
    "Finding",
    "Frame",
    "Source",
    "Robot",
    "Pose",
    "ROBOTS",
    "Lattice",
    "Search",
    "Start",
    "Aoi",
    "Outline",
    "Loop",
    "Zone",
    "SetDown",
    "Patch",
    "Reason",
    "Route",
    "RouteMap",
    "Report",
    "MM_PER_UNIT",
    "SatAoiError",
    "InputError",
    "RobotError",
    "DrawingError",
    "UnreadableError",
    "UnitError",
    "EmptyPlanError",
    "StartError",
    "StartBlockedError",
    "NothingFreeError",
    "NoRouteError",
    "LimitError",
]

_NAMES_OF_MODULE = {
    "pipeline": {"area_of_interest", "Result"},
    "plan": {"FloorPlan", "Obstacle", "Kind", "Circle", "Finding", "Frame", "Source"},
    "robot": {"Robot", "Pose", "ROBOTS"},
    "lattice": {"Lattice"},
    "search": {"Search"},
    "settings": {"Settings"},
    "start": {"Start", "StartMark"},
    "zones": {"Zone", "SetDown"},
    "reasons": {"Patch", "Reason"},
    "aoi": {"Aoi", "Outline", "Loop"},
    "route": {"Route", "RouteMap"},
    "report": {"Report"},
    "units": {"MM_PER_UNIT"},
}


def __getattr__(name: str) -> object:
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    home = next((home for home, names in _NAMES_OF_MODULE.items() if name in names), "errors")
    return getattr(import_module(f"{__name__}.{home}"), name)


def __dir__() -> list[str]:
    return sorted([*globals(), *__all__])
