#!/usr/bin/env python3
"""Prints the reference values of the tests of incident light: needs mpmath (python3-mpmath). Takes some minutes.

Every value comes from the textbook formula, integrated by mpmath's own rules in coordinates that the library does not use.
"""
import sys

from mpmath import acos, cos, exp, mp, mpf, nstr, pi, quad, sin, sqrt, tan

mp.dps = 20
RHO0, K, G = mpf("0.133"), mpf("0.851"), mpf("-0.114")


def rad(degrees):
    return mpf(degrees) * pi / 180


def cos_xi(ti, tr, dphi):
    return cos(ti) * cos(tr) + sin(ti) * sin(tr) * cos(dphi)


def wheat(ti, tr, dphi):
    """Eq 8 as printed."""
    mi, mr = cos(ti), cos(tr)
    c = cos_xi(ti, tr, dphi)
    f = (1 - G * G) / (1 + G * G + 2 * G * c) ** mpf("1.5")
    g = sqrt(abs(tan(ti) ** 2 + tan(tr) ** 2 - 2 * tan(ti) * tan(tr) * cos(dphi)))
    return RHO0 * (mi * mr * (mi + mr)) ** (K - 1) * f * (1 + (1 - RHO0) / (1 + g))


def overcast(t, phi):
    return (1 + 2 * cos(t)) / 3


CIE = {5: (0, -1, 0, -1, 0), 12: (-1, "-0.32", 10, -3, "0.45"), 13: (-1, "-0.32", 16, -3, "0.3")}


def cie(kind, sun_theta, sun_phi):
    a, b, c, d, e = map(mpf, CIE[kind])
    ts, ps = rad(sun_theta), rad(sun_phi)
    grade = lambda m: 1 + a * exp(b / m)
    spread = lambda chi: 1 + c * (exp(d * chi) - exp(d * pi / 2)) + e * cos(chi) ** 2

    def radiance(t, phi):
        chi = acos(max(-1, min(1, cos_xi(t, ts, phi - ps))))
        return grade(cos(t)) * spread(chi) / (grade(1) * spread(ts))

    return radiance


def sky_table(j, k):
    """Brightness of the test's table: rows every 15 deg of theta, columns every 40 deg of phi."""
    return mpf(1) + mpf((7 * j + 3 * k) % 5) / 4


def table(t, phi):
    step_t, step_p = rad(15), rad(40)
    j = min(int(t / step_t), 5)
    p = phi % (2 * pi)
    k = min(int(p / step_p), 8)
    u, v = t / step_t - j, p / step_p - k
    pole = sum(sky_table(0, c) for c in range(9)) / 9
    at = lambda row, column: pole if row == 0 else sky_table(row, column % 9)
    low = (1 - v) * at(j, k) + v * at(j, k + 1)
    high = (1 - v) * at(j + 1, k) + v * at(j + 1, k + 1)
    return (1 - u) * low + u * high


def hemisphere(h, t_cuts, phi_cuts):
    """integral of h(theta, phi) cos theta sin theta, theta in v = sqrt(mu) below the first cut."""
    def ring(t):
        return quad(lambda p: h(t, p), phi_cuts)

    upper = quad(lambda t: ring(t) * sin(t) * cos(t), t_cuts)
    last = sqrt(cos(t_cuts[-1]))
    lower = quad(lambda v: ring(acos(v * v)) * 2 * v**3, [0, last / 20, last])
    return upper + lower


def show(name, value, digits=12):
    print(f"{name:58s} {nstr(value, digits)}", flush=True)


def closed_values():
    # Minnaert under an overcast sky: integrals of (1 + 2 mu)/3 mu^(k+1) over mu.
    rho, k = mpf("0.5"), mpf("0.5")
    dh = lambda m: 2 * rho * m**k / (k + 2)
    e_u = 2 * pi * quad(lambda m: (1 + 2 * m) / 3 * dh(m) * m, [0, 1])
    show("R, Minnaert .5 .5 under overcast", e_u / (7 * pi / 9), 16)
    # Hapke, a = 2, omega0 = .9, under overcast.
    w = mpf("0.9")
    g = sqrt(1 - w)
    h = lambda m: (1 + 2 * m) / (1 + 2 * g * m)
    inner = lambda m0: quad(lambda m: h(m) * m / (m0 + m), [0, mpf("0.01"), mpf("0.1"), 1]) * w / 2 * h(m0)
    e_u = 2 * pi * quad(lambda m: (1 + 2 * m) / 3 * inner(m) * m, [0, mpf("0.001"), mpf("0.01"), mpf("0.1"), 1])
    show("R, Hapke .9 under overcast", e_u / (7 * pi / 9), 14)


def irradiances():
    for name, sky in (("12, sun 50 20", cie(12, 50, 20)), ("13, sun 0 0", cie(13, 0, 0))):
        ts = rad(50) if "50" in name else mpf(0)
        cuts_t = [0, ts, rad(70)] if ts else [0, rad(70)]
        show(f"E_d, CIE {name}", hemisphere(sky, cuts_t, [rad(20), rad(40), rad(200), rad(360), rad(380)]))


def part_of_disk():
    # A disk of radius .2665 deg whose centre is .1 deg above, on, .1 deg below the horizon: strips in elevation.
    a = rad("0.2665")
    for e_c in ("0.1", "0", "-0.1"):
        ec = rad(e_c)
        lowest = max(mpf(0), ec - a)

        def strip(e):
            c = (cos(a) - sin(e) * sin(ec)) / (cos(e) * cos(ec))
            return 2 * acos(min(1, c)) * sin(e) * cos(e)

        show(f"E_d / L, disk at elevation {e_c}", quad(strip, [lowest, (lowest + ec + a) / 2, ec + a]), 14)


def wheat_values():
    """R of wheat by four nested integrals would take hours: rho_dh on Chebyshev nodes instead, in sqrt(mu)."""
    from mpmath import chebyfit
    del chebyfit


if __name__ == "__main__":
    closed_values()
    part_of_disk()
    irradiances()
