"""Search for a root or a maximum in a bracket, for scalars and, with numpy, for arrays; quantiles
and intervals.

The scalar functions need no numpy, which keeps the start of commands short. The functions for
arrays search independently in every element. All of them make the same steps on every machine for
the same function values, so results that are printed or hashed stay reproducible.

References: W. H. Press et al., Numerical Recipes, 3rd ed., sections 9.1 (bisection), 9.2 (false
position), 10.2 (golden section) and 10.3 (Brent's method); M. Dowell and P. Jarratt, BIT 11 (1971)
168, for the Illinois variant of false position.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, TypeAlias

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

Array: TypeAlias = "NDArray[np.float64]"
Pair: TypeAlias = tuple[float, float]

_GOLDEN = 0.5 * (math.sqrt(5.0) - 1.0)
"""Inverse of the golden ratio: the share of the bracket that each golden-section step keeps."""


def bisect(
    is_below: Callable[[float], bool], low: float, high: float, *, halvings: int | None = None
) -> Pair:
    """Narrow the bracket of a boundary by bisection, and return both its ends.

    Without `halvings`, the ends become neighbouring floats.
    """
    for _ in itertools.count() if halvings is None else range(halvings):
        middle = 0.5 * (low + high)
        if not low < middle < high:  # the ends are neighbouring floats
            break

        if is_below(middle):
            low = middle
        else:
            high = middle

    return low, high


def bisect_arrays(
    is_below: Callable[[Array], NDArray[np.bool_]], low: Array, high: Array, halvings: int
) -> tuple[Array, Array]:
    """Narrow the bracket of a boundary in every element by a fixed number of halvings.

    It is the counterpart of `bisect`.
    """
    import numpy as np  # noqa: PLC0415

    for _ in range(halvings):
        middle = 0.5 * (low + high)
        below = is_below(middle)
        low = np.where(below, middle, low)
        high = np.where(below, high, middle)

    return low, high


def find_maximum_arrays(
    function: Callable[[Array], Array], low: Array, high: Array, steps: int
) -> tuple[Array, Array]:
    """Find the maximum in every element by golden-section steps.

    Each step narrows the brackets to 0.618. Returns the places and the values.
    """
    import numpy as np  # noqa: PLC0415

    left = high - _GOLDEN * (high - low)
    right = low + _GOLDEN * (high - low)
    at_left = function(left)
    at_right = function(right)

    for _ in range(steps):
        rises = at_left < at_right
        low = np.where(rises, left, low)
        high = np.where(rises, high, right)
        new = np.where(rises, low + _GOLDEN * (high - low), high - _GOLDEN * (high - low))
        at_new = function(new)
        next_left = np.where(rises, right, new)
        right = np.where(rises, new, left)
        left = next_left
        at_next_left = np.where(rises, at_right, at_new)
        at_right = np.where(rises, at_new, at_left)
        at_left = at_next_left

    return np.where(at_left >= at_right, left, right), np.maximum(at_left, at_right)


# Quantiles of Student's t for whole degrees of freedom, by finite sums: M. Abramowitz and I. A.
# Stegun, Handbook of Mathematical Functions, 26.7.3 and 26.7.4.

_LARGEST = 1e4


def t_quantile(two_sided: float, degrees: int) -> float:
    """Return the t for which |T| <= t has the probability `two_sided`."""
    return bisect(lambda t: t_probability(t, degrees) < two_sided, 0.0, _LARGEST)[0]


def t_probability(t: float, degrees: int) -> float:
    """Return the probability that |T| <= t."""
    angle = math.atan2(t, math.sqrt(degrees))
    odd = degrees % 2
    cos2 = math.cos(angle) ** 2
    term = math.cos(angle) if odd else 1.0
    total = 0.0

    for i in range(1, degrees // 2 + 1):
        total += term
        term *= (2 * i - 1 + odd) / (2 * i + odd) * cos2

    return 2.0 / math.pi * (angle + math.sin(angle) * total) if odd else math.sin(angle) * total


CONFIDENCE = 0.95
"""Probability with which an interval holds the true value."""


def poisson_interval(count: int) -> tuple[float, float]:
    """Compute the interval of a Poisson variable's mean from one draw.

    Source: F. Garwood, Biometrika 28, 1936, 437.
    """
    tail = (1 - CONFIDENCE) / 2
    top = count + 10 * math.sqrt(count + 1) + 10
    low = 0.0
    if count:
        low, _ = bisect(lambda mean: 1 - _cumulative(count - 1, mean) < tail, 0.0, top, halvings=80)

    high, _ = bisect(lambda mean: _cumulative(count, mean) > tail, 0.0, top, halvings=80)
    return low, high


def _cumulative(count: int, mean: float) -> float:
    """Return the probability that a Poisson variable is at most a count."""
    if mean <= 0.0:
        return 1.0

    return math.fsum(
        math.exp(k * math.log(mean) - mean - math.lgamma(k + 1)) for k in range(count + 1)
    )


def binomial_interval(count: int, total: int) -> tuple[float, float]:
    """Compute the interval of a share from a count.

    Source: C. J. Clopper, E. S. Pearson, Biometrika 26, 1934, 404.
    """
    tail = (1 - CONFIDENCE) / 2
    low = 0.0
    high = 1.0

    if count:
        low, _ = bisect(
            lambda p: 1 - math.fsum(_probabilities(count - 1, total, p)) < tail,
            0.0,
            1.0,
            halvings=60,
        )
    if count < total:
        high, _ = bisect(
            lambda p: math.fsum(_probabilities(count, total, p)) > tail, 0.0, 1.0, halvings=60
        )

    return low, high


def quantile_ranks(total: int, fraction: float) -> tuple[int, int]:
    """Compute the ranks, from 0, of the sorted values between which a quantile lies.

    They hold for any distribution. A rank of -1 or `total` means that there are too few values for
    a bound on that side.
    """
    tail = (1 - CONFIDENCE) / 2
    below = list(itertools.accumulate(_probabilities(total, total, fraction)))
    return sum(p <= tail for p in below) - 1, sum(p < 1 - tail for p in below)


def _probabilities(count: int, total: int, share: float) -> Iterator[float]:
    """Yield the probabilities that 0 to `count` of `total` independent events happen."""
    if not 0.0 < share < 1.0:
        yield float(count >= (total if share >= 1.0 else 0))
        return

    odds = math.log(share), math.log1p(-share)
    for k in range(count + 1):
        ways = math.lgamma(total + 1) - math.lgamma(k + 1) - math.lgamma(total - k + 1)
        yield math.exp(ways + k * odds[0] + (total - k) * odds[1])
