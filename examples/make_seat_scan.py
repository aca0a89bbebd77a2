"""The line scan that measured_seat.toml reads: what the program finds in it, and what was put into it.

Not a measurement: a Gaussian random surface with the self-affine spectrum of ball_cone.toml, seed 2020, and a tilt.
Run as a program, this file makes seat_scan.csv anew.
"""

from pathlib import Path

import leak

TRUE = leak.PowerSpectrum.self_affine(
    rms_height=1.9e-6, hurst=0.6, q_low=1e3, q_rolloff=3.7268e4, q_high=3.14159e6
)
LENGTH, POINTS, SEED, TILT = 4e-3, 4000, 2020, 2e-3
FILE = Path(__file__).with_name("seat_scan.csv")


def scan() -> str:
    x, h = leak.random_line_scan(TRUE, length=LENGTH, points=POINTS, seed=SEED)
    rows = [f"{1e3 * a:.3f},{1e6 * b:.4f}" for a, b in zip(x, h + TILT * x, strict=True)]
    return "\n".join(["# calculated scan, see make_seat_scan.py", "x [mm],height [um]", *rows]) + "\n"


def main() -> float:
    surface = leak.measure(leak.read_topography(FILE))
    # 4 mm hold some twenty waves of the roll-off: the rms height of one such scan scatters by a tenth
    print(f"rms height {surface.rms_height * 1e6:.2f} um, put in {TRUE.rms_height * 1e6:.2f} um")
    print(f"rms slope {surface.measured.rms_slope:.3f}, put in {TRUE.rms_slope:.3f}")
    print(f"Hurst exponent {surface.rolloff.hurst:.2f}, put in 0.60")
    return surface.rolloff.hurst


if __name__ == "__main__":
    import matplotlib.pyplot as plt

    FILE.write_text(scan(), encoding="utf-8")
    main()
    spectrum = leak.measure(leak.read_topography(FILE)).spectrum
    plt.figure(figsize=(6, 3), layout="constrained")
    for name, one in (("found in the scan", spectrum), ("put in", TRUE)):
        plt.loglog(one.wavenumber, one.density, label=name)
    plt.xlabel("wavenumber [1/m]")
    plt.ylabel("power spectrum [m⁴]")
    plt.legend()
    plt.show()
