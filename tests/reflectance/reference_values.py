#!/usr/bin/env python3
"""Prints the reference values of these tests that are not printed in the literature: needs mpmath (python3-mpmath).

Every value comes from the textbook formula with 30 digits or more, where its cancellations do no harm.
"""
from mpmath import atan2, cos, cot, erfc, exp, log, mp, mpf, nstr, pi, quad, sin, sqrt

mp.dps = 40


def show(name, value, digits=18):
    print(f"{name:58s} {nstr(value, digits)}")


def rad(degrees):
    return mpf(degrees) * pi / 180


def hapke_rho_dh(mu_i, a, one_minus_omega0):
    """Eq 7 integrated over the hemisphere; a = 2 (Hapke) or 1 (as printed)."""
    g, w = sqrt(one_minus_omega0), 1 - one_minus_omega0
    h = lambda m: (1 + a * m) / (1 + 2 * g * m)
    return quad(lambda m: w / 2 / (mu_i + m) * h(mu_i) * h(m) * m, [0, mpf("0.01"), mpf("0.1"), 1])


def log_h(mu, w):
    """Chandrasekhar's H (Stibbs and Weir 1959); the digits of 1 - w x cot x near x = 0 and w = 1 need mp.dps = 70."""
    cuts = [mpf(10) ** -k for k in (25, 18, 12, 8, 5, 3, 1)] + [mpf("0.5"), 1, mpf("1.4"), mpf("1.55")]
    cuts += [pi / 2 - mpf(10) ** -k for k in (2, 3, 4, 6, 8, 10, 12, 14)] if mu < mpf("0.01") else []
    f = lambda x: log(1 - w * x * cot(x)) / (cos(x) ** 2 + mu**2 * sin(x) ** 2)
    return -mu / pi * quad(f, cuts + [pi / 2])


def hapke_hg(theta_i, theta_r, phi, w, g, h):
    ti, tr, dphi = rad(theta_i), rad(theta_r), rad(phi)
    mi, mr = cos(ti), cos(tr)
    c = mi * mr + sin(ti) * sin(tr) * cos(dphi)
    p = (1 - g * g) / (1 + g * g + 2 * g * c) ** mpf("1.5")
    return w / (4 * pi * (mi + mr)) * (p + h(mi) * h(mr) - 1)


def fresnel_albedo(n):
    def r(m):
        t = sqrt(1 - (1 - m * m) / n**2)
        return (((m - n * t) / (m + n * t)) ** 2 + ((n * m - t) / (n * m + t)) ** 2) / 2

    return 2 * quad(lambda m: r(m) * m, [0, mpf("1e-4"), mpf("1e-3"), mpf("1e-2"), mpf("0.1"), 1])


def glint(theta_i, theta_r, phi, s2, n):
    ti, tr, dphi = rad(theta_i), rad(theta_r), rad(phi)
    mi, mr = cos(ti), cos(tr)
    c = mi * mr + sin(ti) * sin(tr) * cos(dphi)
    cos2_beta = (mi + mr) ** 2 / (2 + 2 * c)
    ci, t = sqrt((1 + c) / 2), sqrt(1 - (1 - c) / 2 / n**2)
    r = (((ci - n * t) / (ci + n * t)) ** 2 + ((n * ci - t) / (n * ci + t)) ** 2) / 2
    return r * exp(-(1 / cos2_beta - 1) / s2) / (pi * s2) / (4 * mi * mr * cos2_beta**2)


show("Minnaert rho .5 k .5 (30, 60)", mpf("0.5") / pi * sqrt(cos(rad(30)) * cos(rad(60))))
show("glint 0.0542 (30, 30, 0)", glint(30, 30, 0, mpf("0.0542"), mpf("1.34")))
v = cot(rad(85)) / sqrt(mpf("0.0542"))
show("Smith's Lambda, 85 deg", (exp(-v * v) / (v * sqrt(pi)) - erfc(v)) / 2)
for co_albedo in (1e-8, 1e-12, 1e-14, 1e-16):
    for mu in ("1", "0.5"):
        show(f"hapke rho_dh, 1 - omega0 = {co_albedo}, mu {mu}", hapke_rho_dh(mpf(mu), 2, mpf(co_albedo)))
for k in (None, 40, 20, 10):
    mu = 1 if k is None else 1 - mpf(2) ** -k
    for a in (2, 1):
        show(f"hapke rho_dh, omega0 = .75, mu = 1 - 2^-{k}, a {a}", hapke_rho_dh(mu, a, mpf("0.25")))
show("A of Fresnel, n = 1.0001", fresnel_albedo(mpf("1.0001")))

mp.dps = 70
for w in ("0.5", "0.9", "1"):
    for mu in ("1e-12", "0.001", "0.1", "0.5", "0.9", "1"):
        show(f"H({mu}), omega0 = {w}", exp(log_h(mpf(mu), mpf(w))))
mp.dps = 30
w, g = mpf("0.9"), mpf("-0.3")
for geometry in ((30, 0, 0), (30, 30, 180), (30, 60, 180)):
    h = lambda m: exp(log_h(m, w))
    show(f"hapke_exact .9 {geometry}", hapke_hg(*geometry, w, mpf(0), h))
    show(f"hapke_exact_hg .9 -.3 {geometry}", hapke_hg(*geometry, w, g, h))
mp.dps = 20
for w in ("0.5", "0.9"):
    integral = quad(lambda m: exp(log_h(m, mpf(w))) * m, [mpf("1e-9"), mpf("0.05"), mpf("0.3"), 1])
    show(f"A of hapke_exact {w}", 1 - 2 * sqrt(1 - mpf(w)) * integral, 16)

mp.dps = 40


def turned_z(v, a):
    return [cos(a) * v[0] - sin(a) * v[1], sin(a) * v[0] + cos(a) * v[1], v[2]]


def turned_y(v, a):
    return [cos(a) * v[0] + sin(a) * v[2], v[1], -sin(a) * v[0] + cos(a) * v[2]]


def direction(theta, phi):
    return [sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta)]


def polar(v):
    return atan2(sqrt(v[0] ** 2 + v[1] ** 2), v[2]), atan2(v[1], v[0])


def half_and_difference(i, r):
    """Rusinkiewicz (1998): theta_h, phi_h, theta_d, phi_d."""
    theta_h, phi_h = polar([a + b for a, b in zip(i, r)])
    return (theta_h, phi_h) + polar(turned_y(turned_z(i, -phi_h), -theta_h))


def about_specular(theta_i, phi_i, r):
    """The arc from the mirror direction, and the azimuth about it: 0 towards the normal."""
    arc, azimuth = polar(turned_y(turned_z(r, -(phi_i + pi)), -theta_i))
    return arc, azimuth - pi if azimuth > 0 else azimuth + pi


for row in [(30, 0, 45, 60), (10, -170, 80, 160), ("89.5", 20, 60, "-159.99"), (75, 45, "0.5", -100),
            (55, 30, 55, "210.001"), (20, 0, 70, 180)]:
    theta_i, phi_i, theta_r, phi_r = [rad(x) for x in row]
    r = direction(theta_r, phi_r)
    angles = half_and_difference(direction(theta_i, phi_i), r) + about_specular(theta_i, phi_i, r)
    for name, angle in zip(["theta_h", "phi_h", "theta_d", "phi_d", "radial", "azimuth"], angles):
        show(f"{name} of {row}", angle * 180 / pi)
