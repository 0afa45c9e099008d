"""Pilotage: reference maps for aircraft that find their position by sight when GNSS fails.

Each command of the program is a function of its name (`pilotage.prepare`, `pilotage.score` …), with the command's options as keyword
arguments. What flies is here, too: `pilotage.Map` reads an onboard map, `Map.match` finds a frame in it. Units stand in names, points are
WGS 84 with the longitude first. docs/python.md has the rest.
"""

from . import commands
from ._onboard import Camera, Chip, Fix, Map, MatchResult, MatchStats, Prior, TileDescriptors
from .commands import *
from .errors import DataError, GateNotMet, IntegrityError, InternalError, Interrupted, PilotageWarning, TryAgain, UsageError
from .program import Result
from .tables import read_table

__version__ = commands.VERSION
__all__ = [
    *commands.__all__,
    "Camera",
    "Chip",
    "DataError",
    "Fix",
    "GateNotMet",
    "IntegrityError",
    "InternalError",
    "Interrupted",
    "Map",
    "MatchResult",
    "MatchStats",
    "PilotageWarning",
    "Prior",
    "Result",
    "TileDescriptors",
    "TryAgain",
    "UsageError",
    "read_table",
]
