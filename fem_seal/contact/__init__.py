"""Two bodies on one contact line: everything between their finite elements and a pressure profile.

Lengths in m, forces in N, pressures in Pa; `condense` makes the model of two bodies, `solve` presses them together.

Examples
--------
>>> import meshes
>>> from fem_seal import contact, material
>>> ball = meshes.Ball(0.02)
>>> cone = meshes.ConicalSeat.around(0.785, ball)
>>> mesh = meshes.build(ball, cone, meshes.Sizing(2e-5, 1e-4, (-1e-3, 1e-3), 0.2, 0.3, 4e-3))
>>> model = contact.condense(mesh, {"closure": material("steel"), "seat": material("steel")})
>>> pressed = contact.solve(model, contact.HardContact(), contact_force=1257.0)
>>> print(f"{pressed.profile.peak_pressure / 1e6:.0f} MPa")
195 MPa
"""

from lazy_loader import attach_stub

# a name is loaded with its first use, so that a program loads only what it calls
__getattr__, __dir__, __all__ = attach_stub(__name__, __file__)
