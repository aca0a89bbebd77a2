"""The publications behind the numbers of a result: only those whose formulas it used."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from fem_seal.analysis.results import SealSolution
from fem_seal.output.tables import standards_used


@dataclass(frozen=True)
class Source:
    """A publication and what was taken from it.

    Parameters
    ----------
    name : str
        Short name, as used in texts.
    reference : str
        Where to find it.
    used_for : str
        What it was used for, in words.
    equations : tuple of str
        The equations, as one line of text each.
    """

    name: str
    reference: str
    used_for: str
    equations: tuple[str, ...] = ()


def sources(result: SealSolution) -> list[Source]:
    """Publications whose formulas a result used, in the order of the calculation.

    Parameters
    ----------
    result : SealSolution
    """
    return list(_sources(result))


def _sources(result: SealSolution) -> Iterator[Source]:
    case, surface = result.case, result.surface
    flow = any(load.leak is not None for load in result.loads)
    yield Source(
        "Fischer et al. 2020",
        "F. J. Fischer, K. Schmitz, A. Tiwari, B. N. J. Persson, Fluid leakage in metallic seals, Tribol. Lett. 68, "
        "125 (2020)",
        "load on the contact line, closed pressure profiles" + (", leak rate" if flow else ""),
        (
            "eq. 1: f_N = F_N / (2π r₀ cos θ), r₀ = R sin θ, F_N = π r₀² p_fluid + axial force",
            *(("eq. 8: p = p_c exp(−u/u₀)",) if case.interface.law == "exponential" else ()),
            *(("eq. 13 to 15: Δp = Q ∫ dx / (2π r(x) σ_eff(p(x)))",) if flow else ()),
        ),
    )
    yield Source(
        "Johnson 1985",
        "K. L. Johnson, Contact Mechanics, Cambridge University Press (1985), chapter 4",
        "Hertzian line contact, for comparison",
        ("p = p₀ (1 − x²/a²)^½, p₀ = (E* f_N / (π R))^½, 1/E* = (1 − ν₁²)/E₁ + (1 − ν₂²)/E₂",),
    )
    if result.unloaded is not None:
        yield Source(
            "Simo & Taylor 1985",
            "J. C. Simo, R. L. Taylor, Consistent tangent operators for rate-independent elastoplasticity, Comput. "
            "Methods Appl. Mech. Eng. 48, 101 (1985); docs/theory_elastoplastic.md",
            "bodies that yield: von Mises, isotropic hardening, radial return",
            ("q = √(3/2 s:s) ≤ σ_y(p), dε_p = dp · 3 s / (2 q)",),
        )
    if case.load.closing == "penetration":
        yield Source(
            "coupled fluid pressure",
            "docs/theory_penetration.md; D. G. Anderson, J. ACM 12, 547 (1965)",
            "contact, flow and fluid pressure between the surfaces, solved together",
            ("F_N = S − ∫ p_fluid n_z dA over the closure, p_f falling along the flow resistance",),
        )
    if surface is None:
        return
    if case.roughness is not None and case.roughness.is_measured:
        yield Source(
            "Jacobs et al. 2017",
            "T. D. B. Jacobs, T. Junge, L. Pastewka, Quantitative characterization of surface topography using "
            "spectral analysis, Surf. Topogr.: Metrol. Prop. 5, 013001 (2017); P. Whittle, J. Royal Stat. Soc. B 15, "
            "125 (1953)",
            "power spectrum of the measured scans",
            ("C_1D(q) = 2 ∫_q^∞ C(k) k dk / √(k² − q²), ⟨h²⟩ = ∫ C_1D dq = 2π ∫ q C dq",),
        )
    yield Source(
        "Persson 2001",
        "B. N. J. Persson, Theory of rubber friction and contact mechanics, J. Chem. Phys. 115, 3840 (2001)",
        "area of real contact at each magnification" + (", elastic and yielded" if surface.hardness else ""),
        ("A/A₀ = erf(p / (2 √G)), G = (π/4) E*² ∫ q³ C(q) dq",)
        + (("∂P/∂G = ∂²P/∂σ², absorbing at σ = 0 and at the hardness",) if surface.hardness else ()),
    )
    yield Source(
        "Yang & Persson 2008",
        "C. Yang, B. N. J. Persson, Contact mechanics: contact area and interfacial separation from small contact to "
        "full contact, J. Phys.: Condens. Matter 20, 215214 (2008); B. N. J. Persson, Phys. Rev. Lett. 99, 125502 "
        "(2007)",
        "mean separation of rough surfaces under pressure, p(u)",
        ("ū = √π ∫ dq q² C w ∫ dp′/p′ [γ + 3(1−γ) erf²(w p′/E*)] exp(−(w p′/E*)²), γ = 0.45",),
    )
    if surface.hardness is not None:
        yield Source(
            "Persson 2016",
            "B. N. J. Persson, Leakage of metallic seals: role of plastic deformations, Tribol. Lett. 63, 42 (2016); "
            "Fischer et al. 2020, eq. 16",
            "spectrum of the plastically smoothed surface",
            ("C_pl = [1 − (A_pl/A_pl⁰)⁶] C, A_pl⁰/A₀ = p/σ_P",),
        )
    if not flow:
        return
    yield Source(
        "Lorenz & Persson 2010",
        "B. Lorenz, B. N. J. Persson, Leak rate of seals: effective-medium theory and comparison with experiment, "
        "Eur. Phys. J. E 31, 159 (2010); A. Almqvist et al., J. Mech. Phys. Solids 59, 2355 (2011)",
        "distribution of the separations, critical junction",
        ("Q = u_c³ Δp / (12 η) for a square, u_c the separation where the open area begins to percolate",),
    )
    if case.fluid is not None and case.fluid.gas is not None:
        yield Source(
            "Fukui & Kaneko 1990",
            "S. Fukui, R. Kaneko, A database for interpolation of Poiseuille flow rates for high Knudsen number "
            "lubrication problems, J. Tribol. 112, 78 (1990)",
            "flow of the gas through a gap, with slip and free molecules",
            (
                "dm/dt per width = −(u²/v₀) Q_P(D) dp/dx, D = p u/(η v₀), v₀ = (2 R T/M)^½, Q_P → D/6 for large D",
            ),
        )
    if case.fluid is not None and case.fluid.library_entry is not None:
        yield Source(case.fluid.name, case.fluid.library_entry.source, "properties of the fluid")
    for standard in standards_used(result):
        yield Source(
            standard.name, f"{standard.revision}; {standard.source}", f"leakage class of {standard.name}"
        )
    if case.leak.conductivity == "bruggeman":
        yield Source(
            "Dapp et al. 2012",
            "W. B. Dapp, A. Lücke, B. N. J. Persson, M. H. Müser, Self-affine elastic contacts: percolation and "
            "leakage, Phys. Rev. Lett. 108, 244301 (2012)",
            "effective medium of all channels, with the percolation threshold built in",
            ("∫ dσ P(σ) (σ − σ_eff) / (σ + (n−1) σ_eff) = 0, σ(u) = u³/(12 η), n = 1/(1 − threshold)",),
        )
    if surface.peklenik != 1.0:
        yield Source(
            "Persson 2020",
            "B. N. J. Persson, Interfacial fluid flow for systems with anisotropic roughness, Eur. Phys. J. E 43, 25 "
            "(2020); A. Wang, M. H. Müser, Percolation and Reynolds flow in elastic contacts of isotropic and "
            "anisotropic, randomly rough surfaces, Tribol. Lett. 69, 1 (2021)",
            "effective medium of a stretched roughness; its percolation threshold other than 0.5 is a heuristic",
            (
                "∫ dσ P(σ) (σ − s_x) / (s_x + n_x (σ − s_x)) = 0, n_x = 1/(1 + k γ_T √(s_y/s_x)), "
                "k = threshold/(1 − threshold), and the same for y with 1/γ_T",
            ),
        )
    if case.leak.fluid_in_gap == "local" and case.fluid is not None:
        yield Source(
            "local closure",
            "Fischer et al. 2020, eq. 13, with the contact pressure p − p_f; heuristic, docs/theory_fluid_in_gap.md",
            "fluid pressure in the gap that carries part of the load",
            ("dp_f/dx = Q / (2π r σ_eff(p − p_f)), from p_f = 0 to the lift-off point, where p_f = p = Δp",),
        )
    if result.uncertainty is not None:
        yield Source(
            "Owen 1997",
            "A. B. Owen, Monte Carlo variance of scrambled net quadrature, SIAM J. Numer. Anal. 34, 1884 (1997); "
            "B. Sudret, Reliab. Eng. Syst. Saf. 93, 964 (2008)",
            "interval of the leak rate from scrambled Sobol samples, shares of variance",
        )
