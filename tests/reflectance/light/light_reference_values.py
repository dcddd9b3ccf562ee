#!/usr/bin/env python3
"""Prints the reference values of the tests of incident light: needs mpmath (python3-mpmath). Takes some minutes.

Every value comes from the textbook formula, integrated by mpmath's own rules in coordinates that the library does not use.
"""
import math

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


# From here on doubles, summed by Gauss's rule on cells that shrink towards each hard point: 10 digits are asked for.
def gauss(n):
    """Nodes and weights over [0, 1]."""
    nodes = []
    for k in range(n):
        x = math.cos(math.pi * (k + 0.75) / (n + 0.5))
        for _ in range(20):
            p, q = 1.0, 0.0
            for j in range(n):
                p, q = ((2 * j + 1) * x * p - j * q) / (j + 1), p
            slope = n * (q - x * p) / (1 - x * x)
            x -= p / slope
        nodes.append(((1 + x) / 2, 1 / ((1 - x * x) * slope * slope)))
    return nodes


G12 = gauss(12)


def f_wheat(ti, tr, dphi):
    mi, mr = math.cos(ti), math.cos(tr)
    s2 = math.sin((ti - tr) / 2) ** 2 + math.sin(ti) * math.sin(tr) * math.sin(dphi / 2) ** 2
    phase = (1 - 0.114**2) / ((1 - 0.114) ** 2 + 4 * 0.114 * s2) ** 1.5
    g = math.sqrt((mi - mr) ** 2 + 4 * mi * mr * s2) / (mi * mr)
    return 0.133 * (mi * mr * (mi + mr)) ** (0.851 - 1) * phase * (1 + (1 - 0.133) / (1 + g))


def f_glint(s2, n):
    def f(ti, tr, dphi):
        mi, mr = math.cos(ti), math.cos(tr)
        c = mi * mr + math.sin(ti) * math.sin(tr) * math.cos(dphi)
        cos2_beta = (mi + mr) ** 2 / (2 + 2 * c)
        ci, t = math.sqrt((1 + c) / 2), math.sqrt(1 - (1 - c) / 2 / n**2)
        share = (((ci - n * t) / (ci + n * t)) ** 2 + ((n * ci - t) / (n * ci + t)) ** 2) / 2
        tan2 = ((math.sin(ti) * math.cos(dphi) + math.sin(tr)) ** 2 + (math.sin(ti) * math.sin(dphi)) ** 2) / (mi + mr) ** 2
        return share * math.exp(-tan2 / s2) / (math.pi * s2) / (4 * mi * mr * cos2_beta**2)

    return f


def cell_sum(h, box, points, depth):
    """h over [e0, e1] x [p0, p1], e = elevation; split towards the points at its corners."""
    e0, e1, p0, p1 = box
    near = [q for q in points if q[0] in (e0, e1) and q[1] in (p0, p1)]
    if near and depth:
        em, pm = (e0 + e1) / 2, (p0 + p1) / 2
        parts = ((e0, em, p0, pm), (e0, em, pm, p1), (em, e1, p0, pm), (em, e1, pm, p1))
        return sum(cell_sum(h, part, near, depth - 1) for part in parts)
    total = 0.0
    for x, wx in G12:
        # The horizon's row in x^4, for the powers of mu there.
        e, de = (e1 * x**4, 4 * e1 * x**3) if e0 == 0 else (e0 + (e1 - e0) * x, e1 - e0)
        ring = sum(w * h(math.pi / 2 - e, p0 + (p1 - p0) * y) for y, w in G12)
        total += wx * de * ring * math.sin(e) * math.cos(e)
    return total * (p1 - p0)


def sky_integral(h, thetas, phis, points=()):
    """The cuts and points in degrees; the points' own are added."""
    ets = sorted({math.pi / 2 - math.radians(t) for t in (*thetas, *(q[0] for q in points))} | {0.0, math.pi / 2})
    ps = sorted({math.radians(p) for p in (*phis, *(q[1] for q in points))})
    ps.append(ps[0] + 2 * math.pi)
    # A point at the first cut is at the last one too.
    own = [(math.pi / 2 - math.radians(t), q) for t, p in points for q in (math.radians(p), math.radians(p) + 2 * math.pi)]
    return sum(
        cell_sum(h, (e0, e1, p0, p1), own, 14) for e0, e1 in zip(ets, ets[1:]) for p0, p1 in zip(ps, ps[1:])
    )


def rho_wheat(ti):
    """Up to 60 deg in the plane z = 1, polar about the retro point, G being the radius there, by the double-exponential
    rules; beyond, where that plane is too far out, by cells that shrink towards the hot spot."""
    if ti <= math.radians(60.001):
        return rho_wheat_in_plane(ti)
    deg, e = math.degrees(ti), math.pi / 2 - ti
    rows = [90 - math.degrees(e * 2.0**k) for k in range(-6, 40) if k != 0 and e * 2.0**k < math.pi / 2]
    return sky_integral(lambda t, p: f_wheat(ti, t, p), [0, *rows], range(0, 360, 45), [(deg, 0)])


def rho_wheat_in_plane(ti):
    def ray(alpha):
        total = 0.0
        for k in range(-64, 65):
            t = k / 16
            g = math.exp(math.pi / 2 * math.sinh(t))
            x, y = math.tan(ti) + g * math.cos(alpha), g * math.sin(alpha)
            d = math.hypot(x, y)
            mu = 1 / math.sqrt(1 + d * d)
            if mu > 1e-14:
                total += f_wheat(ti, math.atan(d), math.atan2(y, x)) * mu**4 * g * g * math.cosh(t)
        return total * math.pi / 32

    total = 0.0
    for k in range(-56, 57):
        u = math.pi * math.sinh(k / 16)
        x = 1 / (1 + math.exp(-u))
        total += math.cosh(k / 16) * x * (1 - x) * ray(math.pi * x)
    return 2 * math.pi**2 * total / 16


def disk_integral(h, theta, phi, radius):
    """h cos(theta) over a disk, in strips of theta; h even about phi."""
    a, tc = math.radians(radius), math.radians(theta)
    nodes = gauss(24)
    total = 0.0
    for x, wx in nodes:
        off = -a * math.cos(math.pi * x)
        t = tc + off
        inside = math.sin((a + off) / 2) * math.sin((a - off) / 2) / (math.sin(t) * math.sin(tc))
        width = 2 * math.asin(math.sqrt(inside))
        strip = 2 * width * sum(w * h(t, math.radians(phi) + width * (2 * y - 1)) for y, w in nodes)
        total += wx * strip * math.sin(t) * math.cos(t) * a * math.pi * math.sin(math.pi * x)
    return total


def radiances():
    r, phi = math.radians(40), math.radians(100)
    wheat_r = lambda t, p: f_wheat(t, r, p - phi)
    sky12 = lambda t, p: float(cie(12, 50, 20)(t, p))
    rows, columns = range(0, 91, 15), range(0, 360, 40)
    patchy = lambda t, p: float(table(t, p))
    show("E_d, patchy", sky_integral(patchy, rows, columns), 11)
    show("L_r, wheat (40, 100), patchy", sky_integral(lambda t, p: wheat_r(t, p) * patchy(t, p), rows, columns, [(40, 100)]), 11)
    narrow = f_glint(0.001, 1.34)
    glossy = lambda t, p: narrow(t, r, p - phi) * patchy(t, p)
    fine = [*rows, *range(20, 60, 2)], [*columns, *range(230, 330, 4)]
    show("L_r, glint .001 (40, 100), patchy", sky_integral(glossy, *fine), 11)
    # exp(-.32/mu) is flat at the horizon and steep above it.
    low = [70, 75, 80, 82, 84, 86, 88, 89]
    show("E_d, CIE 12", sky_integral(sky12, [15, 35, 60, *low], range(20, 380, 45), [(50, 20)]), 11)
    both = lambda t, p: wheat_r(t, p) * sky12(t, p)
    show("L_r, wheat (40, 100), CIE 12", sky_integral(both, [15, 25, 60, *low], range(20, 380, 40), [(50, 20), (40, 100)]), 11)
    level = 1 / (math.pi * math.sin(math.radians(0.2665)) ** 2)
    for s2 in (0.0542, 1e-5):
        glint = f_glint(s2, 1.34)
        lit = disk_integral(lambda t, p: glint(t, math.radians(30.1), p - math.pi), 30, 0, 0.2665) * level
        show(f"L_r, glint {s2} (30.1, 180), sun (30, 0)", lit, 11)
    show("L_r, wheat (30.1, 0), sun (30, 0)", disk_integral(lambda t, p: f_wheat(t, math.radians(30.1), p), 30, 0, 0.2665) * level, 8)


def reflectances():
    for theta, known in ((30, "0.734215727909711"), (60, "0.712386680567085"), (80, "0.713447834768679"), (85, "0.747348019118055"), (89, "0.903431333882796"), (89.9, "1.25859711892973")):
        show(f"rho_dh of wheat, {theta} (check: {known})", rho_wheat(math.radians(theta)), 14)
    # dE of a ring all around, in v = sqrt(mu), in pieces towards the horizon.
    cuts = [0, 0.02, 0.06, 0.18, 0.5, 1]
    steps = [(a + (b - a) * x, (b - a) * w) for a, b in zip(cuts, cuts[1:]) for x, w in G12]
    rings = [(math.acos(v * v), 2 * math.pi * w * 2 * v**3) for v, w in steps]
    rho = [rho_wheat(t) for t, _ in rings]
    over = sum(w * r * (1 + 2 * math.cos(t)) / 3 for (t, w), r in zip(rings, rho))
    show("R, wheat, overcast", over / (7 * math.pi / 9), 11)
    a, tc = math.radians(0.2665), math.radians(60)
    level = 1 / (math.pi * math.sin(a) ** 2)
    sun = 0.0
    for x, w in gauss(8):
        off = -a * math.cos(math.pi * x)
        t = tc + off
        width = 2 * math.asin(math.sqrt(math.sin((a + off) / 2) * math.sin((a - off) / 2) / (math.sin(t) * math.sin(tc))))
        sun += w * a * math.pi * math.sin(math.pi * x) * 2 * width * math.sin(t) * math.cos(t) * rho_wheat(t) * level
    show("R, wheat, sun 60", sun / math.cos(tc), 11)
    # 1000 of sun across the beam, and a sky of zenith radiance 50.
    show("R, wheat, 1000 sun 60 + 50 overcast", (1000 * sun + 50 * over) / (1000 * math.cos(tc) + 50 * 7 * math.pi / 9), 11)


if __name__ == "__main__":
    closed_values()
    radiances()
    reflectances()
    part_of_disk()
    irradiances()
