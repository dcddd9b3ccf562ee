"""Double-exponential rules for mpmath, nodes made once: the integrands of oracle.py are dear."""
from functools import lru_cache

from mpmath import cosh, exp, mp, mpf, pi, sinh


@lru_cache(maxsize=None)
def _tanh_sinh(level, digits):
    """(x, 1 - x, weight) over [0, 1] with step 2^-level."""
    step, nodes = mpf(2) ** -level, []
    k = 0
    while True:
        s = pi / 2 * sinh(k * step)
        x = 1 / (1 + exp(2 * s))  # the distance from the nearer end
        weight = step * pi * cosh(k * step) * x * (1 - x)
        if weight < mpf(10) ** -(2 * digits):
            return nodes
        nodes.append((x, 1 - x, weight))
        if k:
            nodes.append((1 - x, x, weight))
        k += 1


def over(f, a, b, level=4):
    """integral of f(x, x - a, b - x) over [a, b]: the distances from the ends keep their digits."""
    return sum(w * f(a + x * (b - a), x * (b - a), y * (b - a)) for x, y, w in _tanh_sinh(level, mp.dps)) * (b - a)


@lru_cache(maxsize=None)
def _exp_sinh(level, digits):
    step, nodes = mpf(2) ** -level, []
    for k in range(-(5 << level), (5 << level) + 1):
        x = exp(pi / 2 * sinh(k * step))
        if mpf(10) ** (-2 * digits) < x < mpf(10) ** (2 * digits):
            nodes.append((x, step * pi / 2 * cosh(k * step) * x))
    return nodes


def beyond(f, a, scale=1, level=4):
    """integral of f(x, x - a) over [a, inf)."""
    return sum(w * scale * f(a + scale * x, scale * x) for x, w in _exp_sinh(level, mp.dps))
