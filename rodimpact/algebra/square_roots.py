"""Square roots of fractions: exact where they exist, otherwise rounded to many bits."""

import math
from fractions import Fraction

ROOT_BITS = 400
"""Bits of a square root that is no fraction."""


def rational_root(square: Fraction) -> Fraction | None:
    """Square root of a fraction of 0 or more, if it is a fraction itself, else None."""
    # A fraction in lowest terms has a rational root only if its numerator and its
    # denominator are both squares.
    p = math.isqrt(square.numerator)
    q = math.isqrt(square.denominator)
    if Fraction(p * p, q * q) == square:
        return Fraction(p, q)
    return None


class SquareRoots:
    """Square roots in which rational ratios are kept.

    If the ratio of a number to an earlier one has a rational root, the two roots have
    exactly that ratio, though both may be rounded.
    """

    def __init__(self) -> None:
        """Begin without any root."""
        self._root_of: dict[Fraction, Fraction] = {}

    def root(self, square: Fraction) -> Fraction:
        """Square root of a positive fraction, to `ROOT_BITS` bits if it is irrational.

        If the ratio of the root to an earlier root is rational, the result is this
        ratio times the earlier root. Otherwise the new root is stored for later calls.
        """
        for earlier, earlier_root in self._root_of.items():
            ratio = rational_root(square / earlier)
            if ratio:
                return ratio * earlier_root
        root = rational_root(square)
        if not root:
            root = _rounded_root(square)
        self._root_of[square] = root
        return root


def _rounded_root(square: Fraction) -> Fraction:
    """Square root of a fraction to `ROOT_BITS` bits, rounded down.

    sqrt(p/q) = isqrt(4^shift p/q)/2^shift, with the whole part isqrt of a square root.
    """
    magnitude = square.numerator.bit_length() - square.denominator.bit_length()
    shift = max(0, ROOT_BITS - magnitude)
    scaled_square = (square.numerator << 2 * shift) // square.denominator  # x 4^shift
    return Fraction(math.isqrt(scaled_square), 1 << shift)
