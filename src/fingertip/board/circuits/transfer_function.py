"""Transfer function of a network: polynomials in s with the component values as symbols.

Cramer's rule gives each voltage as a ratio of two determinants, whose expansions are sums of
products of admittances. The network is split into stages first: groups of nets that determine each
other, such as a Sallen-Key section. Each follows from the one before it, because an amplifier
isolates its output, so their transfer functions multiply. The expansion is done once for a circuit;
evaluating it for other values, or for thousands of boards at once, takes some hundred products. On
every board all products of a coefficient are positive, so no difference of nearly equal numbers
occurs, and all coefficients are exact to rounding.
"""

from __future__ import annotations

import functools
import math
from collections import defaultdict
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from fingertip.board.circuits.network import Network, Term, Value

Polynomial = dict[tuple[int, tuple[str, ...]], float]
"""Power of s and sorted symbols of each product -> its factor."""
SymbolicPolynomial = tuple[tuple[tuple[float, tuple[str, ...]], ...], ...]
"""Coefficients of a polynomial in s, constant first, as sums of products (factor, symbols)."""
Coefficients = list[Value]
"""Coefficients of a polynomial in s, from the constant one upwards."""


@dataclass(frozen=True)
class Rational:
    numerator: Coefficients
    denominator: Coefficients

    def __mul__(self, other: Rational) -> Rational:
        return Rational(
            _convolve(self.numerator, other.numerator),
            _convolve(self.denominator, other.denominator),
        )

    def power_gain(self) -> Callable[[Value], Value]:
        """Return the squared magnitude as a function of the angular frequency [rad/s].

        With x = omega^2 a polynomial is even(x) + j omega odd(x), whose coefficients alternate in
        sign.
        """
        (top_even, top_odd), (even, odd) = (
            (_alternate(polynomial[::2]), _alternate(polynomial[1::2]))
            for polynomial in (self.numerator, self.denominator)
        )

        def power_gain(omega: Value) -> Value:
            x = omega * omega
            a = _horner(top_even, x)
            b = _horner(top_odd, x)
            c = _horner(even, x)
            d = _horner(odd, x)
            result: Value = (a * a + x * b * b) / (c * c + x * d * d)

            return result

        return power_gain


@dataclass(frozen=True)
class Stage:
    """Transfer function of one stage, with the component values as symbols."""

    numerator: SymbolicPolynomial
    denominator: SymbolicPolynomial

    def evaluate(self, values: Mapping[str, Value]) -> Rational:
        return Rational(_evaluate(self.numerator, values), _evaluate(self.denominator, values))


def find_stages(network: Network, source: str, output: str) -> tuple[Stage, ...]:
    """Find the stages between an input and a net, and expand the transfer function of each."""
    quiet = [name for name in network.inputs if name != source]
    network = network.ground(*quiet).restrict(output)
    # Of a loop, each net depends on itself.
    reach = {name: network.trace(network.contents[name]) for name in network.nets}
    # Nets that the source does not reach, such as the buffered middle of the supply, stay at 0.
    unaffected = [name for name in network.nets if source not in reach[name]]
    network = network.ground(*unaffected)
    stages = []

    while output != source:
        group = sorted(name for name in reach[output] if output in reach.get(name, ()))
        terms = [term for term in network.terms if term.equation in group]
        (feed,) = {term.net for term in terms} - set(group)
        numerator = _determinant(terms, group, [feed if name == output else name for name in group])
        denominator = _determinant(terms, group, group)
        sign = math.copysign(1.0, next(iter(denominator.values())))  # of all its products
        stages.append(Stage(_by_power(numerator, -sign), _by_power(denominator, sign)))
        output = feed

    return tuple(reversed(stages))


def multiply(stages: Iterable[Rational]) -> Rational:
    return functools.reduce(Rational.__mul__, stages)


def _determinant(terms: Sequence[Term], rows: Sequence[str], columns: Sequence[str]) -> Polynomial:
    """Expand a determinant along its rows; minors that occur again are expanded once."""
    entries: defaultdict[tuple[str, str], Polynomial] = defaultdict(lambda: defaultdict(float))
    for term in terms:
        symbols = (term.quantity,) if term.quantity else ()
        entries[term.equation, term.net][term.order, symbols] += term.factor

    @functools.cache
    def minor(row: int, remaining: tuple[int, ...]) -> Polynomial:
        if row == len(rows):
            return {(0, ()): 1.0}

        total: Polynomial = defaultdict(float)
        for position, column in enumerate(remaining):
            entry = entries.get((rows[row], columns[column]))
            if entry:
                rest = minor(row + 1, remaining[:position] + remaining[position + 1 :])
                sign = -1.0 if position % 2 else 1.0
                for (order, symbols), factor in entry.items():
                    for (rest_order, rest_symbols), rest_factor in rest.items():
                        key = (order + rest_order, tuple(sorted(symbols + rest_symbols)))
                        total[key] += sign * factor * rest_factor

        # Products of opposite signs cancel exactly.
        return {key: factor for key, factor in total.items() if factor}

    return minor(0, tuple(range(len(columns))))


def _by_power(polynomial: Polynomial, sign: float) -> SymbolicPolynomial:
    degree = max((order for order, _ in polynomial), default=0)
    return tuple(
        tuple(
            (sign * factor, symbols)
            for (order, symbols), factor in polynomial.items()
            if order == power
        )
        for power in range(degree + 1)
    )


def _evaluate(polynomial: SymbolicPolynomial, values: Mapping[str, Value]) -> Coefficients:
    coefficients: Coefficients = []
    for products in polynomial:
        total: Value = 0.0
        for product, symbols in products:
            for symbol in symbols:
                product = product * values[symbol]  # type: ignore[assignment]

            total = total + product

        coefficients.append(total)

    return coefficients


def _convolve(a: Coefficients, b: Coefficients) -> Coefficients:
    result: Coefficients = [0.0] * (len(a) + len(b) - 1)
    for i, x in enumerate(a):
        for j, y in enumerate(b):
            result[i + j] = result[i + j] + x * y

    return result


def _alternate(coefficients: Coefficients) -> Coefficients:
    return [c if i % 2 == 0 else -c for i, c in enumerate(coefficients)][::-1]


def _horner(coefficients: Coefficients, x: Any) -> Any:
    total = 0.0
    for coefficient in coefficients:
        total = total * x + coefficient

    return total
