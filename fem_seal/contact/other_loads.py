"""Loads of the bodies besides the contact: fluid on wetted surfaces and in the gap, press fit, thermal strain."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from fem_seal.arrays import FloatArray
from fem_seal.bodies.condensed import CondensedBody
from fem_seal.bodies.constrained_body import LoadName
from fem_seal.contact.model import ContactModel

# What the wetted surfaces of a seal with one contact line may be called as well.
_WETTED = {"inner": 0, "outer": 1}


@dataclass(frozen=True)
class BodyLoads:
    """Loads away from the solid contact, and the fluid pressure between the surfaces.

    Parameters
    ----------
    closure, seat : mapping
        Magnitude of each of the body's `fem_seal.bodies.condensed.CondensedBody.loads`: fluid pressure [Pa] on each
        wetted surface, by its number from the axis outwards, "inner" and "outer" being 0 and 1; of a seat with fixed
        wall also "wall", its motion inwards [m]; of a closure also "expansion", its thermal strain beyond that of the
        seat [-]; of bodies whose temperature differs from place to place "heat", a share of it.
    gap_pressure : ndarray, shape (m,), optional
        Fluid pressure at the points of the contact line [Pa].
    lifting : float
        Axial force of a fluid on the closure that deforms no body, positive where it lifts [N].
    temperature : mapping, optional
        Of "closure" and "seat", all over or at their nodes [K]; it acts through the loads of the bodies, and stands
        here for all who show it. Empty where it is not given.

    Examples
    --------
    >>> import fem_seal
    >>> fem_seal.BodyLoads.press_fit(20e-6)
    BodyLoads(closure={}, seat={'wall': 2e-05})
    """

    closure: Mapping[LoadName, float] = field(default_factory=dict)
    seat: Mapping[LoadName, float] = field(default_factory=dict)
    gap_pressure: FloatArray | None = field(default=None, repr=False)
    lifting: float = field(default=0.0, repr=False, kw_only=True)
    temperature: Mapping[str, FloatArray | float] = field(default_factory=dict, repr=False)

    def __post_init__(self) -> None:
        for body in ("closure", "seat"):
            given: Mapping[LoadName, float] = getattr(self, body)
            if not given.keys().isdisjoint(_WETTED):
                numbered = {_WETTED.get(str(name), name): size for name, size in given.items()}
                object.__setattr__(self, body, numbered)

    @classmethod
    def of_fluid(
        cls, wetted: tuple[float, float], gap_pressure: FloatArray, at_rest: BodyLoads | None = None
    ) -> BodyLoads:
        """Fluid on both bodies, and what acts on them without any.

        Parameters
        ----------
        wetted : tuple of float
            Fluid pressure on the wetted surface inside and on the one outside of the contact line [Pa].
        gap_pressure : ndarray, shape (m,)
            Fluid pressure between the surfaces [Pa].
        at_rest : BodyLoads, optional
            Such as a press fit; without a pressure in the gap.
        """
        rest = at_rest or cls()
        fluid: dict[LoadName, float] = dict(enumerate(wetted))
        return cls({**fluid, **rest.closure}, {**fluid, **rest.seat}, gap_pressure, rest.temperature)

    @classmethod
    def press_fit(cls, interference: float) -> BodyLoads:
        """A seat pressed into a rigid bore.

        Parameters
        ----------
        interference : float
            Radius of the housing less that of the bore [m].
        """
        return cls(seat={"wall": interference} if interference else {})

    def on(self, body: str) -> Mapping[LoadName, float]:
        """Loads of the body "closure" or "seat"."""
        return self.closure if body == "closure" else self.seat

    def opening(self, model: ContactModel) -> FloatArray:
        """How far these loads move the surfaces apart at the points of the contact line [m], shape (m,)."""
        apart = np.zeros_like(model.line.x)
        for name, body in model.bodies.items():
            for load, magnitude in self.on(name).items():
                apart = apart + magnitude * body.loads[load].opening
        if self.gap_pressure is not None:
            apart = apart + model.compliance @ (model.line.area_weight * self.gap_pressure)
        return apart

    def touch(self, model: ContactModel) -> float:
        """Approach at which the mean planes touch under these loads, zero without any [m]."""
        apart, axial = model.line.initial_gap, model.line.normal[1]
        return float(np.min((apart + self.opening(model)) / axial) - np.min(apart / axial))

    def lift(self, model: ContactModel) -> float:
        """Axial force that the loads exert on the closure [N], positive where they lift it."""
        lift = self.lifting
        lift += sum(size * model.closure.loads[name].axial_force for name, size in self.closure.items())
        if self.gap_pressure is not None:
            lift += float(model.line.normal[1] @ (model.line.area_weight * self.gap_pressure))
        return lift

    def displacement(
        self, body: CondensedBody, model: ContactModel, point_forces: FloatArray | None = None
    ) -> FloatArray:
        """Displacement of a body of the model under these loads [m], shape (dofs,).

        Parameters
        ----------
        point_forces : ndarray, shape (m,), optional
            Normal forces of a solid contact at the points of the contact line, which act as well [N].
        """
        moved = sum(
            (size * body.loads[name].response for name, size in self.on(body.held.name).items()),
            np.zeros(body.held.size),
        )
        pressed = [] if point_forces is None else [point_forces]
        if self.gap_pressure is not None:
            pressed.append(model.line.area_weight * self.gap_pressure)
        return moved + body.displacement(np.sum(pressed, axis=0)) if pressed else moved

    def free_strain(self, body: CondensedBody) -> FloatArray | float:
        """Strain of a body under these loads that takes no stress: a number, or one for each node."""
        return sum(
            (size * body.loads[name].free_strain for name, size in self.on(body.held.name).items()), 0.0
        )

    def face_temperature(
        self, body: CondensedBody, pressure: FloatArray, model: ContactModel
    ) -> float | None:
        """Temperature of a body's face where it carries a pressure (m,), in the mean over it [K]; None if not given."""
        known = self.temperature.get(body.held.name)
        if known is None or np.ndim(known) == 0:
            return None if known is None else float(known)
        weight = model.line.area_weight * pressure
        return float(weight @ (body.held.trace @ np.asarray(known)[body.held.contact_nodes]) / weight.sum())


NO_LOADS = BodyLoads()
