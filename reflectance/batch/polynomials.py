#!/usr/bin/env python3
"""Prints the coefficients of vector_math.h: needs mpmath (python3-mpmath).

Each function is interpolated at the Chebyshev points of its range with 60 digits; the error printed is that of the
coefficients as doubles, relative to what the polynomial is multiplied into.
"""
from mpmath import atan, cos, erfc, exp, factorial, inf, log, mp, mpf, nsum, pi, sin, sqrt, tan

mp.dps = 60


def fitted(f, low, high, size):
    """Powers of x of the polynomial through f at `size` Chebyshev points of [low, high]."""
    middle, half = (high + low) / 2, (high - low) / 2
    points = [middle + half * cos(pi * (k + mpf(1) / 2) / size) for k in range(size)]
    divided = [f(x) for x in points]
    for order in range(1, size):
        for k in range(size - 1, order - 1, -1):
            divided[k] = (divided[k] - divided[k - 1]) / (points[k] - points[k - order])
    powers = [mpf(0)] * size
    for k in range(size - 1, -1, -1):
        powers = [divided[k] - points[k] * powers[0]] + [powers[n - 1] - points[k] * powers[n] for n in range(1, size)]
    return powers


def show(name, f, low, high, size, weight=lambda x: mpf(1)):
    low, high = mpf(low), mpf(high)
    powers = [float(c) for c in fitted(f, low, high, size)]
    worst = mpf(0)
    for k in range(400):
        x = low + (high - low) * (k + mpf(1) / 2) / 400
        value = sum(mpf(c) * x**n for n, c in enumerate(powers))
        worst = max(worst, abs(value - f(x)) * weight(x))
    print(f"// {name}: error {float(worst):.1e}")
    print(",\n".join(repr(c) for c in powers))


# x + x x2 P(x2) = sin x, |x| <= pi/2
show("kSine", lambda q: (sin(sqrt(q)) / sqrt(q) - 1) / q, "1e-30", (pi / 2) ** 2, 9, lambda q: q)
# 1 + r + r^2 P(r) = e^r, |r| <= ln 2 / 2
show("kExp", lambda r: nsum(lambda n: r**n / factorial(n + 2), [0, inf]), -log(2) / 2, log(2) / 2, 11, lambda r: r * r)
# 2 z (1 + z2 P(z2)) = ln((1 + z)/(1 - z)), |z| <= 3 - 2 sqrt 2
show("kLog", lambda q: (log((1 + sqrt(q)) / (1 - sqrt(q))) / (2 * sqrt(q)) - 1) / q, "1e-30", (3 - 2 * sqrt(2)) ** 2, 8,
     lambda q: q)
# z (1 + z2 P(z2)) = atan z, |z| <= tan(pi/8)
show("kArcTangent", lambda q: (atan(sqrt(q)) / sqrt(q) - 1) / q, "1e-30", tan(pi / 8) ** 2, 11, lambda q: q)


# P(t) = e^(v^2) erfc(v), v = 2 (1 + t)/(1 - t), t from -1 (v = 0) to 1/2 (v = 6), counted as erfc
def at(t):
    return 2 * (1 + t) / (1 - t)


show("kScaledErfc", lambda t: exp(at(t) ** 2) * erfc(at(t)), -1, "0.5", 22, lambda t: exp(-at(t) ** 2))
