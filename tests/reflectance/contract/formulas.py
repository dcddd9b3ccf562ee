"""The equations of the notes in their textbook forms, for mpmath: with 40 to 100 digits their cancellations do no harm.

Nothing here is arranged for doubles, so that no trick of the library is shared. Angles in radians.
"""
from mpmath import (acos, atan, cos, ellipe, erfc, exp, log, mp, mpf, pi, sin, sqrt, tan)


class Direction:
    """theta, or the elevation above the horizon, and phi, as the library receives them."""

    def __init__(self, theta, phi=0, elevation=None):
        self.theta = pi / 2 - elevation if elevation is not None else mpf(theta)
        self.phi = mpf(phi)
        self.mu, self.sine = cos(self.theta), sin(self.theta)


def cos_phase(i, r):
    return i.mu * r.mu + i.sine * r.sine * cos(i.phi - r.phi)  # eq 1


def phase_angle(i, r):
    return acos(cos_phase(i, r))


def retro_distance(i, r):
    a, b = tan(i.theta), tan(r.theta)
    return sqrt(max(a * a + b * b - 2 * a * b * cos(i.phi - r.phi), mpf(0)))


def henyey_greenstein(g, i, r):
    return (1 - g * g) / (1 + g * g + 2 * g * cos_phase(i, r)) ** mpf("1.5")


def fresnel_s(c, n):
    s2 = (1 - c * c) / n**2
    if s2 >= 1:
        return mpf(1)
    t = sqrt(1 - s2)
    return ((c - n * t) / (c + n * t)) ** 2


def fresnel_p(c, n):
    s2 = (1 - c * c) / n**2
    if s2 >= 1:
        return mpf(1)
    t = sqrt(1 - s2)
    return ((n * c - t) / (n * c + t)) ** 2


def fresnel(c, n):
    return (fresnel_s(c, n) + fresnel_p(c, n)) / 2


def log_h_of(mu, w, quad):
    """Chandrasekhar's H: -(mu/pi) integral of ln(1 - w atan(t)/t) / (1 + mu^2 t^2) dt over (0, inf), t = e^u.

    Checked in oracle.py against the integral equation that defines H.
    """
    def integrand(u):
        t = exp(u)
        return log(1 - w * atan(t) / t) * t / (1 + (mu * t) ** 2)

    digits = mp.dps
    with mp.workdps(3 * digits):  # w = 1 takes twice the digits of t at the lower end
        low = -digits * log(mpf(10))
        cuts = [low, low / 3, -8, -2, 0, 2, 2 - log(mu), 12 - log(mu), -log(mu) - low]
        return -mu / pi * quad(integrand, cuts)


def lambertian(p, i, r):
    return p[0] / pi


def minnaert(p, i, r):
    rho, k = p
    return rho / pi * (i.mu * r.mu) ** k


def h_approximate(a, w, mu):
    return (1 + a * mu) / (1 + 2 * sqrt(1 - w) * mu)


def hapke_with(h, w, g, i, r):
    phase = henyey_greenstein(g, i, r)
    return w / (4 * pi) / (i.mu + r.mu) * (phase + h(i.mu) * h(r.mu) - 1)


def hapke(p, i, r):
    return hapke_with(lambda mu: h_approximate(2, p[0], mu), p[0], mpf(0), i, r)


def hapke_as_printed(p, i, r):
    return hapke_with(lambda mu: h_approximate(1, p[0], mu), p[0], mpf(0), i, r)


def hapke_hg(p, i, r):
    return hapke_with(lambda mu: h_approximate(2, p[0], mu), p[0], p[1], i, r)


def rpv(p, i, r):
    rho0, k, g = p
    bowl = (i.mu * r.mu) ** (k - 1) / (i.mu + r.mu) ** (1 - k)
    return rho0 * bowl * henyey_greenstein(g, i, r) * (1 + (1 - rho0) / (1 + retro_distance(i, r)))  # eq 8


def rpv_brf(p, i, r):
    return rpv(p, i, r) / pi


def smith_lambda(mu, s2):
    v = mu / sqrt(1 - mu * mu) / sqrt(s2) if mu < 1 else None
    return (exp(-v * v) / (v * sqrt(pi)) - erfc(v)) / 2 if v is not None else mpf(0)


def glint(p, i, r):
    s2, n = p
    # The half vector i + r, not normalised: its slope is that of the facet.
    x = i.sine * cos(i.phi) + r.sine * cos(r.phi)
    y = i.sine * sin(i.phi) + r.sine * sin(r.phi)
    z = i.mu + r.mu
    tan2 = (x * x + y * y) / (z * z)
    reflected = fresnel(cos(phase_angle(i, r) / 2), n)
    return reflected * exp(-tan2 / s2) / (pi * s2) * (1 + tan2) ** 2 / (4 * i.mu * r.mu)


def glint_smith(p, i, r):
    return glint(p, i, r) / (1 + smith_lambda(i.mu, p[0]) + smith_lambda(r.mu, p[0]))


def cox_munk(p, i, r):
    return glint([mpf("0.003") + mpf("0.00512") * p[0], p[1]], i, r)


def cox_munk_smith(p, i, r):
    return glint_smith([mpf("0.003") + mpf("0.00512") * p[0], p[1]], i, r)


def water_body_with(internal_albedo, p, i, r):
    rho_w, n = p
    passed = (1 - fresnel(i.mu, n)) * (1 - fresnel(r.mu, n))
    return passed * rho_w / (pi * n * n * (1 - internal_albedo(n) * rho_w))


def hg_azimuth_integral(g, mu_i, mu_r):
    """integral over phi of Henyey and Greenstein's phase function: a complete elliptic integral."""
    sines = 2 * g * sqrt((1 - mu_i**2) * (1 - mu_r**2))
    a, b = 1 + g * g + 2 * g * mu_i * mu_r, abs(sines)
    return (1 - g * g) * 4 * ellipe(2 * b / (a + b)) / ((a - b) * sqrt(a + b))
