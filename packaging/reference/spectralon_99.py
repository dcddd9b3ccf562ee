#!/usr/bin/env python3
"""Writes SPECTRALON-99-LITERATURE.toml: what the literature says of sintered PTFE of 99 %, with the uncertainty of that.

The shape is a body that scatters many times, and two lobes that scatter once:
  F(i, r) = a P(xi) / (mu_i + mu_r) + b / (1 + tan(xi / 2) / h)      P: Henyey-Greenstein, g, at the scattering angle
  E(i)    = (1/pi) integral F mu_r dOmega_r,   E_mean = 2 integral E mu dmu
  pi f    = F + rho_b (1 - E(i)) (1 - E(r)) / (1 - E_mean)
It is reciprocal, and its rho_dh(i) = E(i) + rho_b (1 - E(i)) is at most 1 for rho_b <= 1: both by construction (the coupling
of Shirley et al. 1997, Kelemen and Szirmay-Kalos 2001). a, b, g, h are chosen so that 0/45, 0/0, 60/60 and 70/70 forward come
near published figures; rho_b so that 8/h is the certificate's. No table of anybody is copied.
"""
import math

A, G, B, H = 0.28, 0.50, 0.06, 0.15
WAVELENGTHS = (350.0, 1500.0, 2500.0)
THETAS = (0, 10, 20, 30, 40, 45, 50, 55, 60, 65, 70, 75)  # beyond it nothing is published that we would sign
PHIS = tuple(range(0, 181, 15))
# Sphere values of several laboratories and the maker; the uncertainty (k = 2) is that of a piece of unknown history.
CERTIFICATE = ((350, 0.9878, 0.030), (450, 0.9890, 0.020), (550, 0.9898, 0.015), (650, 0.9896, 0.015), (1000, 0.9900, 0.015),
               (1500, 0.9874, 0.020), (2000, 0.9692, 0.040), (2500, 0.9316, 0.060))


def gauss(n, low, high):
    """Nodes and weights of Gauss-Legendre by Newton's iteration."""
    nodes = []
    for k in range(n):
        x = math.cos(math.pi * (k + 0.75) / (n + 0.5))
        for _ in range(100):
            p0, p1 = 1.0, x
            for j in range(2, n + 1):
                p0, p1 = p1, ((2 * j - 1) * x * p1 - (j - 1) * p0) / j
            slope = n * (x * p1 - p0) / (x * x - 1)
            step = p1 / slope
            x -= step
            if abs(step) < 1e-15:
                break
        half = 0.5 * (high - low)
        nodes.append((0.5 * (low + high) + half * x, half * 2 / ((1 - x * x) * slope * slope)))
    return nodes


def lobes(ti, tr, phi):
    mu_i, mu_r = math.cos(ti), math.cos(tr)
    cos_xi = max(-1.0, min(1.0, mu_i * mu_r + math.sin(ti) * math.sin(tr) * math.cos(phi)))
    forward = (1 - G * G) / (1 + G * G + 2 * G * cos_xi) ** 1.5
    tan_half = math.sqrt((1 - cos_xi) / (1 + cos_xi)) if cos_xi > -1 else 1e9
    return A * forward / (mu_i + mu_r) + B / (1 + tan_half / H)


DOWN = gauss(48, 0.0, 0.5 * math.pi)
AROUND = gauss(48, 0.0, math.pi)


def share_of_lobes(ti):
    total = 0.0
    for tr, w in DOWN:
        ring = sum(v * lobes(ti, tr, phi) for phi, v in AROUND)
        total += 2 * w * ring * math.cos(tr) * math.sin(tr)
    return total / math.pi


def reflectance_at(nm):
    for (a, rho_a, _), (b, rho_b, _) in zip(CERTIFICATE, CERTIFICATE[1:]):
        if a <= nm <= b:
            return rho_a + (nm - a) / (b - a) * (rho_b - rho_a)
    raise ValueError(nm)


def main():
    mean = sum(2 * w * share_of_lobes(t) * math.cos(t) * math.sin(t) for t, w in gauss(32, 0.0, 0.5 * math.pi))
    at = {t: share_of_lobes(math.radians(t)) for t in THETAS + (8,)}

    def shape(rho, i, r, phi):
        body = (rho - at[8]) / (1 - at[8])
        pi_f = lobes(math.radians(i), math.radians(r), math.radians(phi)) + body * (1 - at[i]) * (1 - at[r]) / (1 - mean)
        return pi_f / rho

    lines = ["# 99 % Spectralon (sintered PTFE) as the literature has it: for a standard that nobody has calibrated, and to begin with.",
             "# Reflectance 8/h from published sphere measurements, U (k = 2) for a piece of unknown batch and history; a used or dirty one",
             "# may lie outside. The shape: written by spectralon_99.py, reciprocal and energy conserving by construction; what is published",
             "# of the shape differs by 2 to 5 % above 60 deg, and so do its modes. Your own certificate: gonioctl reference import.",
             "[standard]", 'serial = "SPECTRALON-99-LITERATURE"', 'material = "Spectralon 99 %, literature values"', "",
             "[certificate]", "date = 2026-01-01", "expires = 2099-12-31             # literature does not age; your piece does",
             'geometry = "8/h"', 'specular = "included"', "coverage_factor = 2.0", 'uncertainty_kind = "absolute"',
             "longest_gap_nm = 500.0", "correlation = 0.8                # a batch, or dirt, lifts neighbouring wavelengths together"]
    for nm, rho, u in CERTIFICATE:
        lines += ["[[certificate.entries]]", f"wavelength_nm = {nm:.1f}", f"reflectance = {rho}", f"uncertainty = {u}"]
    lines += ["", "[shape]", f"wavelengths_nm = [{', '.join(f'{nm:.1f}' for nm in WAVELENGTHS)}]",
              f"theta_i_deg = {list(THETAS)}", f"theta_r_deg = {list(THETAS)}", f"phi_deg = {list(PHIS)}",
              "u_integral = 0.01                # the cap beyond 75 deg, the hot spot narrower than the table's steps", "values = ["]
    for nm in WAVELENGTHS:
        rho = reflectance_at(nm)
        lines.append(f"  # {nm:.0f} nm")
        for i in THETAS:
            for r in THETAS:
                lines.append("  " + " ".join(f"{shape(rho, i, r, phi):.4f}," for phi in PHIS))
    lines.append("]")
    for name, kind, u, width in (("limb", "limb", 0.06, None), ("forward", "forward", 0.03, None),
                                 ("sideways", "sideways", 0.02, None), ("hot-spot", "opposition", 0.05, 6.0)):
        lines += ["[[shape.modes]]", f'name = "{name}"', f'kind = "{kind}"', f"u = {u}"]
        if width:
            lines.append(f"width_deg = {width}")
    with open("SPECTRALON-99-LITERATURE.toml", "w", encoding="ascii") as out:
        out.write("\n".join(lines) + "\n")
    rho = reflectance_at(550)
    for g in ((0, 0, 0), (0, 45, 0), (0, 70, 0), (60, 60, 180), (70, 70, 180), (75, 75, 180), (60, 0, 0), (0, 75, 0), (75, 75, 0), (45, 45, 180)):
        print(g, round(shape(rho, *g), 4))
    print("lobes", {t: round(e, 4) for t, e in sorted(at.items())})


if __name__ == "__main__":
    main()
