"""A cell in symbols: the formulas of a run, and polynomials that border its cell."""

from collections.abc import Collection, Mapping
from fractions import Fraction
from functools import cached_property
from typing import Any

import numpy as np

from . import rational_functions
from .conditions import cell_conditions
from .exact_results import Exact, map_numbers, numbers_of
from .exact_run import ExactRun
from .rational_functions import RationalFunctions
from .signatures import signature
from .traced_fraction import Program, TracedFraction


class FormulaCell:
    """Results of a run as rational functions, and where they hold.

    Parameters
    ----------
    algebra : RationalFunctions
    run : ExactRun
    values : dict of str to Fraction
        Values of the names in the run.
    """

    def __init__(
        self, algebra: RationalFunctions, run: ExactRun, values: Mapping[str, Fraction]
    ) -> None:
        """Find the conditions of a run, to be evaluated in symbols when asked.

        The run is continued beyond its proof; FormulaTooLong if it has too many events.
        `values` are the numbers of the symbols in this run, by name.
        """
        self._algebra = algebra
        self._results = run.results
        self._values = values
        self._conditions = cell_conditions(run, in_order=True)

    def signature(self) -> tuple[Any, ...]:
        """Values that are equal for cells with the same formulas, to be a key."""
        return signature(self._results, self._values, with_times=True)

    @cached_property
    def functions(self) -> Exact:
        """The results as rational functions; InvalidModel if they are too long."""
        functions = iter(self._algebra.functions_of(numbers_of(self._results)))
        return map_numbers(self._results, lambda _: next(functions))

    @cached_property
    def borders(self) -> list[Any]:
        """Polynomials that are positive inside the cell; where one is 0 the cell ends.

        They are the factors of its conditions, without those that others imply.
        """
        factors = self._algebra.factors(
            self._conditions, self._values, rational_functions.MAX_CONDITION_TERMS
        )
        return self._algebra.without_implied(factors)

    @cached_property
    def ties(self) -> list[Any]:
        """Borders, polynomials p, on which the numbers of the system lie: p = 0 there.

        Those that others imply are left out.
        """
        algebra = self._algebra
        base_values = algebra.base_values
        numbers = _values_of(self._conditions, base_values)
        factors = self._vanishing_factors(numbers)
        ties = [p for p in factors if algebra.value(p, base_values) == 0]
        return algebra.without_implied(ties)

    @cached_property
    def tie_normals(self) -> list[Any]:
        """Unit normals of the ties, towards the inside of the cell, [free name] arrays.

        Components are along the free names, each relative to its value. A tie whose
        slope at the numbers of the system is 0 has no normal in the list.
        """
        normals = []
        for p in self.ties:
            slope = self._algebra.slope(p)
            if slope.any():
                normals.append(slope / np.linalg.norm(slope))
        return normals

    def contains(
        self, point: Mapping[str, Fraction], open_borders: Collection[Any] = ()
    ) -> bool:
        """Whether a point lies inside the cell, or on one of the `open_borders`.

        No condition may be negative there. If a condition is 0, each of its factors
        must be positive there or be an open border.
        """
        numbers = _values_of(self._conditions, point)
        if any(x < 0 for x in numbers):
            return False
        # A condition may be 0 inside the cell, too: then its factors decide.
        for p in self._vanishing_factors(numbers):
            if self._algebra.value(p, point) <= 0 and p not in open_borders:
                return False
        return True

    def _vanishing_factors(self, numbers: list[Fraction]) -> list[Any]:
        """Factors of those conditions whose values at a point, `numbers`, are 0.

        The factors are positive in the cell.
        """
        vanishing = []
        for condition, number in zip(self._conditions, numbers, strict=True):
            if number == 0:
                vanishing.append(condition)
        return self._algebra.factors(vanishing, self._values)


def _values_of(
    numbers: list[TracedFraction], point: Mapping[str, Fraction]
) -> list[Fraction]:
    """Values of traced fractions at a point; 0 for each that divides by 0 there.

    Such a number may have a limit there, which is not computed.
    """
    try:
        return Program(numbers, Fraction)(point)
    except ZeroDivisionError:
        if len(numbers) == 1:
            return [Fraction(0)]
    # One of several divides by 0: compute each of them by itself.
    values = []
    for x in numbers:
        values += _values_of([x], point)
    return values
