"""Signatures of results: they are equal for runs with the same formula."""

from collections.abc import Iterable
from decimal import Decimal, localcontext
from fractions import Fraction
from random import Random
from typing import Any

from .exact_results import Exact, numbers_of
from .traced_fraction import Program

EVALUATED_DIGITS = 150
"""Digits with which formulas are evaluated."""
COMPARED_DECIMALS = 40
"""Decimals in which values of equal formulas agree; the rest is for round-off."""
SEED = 1867


def signature(
    results: Exact, names: Iterable[str], *, with_times: bool
) -> tuple[Any, ...]:
    """Key of a cell: numbers of episodes, then values of all formulas at random names.

    There is one number of episodes for each contact. The names have the same random
    values in every call, so that equal formulas have equal values. The formulas of
    contact times are evaluated only if `with_times`.
    """
    compared = results
    if not with_times:
        compared = results._replace(contact_times=())
    random = Random(SEED)
    with localcontext(prec=EVALUATED_DIGITS):
        point = {name: Decimal(1 + random.random()) for name in names}
        program = Program(numbers_of(compared), _decimal)
        values = [round(x, COMPARED_DECIMALS) for x in program(point)]
    episodes = map(len, results.contact_times)
    return (*episodes, *values)


def _decimal(x: Fraction) -> Decimal:
    """The fraction as a decimal, with the digits of the context."""
    return Decimal(x.numerator) / x.denominator
