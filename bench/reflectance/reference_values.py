#!/usr/bin/env python3
"""Prints the values of rho_dh that bench_reflectance measures errors against and that are not printed elsewhere.

Textbook formulas on a composite Gauss-Legendre rule in (theta_r, phi_r), panels halved until two of them agree: slow, but
it shares nothing with the library. Good to some 1e-13. Python's own mathematics is enough.
"""
from math import cos, exp, fsum, pi, radians, sin, sqrt


def gauss_legendre(n):
    """Nodes and weights over [0, 1]."""
    rule = []
    for k in range(n):
        x = cos(pi * (k + 0.75) / (n + 0.5))
        for _ in range(50):
            p, q = 1.0, 0.0
            for j in range(n):
                p, q = ((2 * j + 1) * x * p - j * q) / (j + 1), p
            slope = n * (x * p - q) / (x * x - 1)
            x -= p / slope
        rule.append(((1 + x) / 2, 1 / ((1 - x * x) * slope * slope)))
    return rule


RULE = gauss_legendre(20)


def panels(cuts):
    return [(a + (b - a) * x, (b - a) * w) for a, b in zip(cuts, cuts[1:]) for x, w in RULE]


def rho_dh(f, theta_i, theta_width, phi_width):
    """2 x integral over phi in [0, pi] of f cos sin; panels no wider than the two widths [rad]."""

    def once(refine):
        def uniform(end, width):
            n = max(2, int(refine * end / width) + 1)
            return [end * k / n for k in range(n + 1)]

        phis = panels(uniform(pi, phi_width))
        thetas = panels(uniform(pi / 2, theta_width))
        return 2 * fsum(w * v * f(theta_i, t, p) * cos(t) * sin(t) for t, w in thetas for p, v in phis)

    coarse, fine = once(1), once(1.5)
    return fine, abs(fine - coarse) / fine


def cos_phase(ti, tr, dphi):
    return cos(ti) * cos(tr) + sin(ti) * sin(tr) * cos(dphi)


def hapke_hg(ti, tr, dphi, w=0.9, g=-0.3):
    h = lambda m: (1 + 2 * m) / (1 + 2 * sqrt(1 - w) * m)
    p = (1 - g * g) / (1 + g * g + 2 * g * cos_phase(ti, tr, dphi)) ** 1.5
    return w / (4 * pi * (cos(ti) + cos(tr))) * (p + h(cos(ti)) * h(cos(tr)) - 1)


def glint(ti, tr, dphi, s2, n=1.34):
    c = cos_phase(ti, tr, dphi)
    cos2_beta = (cos(ti) + cos(tr)) ** 2 / (2 + 2 * c)
    m = sqrt((1 + c) / 2)
    t = sqrt(1 - (1 - m * m) / n**2)
    r = (((m - n * t) / (m + n * t)) ** 2 + ((n * m - t) / (n * m + t)) ** 2) / 2
    return r * exp(-(1 / cos2_beta - 1) / s2) / (pi * s2) / (4 * cos(ti) * cos(tr) * cos2_beta**2)


def show(name, f, thetas, theta_width, phi_width):
    for theta in thetas:
        value, change = rho_dh(f, radians(theta), theta_width, phi_width)
        print(f"{name:28s} {theta:4d}  {value:.15g}   (change {change:.1e})", flush=True)


show("glint .0542 (known)", lambda *a: glint(*a, s2=0.0542), (30, 60), 0.15, 0.3)
show("hapke_hg .9 -.3", hapke_hg, (0, 30, 60, 85), 0.1, 0.8)
show("glint .001", lambda *a: glint(*a, s2=0.001), (0, 30, 60, 75), 0.04, 0.08)
