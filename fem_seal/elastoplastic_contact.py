"""Contact of bodies that yield: settings, bodies and solution."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from fem_seal.condensation import ContactModel
from fem_seal.contact_solution import ContactSolution
from fem_seal.elastoplastic_body import BodyState, ElastoplasticBody
from fem_seal.elastoplastic_fields import elastoplastic_field
from fem_seal.held_body import HeldBody
from fem_seal.stress import BodyField, body_fields

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class PlasticSettings:
    """When the Newton iteration of a load step stops, and how small a step may become.

    Parameters
    ----------
    tolerance : float
        Largest nodal force out of balance over the largest that the elements put on a node.
    max_iterations : int
        A step that needs more is halved.
    steps : int
        Load steps from zero to a load; between two loads in proportion to the larger one.
    smallest_step : float
        Smallest load step, as a share of the larger load, before the path is given up.
    """

    tolerance: float = 1e-9
    max_iterations: int = 20
    steps: int = 16
    smallest_step: float = 1e-4


@dataclass(frozen=True)
class YieldingBody:
    """A body of the seal that yields: where it is touched and held, and its solid."""

    held: HeldBody

    @cached_property
    def solid(self) -> ElastoplasticBody:
        """The elastoplastic solid."""
        return ElastoplasticBody(self.held.basis, self.held.material, self.held.free)


def yielding_bodies(model: ContactModel) -> dict[str, YieldingBody]:
    """Those bodies of a seal whose materials have a hardening curve, by name; empty if the seal is elastic.

    Parameters
    ----------
    model : ContactModel
    """
    return {
        body.held.name: YieldingBody(body.held)
        for body in (model.closure, model.seat)
        if body.material.hardening is not None
    }


@dataclass(frozen=True, kw_only=True)
class ElastoplasticContact(ContactSolution):
    """State of the contact line and of the yielding bodies under one axial force of a path.

    Parameters
    ----------
    bodies : mapping
        The bodies that yield, by name.
    states : mapping
        Their states, by name.
    equilibrium_residuals : tuple of float
        Largest nodal force out of balance over the largest that the elements put on a node, one per Newton iteration
        of the last load step.
    load_steps : int
        Steps since the load before.
    """

    bodies: Mapping[str, YieldingBody] = field(repr=False)
    states: Mapping[str, BodyState] = field(repr=False)
    equilibrium_residuals: tuple[float, ...] = field(repr=False)
    load_steps: int = 1

    @cached_property
    def fields(self) -> dict[str, BodyField]:
        """Displacement and stress of "closure" and "seat"; of bodies that yield with their plastic strain."""
        return body_fields(self) | {
            name: elastoplastic_field(body.held, body.solid, self.states[name], self.profile)
            for name, body in self.bodies.items()
        }
