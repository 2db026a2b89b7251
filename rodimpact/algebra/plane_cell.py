"""A cell in the plane of two numbers: points where a collision goes as in a run.

An atlas asks for many points of the plane at once, in floats.
"""

from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .conditions import cell_conditions
from .exact_run import ExactRun
from .signatures import signature
from .symbolic_row import SymbolicRow
from .traced_fraction import Program

Floats = NDArray[np.float64]
CUTS_PER_ROUND = 64
"""Parts into which a segment of the plane is cut in the search for a border."""
CUT_ROUNDS = 8
"""Rounds in which the part with the border is cut again: 64^-8 is below round-off."""


class PlaneCell:
    """Results of a run, and the conditions under which its formulas hold elsewhere.

    Parameters
    ----------
    row : SymbolicRow
    run : ExactRun
    values : dict of str to Fraction
        Values of the names in the run.
    axes : sequence of str
        Names of the two numbers of the plane.

    Attributes
    ----------
    results : Exact
        Results as traced fractions.
    """

    def __init__(
        self,
        row: SymbolicRow,
        run: ExactRun,
        values: Mapping[str, Fraction],
        axes: Sequence[str],
    ) -> None:
        """Take the conditions from the run, and prepare to evaluate them in floats.

        The run is continued beyond its proof; FormulaTooLong if it is too long.
        """
        self.results = run.results
        self._wave_speeds = row.wave_speeds
        self._axes = axes
        self._fixed_values = {name: float(value) for name, value in values.items()}
        self._conditions = cell_conditions(run, in_order=False)
        self._program = Program(self._conditions, float)

    def signature(self) -> tuple[Any, ...]:
        """Key that is equal for cells with the same formulas and numbers of episodes.

        Formulas of contact times are not compared.
        """
        return signature(self.results, self._fixed_values, with_times=False)

    def inside(self, x: Floats, y: Floats) -> Any:
        """Whether each point (x, y) lies in the cell: all its conditions hold there."""
        return self._hold(self._program, x, y).all(axis=0)

    def share_inside(self, x: Floats, y: Floats, dx: Floats, dy: Floats) -> Floats:
        """Share of each segment from (x, y) to (x + dx, y + dy) that lies in the cell.

        All arguments are [segment] arrays, and so is the result, with values from 0 to
        1. Each segment must begin inside. It is cut into parts; the first part whose
        end is outside is cut again.
        """
        # Only conditions that some segment breaks at its end have borders on the way.
        holds_at_ends = self._hold(self._program, x + dx, y + dy).all(axis=1)
        broken = [self._conditions[i] for i in np.flatnonzero(~holds_at_ends)]
        program = Program(broken, float)
        # From here on arrays are [segment, part].
        x = x[:, None]
        y = y[:, None]
        dx = dx[:, None]
        dy = dy[:, None]
        share = np.zeros(x.shape)
        for n in range(1, CUT_ROUNDS + 1):
            parts_of_segment = CUTS_PER_ROUND**n  # parts as wide as in this round
            ends = share + np.arange(1, CUTS_PER_ROUND + 1) / parts_of_segment
            holds = self._hold(program, x + dx * ends, y + dy * ends)
            inside = holds.all(axis=0)
            inside[:, -1] = False  # the last part holds the border if no other does
            # argmin finds the first False; all parts before it lie inside.
            parts_inside = inside.argmin(axis=1, keepdims=True)
            share += parts_inside / parts_of_segment
        return share[:, 0]

    def restitution(self, x: Floats, y: Floats) -> Floats:
        """Values of the formula of e at points; nan if the cell has no formula of e.

        The formula is also evaluated at points outside the cell.
        """
        e = np.nan
        if self.results.restitution is not None:
            program = Program([self.results.restitution], float)
            e = program(self._values_at(x, y))[0]
        return np.broadcast_to(e, x.shape)

    def _hold(self, program: Program, x: Floats, y: Floats) -> Any:
        """Whether the conditions of a program hold, [condition, point].

        A condition that is nan at a point, as 0/0, does not hold there; an infinite one
        holds if it is positive.
        """
        with np.errstate(all="ignore"):
            numbers = program(self._values_at(x, y))
            # A condition that does not depend on the point is a single number: x gives
            # it the shape of the points, and is then left out.
            broadcast = np.array(np.broadcast_arrays(x, *numbers))
            return broadcast[1:] > 0

    def _values_at(self, x: Floats, y: Floats) -> dict[str, Any]:
        """Values of all names at points (x, y) of the plane, arrays or numbers.

        Names on the axes have the values `x` and `y`. A wave speed is computed anew if
        its E or rho is on an axis. All other names keep the values of the run.
        """
        values: dict[str, Any] = dict(self._fixed_values)
        values.update(zip(self._axes, (x, y), strict=True))
        for name, speed in self._wave_speeds.items():
            E, rho = speed  # names, or values that have no name
            if E in self._axes or rho in self._axes:
                values[name] = np.sqrt(_value_of(E, values) / _value_of(rho, values))
        return values


def _value_of(name: str | Fraction, values: Mapping[str, Any]) -> Any:
    """Value of a number that has a name, or the number itself."""
    if isinstance(name, str):
        return values[name]
    return float(name)
