#!/usr/bin/env python3
"""Writes the tables *.inc of this folder: needs mpmath (python3-mpmath) and takes some ten minutes.

    python3 oracle.py separations fresnel points hard integrals

Every value is that of a textbook formula (formulas.py, integrals.py) at the very doubles that the library is given,
angles in radians included, with 30 to 120 digits. Points carry their condition: the sum over the inputs x of
|x f'(x) / f|, from a step of 1e-20; inputs that are the same number (the two thetas of retro-reflection) move together.
"""
import math
import random
import sys

from mpmath import acos, cos, exp, mp, mpf, nstr, pi, quad, sin, sqrt

import formulas
import integrals
from formulas import Direction, cos_phase, fresnel_p, fresnel_s, log_h_of, phase_angle, retro_distance
from integrals import (fresnel_albedo, glint_rho_dh, hapke_albedo, hapke_hg_albedo, hapke_hg_rho_dh,
                       hapke_rho_dh, minnaert_albedo, minnaert_rho_dh, rpv_rho_dh, water_body_albedo,
                       water_body_rho_dh)

SEED = 20260815

# (model, parameters in the order of make_surface's table)
SURFACES = [
    ("lambertian", [0.37]),
    ("minnaert", [0.5, 0.5]), ("minnaert", [0.9, 0.0]), ("minnaert", [1.3, 2.0]), ("minnaert", [0.21, -0.5]),
    ("hapke", [1e-6]), ("hapke", [0.3]), ("hapke", [0.75]), ("hapke", [0.999]), ("hapke", [1.0 - 1e-8]),
    ("hapke", [1.0 - 1e-14]), ("hapke", [1.0]),
    ("hapke_as_printed", [0.3]), ("hapke_as_printed", [1.0 - 1e-14]), ("hapke_as_printed", [1.0]),
    ("hapke_exact", [1e-6]), ("hapke_exact", [0.5]), ("hapke_exact", [0.999]), ("hapke_exact", [1.0 - 1e-14]),
    ("hapke_exact", [1.0]),
    ("hapke_hg", [0.9, -0.3]), ("hapke_hg", [0.5, 0.6]), ("hapke_hg", [0.2, -0.95]), ("hapke_hg", [1.0, 0.999]),
    ("hapke_hg", [0.7, -0.999]), ("hapke_hg", [1e-6, 0.9]), ("hapke_hg", [1e-3, 0.999]),
    ("hapke_exact_hg", [0.9, -0.3]), ("hapke_exact_hg", [1e-6, 0.9]), ("hapke_exact_hg", [0.999, 0.99]),
    ("rpv", [0.133, 0.851, -0.114]), ("rpv", [0.05, 0.0, -0.3]), ("rpv", [0.9, 0.4, 0.2]), ("rpv", [0.3, 1.0, 0.0]),
    ("rpv", [0.02, 1.5, -0.999]), ("rpv", [1.0, 2.0, 0.999]), ("rpv_brf", [0.2, 0.7, -0.6]),
    ("water_body", [0.02, 1.34]), ("water_body", [1.0, 1.34]), ("water_body", [0.5, 1.0]), ("water_body", [0.3, 1.001]),
    ("water_body", [0.9, 4.0]),
    ("glint", [1e-6, 1.34]), ("glint", [1e-3, 1.5]), ("glint", [0.0542, 1.34]), ("glint", [0.3, 1.0001]),
    ("glint", [1.0, 4.0]), ("cox_munk", [3.0, 1.34]),
    ("glint_smith", [1e-6, 1.34]), ("glint_smith", [0.02, 1.34]), ("glint_smith", [1.0, 1.5]),
    ("cox_munk_smith", [12.0, 1.34]),
]

THETA, ELEVATION = False, True
LOW = 89.9999999999 * (math.pi / 180)

# ((by elevation, angle, phi) of i, of r)
HARD = [
    ((THETA, 0.0, 0.0), (THETA, 0.0, 0.0)),
    ((THETA, 0.0, 0.0), (THETA, 1.2, 0.7)),
    ((THETA, 1e-9, 0.3), (THETA, 2e-9, -2.0)),
    ((THETA, 0.5, 0.3), (THETA, 0.5 + 1e-6, 0.3)),
    ((THETA, 0.5, 0.3), (THETA, 0.5 + 1e-9, 0.3)),
    ((THETA, 0.5, 0.3), (THETA, 0.5 + 1e-12, 0.3)),
    ((THETA, 0.9, 0.0), (THETA, 0.9, 1e-6)),
    ((THETA, 0.9, 0.0), (THETA, 0.9, 1e-9)),
    ((THETA, 0.9, 0.0), (THETA, 0.9, 1e-12)),
    ((THETA, 1.4, 0.0), (THETA, 1.4 + 1e-10, -1e-10)),
    ((THETA, 0.8, 0.0), (THETA, 0.8, math.pi)),
    ((THETA, 0.8, 0.0), (THETA, 0.8 + 1e-7, math.pi)),
    ((THETA, 1.5, 0.0), (THETA, 1.5 + 1e-9, math.pi - 1e-9)),
    ((THETA, 0.4, 2.0), (THETA, LOW, 0.0)),
    ((THETA, LOW, 0.0), (THETA, LOW, 1e-6)),
    ((THETA, LOW, 0.0), (THETA, LOW, math.pi)),
    ((THETA, 1.1, 0.0), (ELEVATION, 1.75e-12, 0.0)),
    ((ELEVATION, 1e-10, 0.0), (ELEVATION, 2e-10, 1e-12)),
    ((ELEVATION, 1e-10, 0.0), (ELEVATION, 1e-10 + 1e-22, 0.0)),
    ((ELEVATION, 1e-10, 0.0), (ELEVATION, 2e-10, math.pi)),
    ((ELEVATION, 0.3, 0.0), (THETA, 1.2707963267948965, 1e-8)),
]


def random_pairs(count, seed):
    chance = random.Random(seed)
    angle = lambda: (THETA, math.acos(chance.random()), chance.uniform(-math.pi, math.pi))
    return [(angle(), angle()) for _ in range(count)]


def direction(by_elevation, angle, phi):
    return Direction(None, phi, angle) if by_elevation else Direction(angle, phi)


def condition(f, inputs):
    step, value = mpf(10) ** -20, f(inputs)
    total = mpf(0)
    for number in set(inputs):
        turned = lambda sign: [x * (1 + sign * step) if x == number else x for x in inputs]
        total += max(abs(f(turned(sign)) / value - 1) / step for sign in (1, -1))
    return total


def row(*fields):
    return "{" + ", ".join(fields) + "},\n"


def doubles(values):
    return [mpf(v) for v in values]


def digits(value, count=20):
    return nstr(value, count, min_fixed=-4, max_fixed=6)


def words(by_elevation, angle, phi):
    return "{" + ", ".join(("true" if by_elevation else "false", repr(angle), repr(phi))) + "}"


def write(name, rows):
    with open(f"{name}.inc", "w") as out:
        out.write("// By oracle.py: do not edit.\n")
        out.writelines(rows)


def separations():
    mp.dps = 120
    rows = []
    for i, r in HARD + random_pairs(20, SEED):
        a, b = direction(*i), direction(*r)
        c = cos_phase(a, b)
        values = [phase_angle(a, b), (1 - c) / 2, (1 + c) / 2, c, retro_distance(a, b)]
        rows.append(row(words(*i), words(*r), *map(digits, values)))
    write("oracle_separations", rows)


def fresnel():
    mp.dps = 60
    rows = []
    for n in (0.1, 0.5, 1 / 1.34, 0.999, 1.0, 1.0000001, 1.001, 1.34, 1.5, 4.0, 100.0):
        thetas = [0.0, 1e-6, 0.2, 0.7, 1.2, 1.5, 1.57, LOW]
        if n < 1:
            critical = math.asin(n)
            thetas += [critical * (1 - d) for d in (1e-2, 1e-6, 1e-10)] + [critical * (1 + 1e-12)]
        for theta in thetas:
            c, index = cos(mpf(theta)), mpf(n)
            total = lambda x: (fresnel_s(cos(x[0]), x[1]) + fresnel_p(cos(x[0]), x[1])) / 2
            reflected = total([mpf(theta), index])
            bad = condition(total, [mpf(theta), index]) if 0 < reflected < 1 else mpf(0)
            through = lambda x: 1 - total(x)
            dim = condition(through, [mpf(theta), index]) if 0 < reflected < 1 else mpf(0)
            values = [fresnel_s(c, index), fresnel_p(c, index), reflected, 1 - reflected]
            rows.append(row(repr(theta), repr(n), *map(digits, values), digits(bad, 3), digits(dim, 3)))
    write("oracle_fresnel", rows)


class ExactH:
    """Chandrasekhar's H, each value computed once."""

    def __init__(self):
        self.known = {}

    def __call__(self, w, mu):
        key = (w, mu, mp.dps)
        if key not in self.known:
            self.known[key] = exp(log_h_of(mu, w, quad))
        return self.known[key]


EXACT_H = ExactH()


def model_function(model):
    if model == "water_body":
        known = {}

        def internal(n):
            if n not in known:
                known[n] = fresnel_albedo(1 / n)
            return known[n]
        return lambda p, i, r: formulas.water_body_with(internal, p, i, r)
    if model.startswith("hapke_exact"):
        return lambda p, i, r: formulas.hapke_with(lambda mu: EXACT_H(p[0], mu), p[0], p[1] if len(p) > 1 else mpf(0),
                                                   i, r)
    return getattr(formulas, model)


def point_value(f, pair, values):
    (i_low, i_angle, i_phi), (r_low, r_angle, r_phi) = pair

    def of(x):
        return f(x[4:], direction(i_low, x[0], x[1]), direction(r_low, x[2], x[3]))
    return of, doubles([i_angle, i_phi, r_angle, r_phi] + values)


def points():
    rows = []
    for number, (model, values) in enumerate(SURFACES):
        print(model, values, file=sys.stderr)
        exact, water = "exact" in model, model == "water_body"
        mp.dps = 30 if exact else 50 if water else 100
        f = model_function(model)
        pairs = HARD + random_pairs(8, SEED + number)
        for pair in random.Random(number).sample(pairs, 5) if exact else pairs:
            of, inputs = point_value(f, pair, values)
            if exact:
                mp.dps = 60
                plain = point_value(lambda p, i, r: formulas.hapke_hg([p[0], p[1] if len(p) > 1 else mpf(0)], i, r),
                                    pair, values)[0]
                bad = condition(plain, inputs)  # Hapke's H is as smooth as the exact one
                mp.dps = 30
            elif water:
                bad = condition(lambda x: of(x[:5] + [x[5]]), inputs[:5] + [inputs[5]])
            else:
                bad = condition(of, inputs)
            value = of(inputs)
            if 1e-280 < value < 1e280:
                rows.append(row(str(number), words(*pair[0]), words(*pair[1]), digits(value), digits(bad, 3)))
    write("oracle_points", rows)
    write("oracle_surfaces", [row(f'"{m}"', "{" + ", ".join(map(repr, v)) + "}") for m, v in SURFACES])


def sea_variance(wind):
    return mpf("0.003") + mpf("0.00512") * wind


def approximate_hapke(a):
    return (lambda p, theta: hapke_rho_dh(a, p[0], cos(theta)), lambda p: hapke_albedo(a, p[0]))


# model -> (rho_dh(parameters, theta), A(parameters))
INTEGRALS = {
    "minnaert": (minnaert_rho_dh, minnaert_albedo),
    "hapke": approximate_hapke(2),
    "hapke_as_printed": approximate_hapke(1),
    "hapke_exact": (lambda p, theta: 1 - sqrt(1 - p[0]) * EXACT_H(p[0], cos(theta)), None),
    "hapke_hg": (lambda p, theta: hapke_hg_rho_dh(*p, cos(theta), level=6), lambda p: hapke_hg_albedo(*p)),
    "rpv": (lambda p, theta: rpv_rho_dh(p, theta, 5 if theta > 0.8 else 4), None),
    "rpv_brf": (lambda p, theta: rpv_rho_dh(p, theta, 5 if theta > 0.8 else 4) / pi, None),
    "water_body": (lambda p, theta: water_body_rho_dh(p, cos(theta)), water_body_albedo),
    "glint": (lambda p, theta: glint_rho_dh(p, theta, 5 if theta > 0.4 else 4), None),
    "glint_smith": (lambda p, theta: glint_rho_dh(p, theta, 5 if theta > 0.4 else 4, True), None),
    "cox_munk": (lambda p, theta: glint_rho_dh([sea_variance(p[0]), p[1]], theta, 5), None),
}

# (model, parameters, thetas [rad], whether A is asked for)
INTEGRATED = [
    ("minnaert", [0.5, 0.5], [0.0, 0.9, 1.57], True), ("minnaert", [0.2, -0.5], [0.3, 1.5], True),
    ("hapke", [1e-6], [0.0, 1.2], True), ("hapke", [0.3], [0.4, 1.5], True), ("hapke", [0.75], [1e-9, 1e-3, 1.0], True),
    ("hapke", [0.999], [0.7, 1.57], True), ("hapke", [1.0 - 1e-8], [0.0, 1.3], True),
    ("hapke", [1.0 - 1e-14], [0.0, 1.1], True), ("hapke_as_printed", [0.75], [1e-9, 1.4], True),
    ("hapke_as_printed", [1.0 - 1e-14], [0.2, 1.0], True),
    ("hapke_exact", [1e-3], [0.3, 1.4], False), ("hapke_exact", [0.999], [0.0, 1.0], False),
    ("hapke_exact", [1.0 - 1e-14], [0.5, 1.5], False),
    ("hapke_hg", [0.9, -0.3], [0.0, 0.5, 1.2, 1.5], True), ("hapke_hg", [0.5, 0.7], [0.0, 1.3], True),
    ("hapke_hg", [0.7, -0.95], [0.2, 1.0], False), ("hapke_hg", [0.99, 0.99], [0.5, 1.4], False),
    ("hapke_hg", [0.3, -0.999], [0.7], False),
    ("rpv", [0.05, 0.0, -0.3], [0.0, 0.7, 1.1], False), ("rpv", [0.9, 0.4, 0.2], [0.3, 1.3], False),
    ("rpv", [0.02, 1.5, -0.9], [0.5, 1.0], False), ("rpv", [1.0, 2.0, 0.6], [0.2, 1.2], False),
    ("rpv", [0.133, 0.851, -0.114], [1.5], False), ("rpv_brf", [0.2, 0.7, -0.6], [0.6, 1.0], False),
    ("water_body", [0.3, 1.001], [0.4, 1.5], True), ("water_body", [0.9, 4.0], [0.0, 1.57], True),
    ("glint", [1e-6, 1.34], [0.0, 0.9], False), ("glint", [1e-3, 1.5], [0.5, 1.3], False),
    ("glint", [0.3, 1.0001], [0.4, 1.2], False),
    ("glint", [1.0, 4.0], [0.1, 1.0], False), ("cox_munk", [3.0, 1.34], [0.8, 1.4], False),
    ("glint_smith", [1e-4, 1.34], [1.0, 1.5], False),
]


def integral_tables():
    mp.dps = 20
    write("oracle_fresnel_albedo", [row(repr(n), digits(fresnel_albedo(mpf(n)), 18))
                                    for n in (0.1, 0.5, 0.75, 0.999, 1.0001, 1.1, 1.34, 2.0, 4.0, 100.0)])
    rho_rows, albedo_rows = [], []
    for model, values, thetas, with_albedo in INTEGRATED:
        print(model, values, file=sys.stderr)
        mp.dps = 25 if "exact" in model else 20
        rho_dh, albedo = INTEGRALS[model]
        surface = row(f'"{model}"', "{" + ", ".join(map(repr, values)) + "}")[:-2]
        for theta in thetas:
            rho_rows.append(row(surface, repr(theta), digits(rho_dh(doubles(values), mpf(theta)), 18)))
        if with_albedo:
            albedo_rows.append(row(surface, digits(albedo(doubles(values)), 18)))
        write("oracle_rho_dh", rho_rows)
        write("oracle_albedo", albedo_rows)


def hard():
    """What single tests need: Hapke's rho_dh at its limits, phase functions at their peaks, the critical angle."""
    mp.dps = 40
    limits = [(2, c, m) for c in (1e-8, 1e-12, 1e-14, 1e-16) for m in (1.0, 0.5)]
    limits += [(a, 0.25, 1.0 - d) for a in (1, 2) for d in (0.0, 2.0**-43, 2.0**-40, 2.0**-20, 2.0**-10)]
    write("oracle_hapke_limits", [row(str(a), repr(c), repr(m), digits(hapke_rho_dh(a, 1 - mpf(c), mpf(m), 6)))
                                  for a, c, m in limits])
    mp.dps = 80
    peaks = [(-0.999999, (THETA, 0.5, 0.0), (THETA, 0.5 + d, 0.0)) for d in (1e-5, 1e-7, 1e-9, 1e-12)]
    peaks += [(0.999999, (ELEVATION, e, 0.0), (ELEVATION, 2.0 * e, math.pi)) for e in (1e-5, 1e-7, 1e-9, 1e-12)]
    write("oracle_phase_peaks", [row(repr(g), words(*i), words(*r), digits(formulas.henyey_greenstein(
        mpf(g), direction(*i), direction(*r)))) for g, i, r in peaks])
    n = 1 / 1.34
    thetas = [math.asin(n) * (1 - d) for d in (1e-6, 1e-9, 1e-12, 1e-14)] + [math.asin(n)]
    thetas += [math.nextafter(thetas[-1], s) for s in (0.0, 2.0)]
    write("oracle_critical", [row(repr(t), repr(n), digits(1 - formulas.fresnel(cos(mpf(t)), mpf(n)))) for t in thetas])


if __name__ == "__main__":
    for table in sys.argv[1:]:
        {"separations": separations, "fresnel": fresnel, "points": points, "integrals": integral_tables, "hard": hard}[table]()
