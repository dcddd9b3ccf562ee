#!/usr/bin/env python3
"""Prints the reference values of the batch tests: textbook formulas with 60 digits. Needs mpmath (python3-mpmath)."""
from mpmath import cos, erfc, exp, mp, mpf, nstr, pi, sin, sqrt, tan

mp.dps = 60


def rpv(ti, tr, dphi, rho0="0.133", k="0.851", g="-0.114"):
    rho0, k, g = mpf(float(rho0)), mpf(float(k)), mpf(float(g))
    mi, mr = cos(ti), cos(tr)
    c = mi * mr + sin(ti) * sin(tr) * cos(dphi)
    big_g = sqrt(abs(tan(ti) ** 2 + tan(tr) ** 2 - 2 * tan(ti) * tan(tr) * cos(dphi)))
    f = (1 - g * g) / (1 + g * g + 2 * g * c) ** mpf("1.5")
    return rho0 * (mi * mr * (mi + mr)) ** (k - 1) * f * (1 + (1 - rho0) / (1 + big_g))


def glint(ti, tr, dphi, s2, n, smith):
    s2, n = mpf(float(s2)), mpf(float(n))
    mi, mr = cos(ti), cos(tr)
    c = mi * mr + sin(ti) * sin(tr) * cos(dphi)
    cos2_beta = (mi + mr) ** 2 / (2 + 2 * c)
    ci, t = sqrt((1 + c) / 2), sqrt(1 - (1 - c) / 2 / n**2)
    r = (((ci - n * t) / (ci + n * t)) ** 2 + ((n * ci - t) / (n * ci + t)) ** 2) / 2
    hidden = lambda v: (exp(-v * v) / (v * sqrt(pi)) - erfc(v)) / 2
    shadow = 1 + hidden(1 / tan(ti) / sqrt(s2)) + hidden(1 / tan(tr) / sqrt(s2)) if smith else 1
    return r * exp(-(1 / cos2_beta - 1) / s2) / (pi * s2) / (4 * mi * mr * cos2_beta**2) / shadow


d = lambda x: mpf(float(x))  # the double that the test has
for name, ti, tr, dphi in (
    ("retro, 1e-12 rad off", d("0.5"), d("0.5") + mpf(2) ** -40, mpf(0)),
    ("retro in azimuth, 2^-40 rad off", d("0.5"), d("0.5"), mpf(2) ** -40),
    ("grazing, elevations 2^-33 and 2^-34", pi / 2 - mpf(2) ** -33, pi / 2 - mpf(2) ** -34, d("0.25")),
    ("anywhere", d("0.75"), d("1.25"), d("2.5")),
):
    print(f"rpv {name}: {nstr(rpv(ti, tr, dphi), 18)}")
for smith in (False, True):
    print(f"glint .0542 {smith}: {nstr(glint(d('0.75'), d('1.25'), d('2.5'), '0.0542', '1.34', smith), 18)}")
    low = glint(pi / 2 - mpf(2) ** -10, pi / 2 - mpf(2) ** -11, pi, "0.0542", "1.34", smith)
    print(f"glint .0542 {smith}, mirrored, elevations 2^-10, 2^-11: {nstr(low, 18)}")
