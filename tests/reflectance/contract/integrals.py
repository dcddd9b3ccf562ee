"""The hemispherical integrals of formulas.py, each in coordinates of its own choice."""
from mpmath import cos, exp, mpf, pi, sin, sqrt, tan

from formulas import (fresnel, h_approximate, hg_azimuth_integral, smith_lambda, water_body_with)
from quadrature import beyond, over


def minnaert_rho_dh(p, theta, level=5):
    rho, k = p
    return over(lambda mu, *_: 2 * rho * (cos(theta) * mu) ** k * mu, mpf(0), mpf(1), level)


def minnaert_albedo(p):
    rho, k = p
    return over(lambda mu, *_: 2 * mu * over(lambda m, *_: 2 * rho * (mu * m) ** k * m, mpf(0), mpf(1), 4), mpf(0), mpf(1),
                4)


def rpv_rho_dh(p, theta, level):
    """In the plane z = 1, polar about the point that i pierces: G is the radius, mu dOmega = mu^4 dx dy."""
    rho0, k, g = p
    t, mu_i = tan(theta), cos(theta)

    def element(radius, cos_psi):
        mu = 1 / sqrt(1 + t * t + radius * radius + 2 * t * radius * cos_psi)
        cos_xi = mu_i * mu * (1 + t * (t + radius * cos_psi))
        phase = (1 - g * g) / (1 + g * g + 2 * g * cos_xi) ** mpf("1.5")
        return rho0 * (mu_i * mu * (mu_i + mu)) ** (k - 1) * phase * (1 + (1 - rho0) / (1 + radius)) * mu**4 * radius

    def ring(radius, *_):
        return 2 * over(lambda psi, *_: element(radius, cos(psi)), mpf(0), pi, level)

    inside = over(ring, mpf(0), t, level) if t > 0 else 0
    return inside + beyond(ring, t, 1, level)


def glint_rho_dh(p, theta, level, shadows=False, reflect=fresnel):
    """Over the slopes s (cos a, sin a) of the facets: f mu dOmega = R p cos(omega) / (mu_i cos(beta)) ds^2, with
    cos(omega) = (mu_i + s sin(theta_i) cos(a)) cos(beta), up to the slope that mirrors into the horizon."""
    s2, n = p
    mu_i, sine = cos(theta), sin(theta)
    hidden_i = smith_lambda(mu_i, s2) if shadows else mpf(0)
    sigma = sqrt(s2)

    def element(s, cos_a):
        facing = mu_i + s * sine * cos_a
        cos_beta = 1 / sqrt(1 + s * s)
        mu_r = 2 * facing * cos_beta**2 - mu_i
        if mu_r <= 0 or facing <= 0:
            return mpf(0)
        share = 1 / (1 + hidden_i + smith_lambda(mu_r, s2)) if shadows else 1
        return reflect(facing * cos_beta, n) * exp(-s * s / s2) / (pi * s2) * facing / mu_i * share * s

    def ray(a, *_):
        c = cos(a)
        last = (sine * c + sqrt((sine * c) ** 2 + mu_i**2)) / mu_i
        if last <= 12 * sigma:
            return over(lambda s, *_: element(s, c), mpf(0), last, level)
        return over(lambda s, *_: element(s, c), mpf(0), min(last, 12 * sigma), level)

    return 2 * (over(ray, mpf(0), pi / 2, level) + over(ray, pi / 2, pi, level))


def hapke_rho_dh(a, w, mu_i, level=5):
    h = lambda mu: h_approximate(a, w, mu)
    return over(lambda mu, *_: w / 2 / (mu_i + mu) * h(mu_i) * h(mu) * mu, mpf(0), mpf(1), level)


def hapke_albedo(a, w, level=5):
    return over(lambda mu, *_: 2 * mu * hapke_rho_dh(a, w, mu, level), mpf(0), mpf(1), level)


def hapke_hg_rho_dh(w, g, mu_i, level=5, h=None):
    h = h or (lambda mu: h_approximate(2, w, mu))

    def element(mu, *_):
        return w * mu / (4 * pi * (mu_i + mu)) * (hg_azimuth_integral(g, mu_i, mu) + 2 * pi * (h(mu_i) * h(mu) - 1))

    above = over(element, mu_i, mpf(1), level) if mu_i < 1 else 0
    return over(element, mpf(0), mu_i, level) + above


def hapke_hg_albedo(w, g, level=4):
    return over(lambda mu, *_: 2 * mu * hapke_hg_rho_dh(w, g, mu, level), mpf(0), mpf(1), level)


def fresnel_albedo(n, level=6):
    f = lambda c, *_: 2 * c * fresnel(c, n)
    critical = sqrt(1 - n * n) if n < 1 else mpf(0)
    return over(f, critical, mpf(1), level) + critical**2


def water_body_rho_dh(p, mu_i):
    rho_w, n = p
    return (1 - fresnel(mu_i, n)) * rho_w / (n * n * (1 - fresnel_albedo(1 / n) * rho_w)) * (1 - fresnel_albedo(n))


def water_body_albedo(p):
    return over(lambda mu, *_: 2 * mu * water_body_rho_dh(p, mu), mpf(0), mpf(1), 4)
