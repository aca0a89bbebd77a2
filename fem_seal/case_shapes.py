"""All shapes of closure and seat that a case file may name."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from fem_seal import case_closures as closures
from fem_seal import case_seats as seats
from fem_seal.case_profiles import ClosureProfile, SeatProfile

Closure = Annotated[
    closures.Ball | closures.Cone | closures.Torus | closures.SphericalTip | closures.Disc | ClosureProfile,
    Field(discriminator="shape"),
]

Seat = Annotated[
    seats.Cone | seats.ConicalLand | seats.Sphere | seats.Torus | seats.Flat | seats.SharpEdge | SeatProfile,
    Field(discriminator="shape"),
]
