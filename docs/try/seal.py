"""Leak rate of a ball on a conical seat by `leak` alone: what the page calculates, in the browser as anywhere.

The bodies are elastic half-spaces: the contact pressure is the closed form of `leak.crossover_line`, its decay length
the one that the rough surface has at the peak. `fem-seal run` solves the real bodies instead.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

import leak
from leak.flow.turned_contact import calculated_table

# Steel on steel. The profile reaches so many standard deviations to both sides.
E_STAR, REACH, POINTS = 210e9 / 1.82, 6.0, 241
# Surfaces that the finish may be, and the quantiles that nine of ten seals lie between.
SURFACES, NINE_OF_TEN = 16, (0.05, 0.95)
ATMOSPHERE = 101325.0


@dataclass(frozen=True)
class Seal:
    """A smooth ball on a rough conical seat; the fluid outside presses it on, and so may a spring.

    Parameters
    ----------
    parameter, value, process : str, float, str
        Finish on the drawing of the seat; Rq is the rms height [m].
    hardness : float
        Of the softer body [Pa].
    fluid, fluid_pressure, force : str, float, float
        A name of the library, its pressure above the atmosphere, and the force of the spring [Pa], [N].
    radius, angle : float
        Of the ball, and between axis and contact normal [m], [rad].
    """

    parameter: str
    value: float
    process: str
    hardness: float
    fluid: str
    fluid_pressure: float
    force: float = 0.0
    radius: float = 0.02
    angle: float = math.pi / 4.0

    @property
    def finish(self) -> leak.Finish:
        """The drawing's words."""
        return leak.Finish(self.parameter, self.value, leak.process_named(self.process))

    @property
    def contact_radius(self) -> float:
        """r0 = R sin(theta) [m]."""
        return self.radius * math.sin(self.angle)

    @property
    def line_load(self) -> float:
        """f_N = F_N/(2 pi r0 cos(theta)), F_N = pi r0^2 p_fluid + S [N/m]."""
        r0 = self.contact_radius
        return (math.pi * r0**2 * self.fluid_pressure + self.force) / (
            2.0 * math.pi * r0 * math.cos(self.angle)
        )

    def surface(self, finished: leak.FinishedSurface) -> leak.RoughContact | leak.TurnedContact:
        """The seat on a smooth ball: crests of a turned one, a rough surface of the others."""
        metal = {"effective_modulus": E_STAR, "hardness": self.hardness}
        if texture := finished.texture:
            crests = {"feed": texture.feed, "nose_radius": texture.nose_radius, "fine": texture.fine}
            return leak.TurnedContact(**crests, thread_radius=self.contact_radius, **metal)
        return leak.RoughContact(finished.spectrum, theory="corrected", peklenik=finished.peklenik, **metal)

    def line(self, surface: leak.RoughContact | leak.TurnedContact) -> leak.CrossoverLine:
        """Contact pressure across the contact."""
        # crests yield before a contact begins to count
        law = surface.interface_law(plastic=isinstance(surface, leak.TurnedContact))
        u0 = surface.spectrum.rms_height
        for _ in range(12):
            peak = leak.crossover_line(self.line_load, self.radius, E_STAR, u0).peak_pressure
            u0 = float(law.decay_length(np.array([math.log(peak)]))[0])
        return leak.crossover_line(self.line_load, self.radius, E_STAR, u0)

    def leak_of(
        self, finished: leak.FinishedSurface
    ) -> tuple[leak.LeakResult, leak.CrossoverLine, leak.FlowError]:
        """Flow through one surface, its contact, and what direct simulation may find over that flow."""
        surface = self.surface(finished)
        line = self.line(surface)
        x = np.linspace(-REACH, REACH, POINTS) * line.std
        p, r = line.pressure(x), self.contact_radius + x * math.cos(self.angle)
        # nine decades below the peak nothing of the resistance is left
        ends = 1e-9 * p.max(), 1.01 * p.max()
        table = calculated_table(surface, *ends, of_gas=leak.is_gas(self.fluid))
        if isinstance(surface, leak.RoughContact):
            table = leak.in_contact(surface, table, x, p)
        if isinstance(table, leak.GasConductivityTable):
            inlet, gas = self.fluid_pressure + ATMOSPHERE, leak.gas(self.fluid)
            flow: leak.LeakResult = leak.gas_leak_flow(x, p, table, gas, inlet, ATMOSPHERE, r)
        else:
            liquid = leak.liquid(self.fluid)
            sigma = table.at(liquid.viscosity)
            flow = leak.leak_flow(x, p, sigma, self.fluid_pressure, r, pressure_law=liquid.pressure_law)
        wavelength = 2.0 * math.pi / surface.spectrum.median_wavenumber
        waves = line.fwhm * 2.0 * math.pi * self.contact_radius / wavelength**2
        return flow, line, surface.flow_error(line.peak_pressure, waves=waves)


def answers(seal: Seal) -> Iterator[dict[str, float]]:
    """Leak rate of the usual surface of the finish, and an interval that knows one more surface in every answer."""
    finish, found = seal.finish, list[float]()
    first: dict[str, float] = {}
    names = list(finish.spreads)
    for number in range(SURFACES):
        # evenly spread over the ranges of what the drawing leaves open, from their middle: the R-sequence
        golden = _golden(len(names))
        shares = {name: (0.5 + number * golden ** -(n + 1)) % 1.0 for n, name in enumerate(names)}
        flow, line, error = seal.leak_of(finish.surface(shares))
        found += [flow.leak_rate * float(error.factor(share)) for share in (0.05, 0.275, 0.5, 0.725, 0.95)]
        first = first or {
            "leak_rate_m3_per_s": flow.leak_rate,
            "peak_pressure_Pa": line.peak_pressure,
            "width_m": line.fwhm,
            "line_load_N_per_m": seal.line_load,
        }
        low, high = np.quantile(found, NINE_OF_TEN)
        yield first | {"low_m3_per_s": float(low), "high_m3_per_s": float(high), "surfaces": number + 1}


def _golden(dimensions: int) -> float:
    """Root of g^(d+1) = g + 1."""
    root = 1.5
    for _ in range(60):
        root = (1.0 + root) ** (1.0 / (dimensions + 1))
    return root


def choices() -> dict[str, list[str]]:
    """Names that the page offers."""
    from leak.surfaces.finish import PROCESSES

    return {"process": list(PROCESSES), "fluid": [*leak.FLUIDS, *leak.GASES]}


def main(text: str) -> None:
    """Print the answers to the inputs of a JSON text, a line each."""
    for answer in answers(Seal(**json.loads(text))):
        print(json.dumps(answer), flush=True)
