"""Result of a fit: best values, their standard errors, and notes."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from ..hints import explain_missing
from ..model import System
from ..model.arguments import check_kind
from ..model.frozen import invalid_argument
from ..model.quantities import Floats
from ..records.signal import Signal
from ..results.notebook import Shown
from ..storage.extras import optional
from ..storage.tables import align
from ..storage.writing import PathLike, write_text
from ..units import format_si
from .measured import Measured

MODEL_ERROR = (
    "The standard errors follow from the residuals. They do not include model error: "
    "errors of the fixed parameters, the contact law, the theory and the calibration. "
    "Fit another law or theory to the same records; fit.against(other) then states how "
    "much each fitted number changes."
)
CSV_HEADER = "number,unit,value,standard error,low,high"


@explain_missing()
class Fitted(NamedTuple):
    """A number that was fitted.

    Attributes
    ----------
    name : str
        Path of the number, such as ``records.0.shift``, or its name in `vary` if it
        ties several records.
    unit : str
    value, standard_error : float
        Best value and its standard error, in `unit`.
    low, high : float
        Bounds; infinite where there are none.

    Examples
    --------
    >>> import rodimpact as ri
    >>> steel = ri.materials.steel
    >>> bar = ri.Rod(1.0, area=1e-4, material=steel)
    >>> row = ri.System([ri.Rod(0.2, area=1e-4, material=steel, velocity=10.0), bar])
    >>> record = ri.solve(row, until=2e-4).gauge(1, 0.4).signal(1e-6)
    >>> guess = ri.System([ri.Rod(0.2, area=1e-4, material=steel, velocity=5.0), bar])
    >>> found = ri.fit(guess, ri.Measured(record, (1, 0.4), shift=0.0, gain=1.0),
    ...                {"bodies.0.velocity": (1.0, 20.0)}, until=2e-4, starts=1)
    >>> number = found.fitted[0]
    >>> number.name, number.unit, round(number.value, 6)
    ('bodies.0.velocity', 'm/s', 10.0)
    """

    name: str
    unit: str
    value: float
    standard_error: float
    low: float
    high: float


@explain_missing()
class Descent(NamedTuple):
    """End of a search.

    Attributes
    ----------
    misfit : float
        Root mean square of the residuals of all records, each divided by its level.
    values : dict of str to float
        Numbers by name.
    complete : bool
        Whether the search reached a minimum; otherwise it was stopped before.

    Examples
    --------
    >>> import rodimpact as ri
    >>> steel = ri.materials.steel
    >>> bar = ri.Rod(1.0, area=1e-4, material=steel)
    >>> row = ri.System([ri.Rod(0.2, area=1e-4, material=steel, velocity=10.0), bar])
    >>> record = ri.solve(row, until=2e-4).gauge(1, 0.4).signal(1e-6)
    >>> guess = ri.System([ri.Rod(0.2, area=1e-4, material=steel, velocity=5.0), bar])
    >>> found = ri.fit(guess, ri.Measured(record, (1, 0.4), shift=0.0, gain=1.0),
    ...                {"bodies.0.velocity": (1.0, 20.0)}, until=2e-4, starts=1)
    >>> best = found.descents[0]
    >>> best.complete, round(best.values["bodies.0.velocity"], 6)
    (True, 10.0)
    """

    misfit: float
    values: dict[str, float]
    complete: bool


@explain_missing()
class Addition(NamedTuple):
    """A fit with more unknown numbers, and whether they earn their place.

    Attributes
    ----------
    name : str
        Name that was given to `fit`.
    fit : Fit
        The fit with these numbers.
    earns_its_place : bool
        Whether the numbers improve the prediction of blocks of the records that a fit
        has left out: the squares of the residuals there fall by more than the standard
        error of their fall.

    Examples
    --------
    The record has an offset, and no trend:

    >>> import numpy as np, rodimpact as ri
    >>> steel = ri.materials.steel
    >>> bar = ri.Rod(1.0, area=1e-4, material=steel)
    >>> row = ri.System([ri.Rod(0.2, area=1e-4, material=steel, velocity=10.0), bar])
    >>> strain = ri.solve(row, until=2e-4).gauge(1, 0.4).signal(1e-6)
    >>> noise = 2e-5 * np.random.default_rng(1).standard_normal(len(strain))
    >>> signal = strain.replace(values=strain.values + noise + 5e-5)
    >>> record = ri.Measured(signal, (1, 0.4), shift=0.0, gain=1.0)
    >>> additions = {"offset": {"records.0.offset": None},
    ...              "trend": {"records.0.trend": None}}
    >>> found = ri.fit(row, record, {"bodies.0.velocity": (1.0, 20.0)}, until=2e-4,
    ...                starts=1, additions=additions)
    >>> [(addition.name, addition.earns_its_place) for addition in found.additions]
    [('offset', True), ('trend', False)]
    """

    name: str
    fit: Fit
    earns_its_place: bool


@explain_missing()
@dataclass(frozen=True, eq=False)
class Fit(Shown):
    """Result of `fit`.

    Attributes
    ----------
    system : System
        The system with the best values.
    measured : tuple of Measured
    fitted : tuple of Fitted
        Every number with its standard error.
    covariance : array, shape (number, number)
        Covariance of the errors of `fitted`, in their units.
    predicted : tuple of Signal
        At the times of each record, in its unit.
    bands : tuple of array
        Standard errors of the predictions that follow from the covariance, in the unit
        of each record.
    misfits : tuple of float
        Root mean square of the residual of each record, divided by its level.
    descents : tuple of Descent
        Ends of the searches, the best first.
    notes : tuple of str
        Numbers that are not determined, lie at a bound, or depend on the start of the
        search; and records whose misfit is far above the noise before their pulse.
    additions : tuple of Addition
        Fits with more numbers, if `additions` were given.
    misfit_left_out : float
        Root mean square of the residuals of all records where every other block of the
        record is fitted and predicts the blocks between, divided by the level; nan if
        no additions were given.

    Examples
    --------
    The record is a computed one, so the fit finds the velocity of its striker:

    >>> import rodimpact as ri
    >>> steel = ri.materials.steel
    >>> bar = ri.Rod(1.0, area=1e-4, material=steel)
    >>> row = ri.System([ri.Rod(0.2, area=1e-4, material=steel, velocity=10.0), bar])
    >>> record = ri.solve(row, until=2e-4).gauge(1, 0.4).signal(1e-6)
    >>> guess = ri.System([ri.Rod(0.2, area=1e-4, material=steel, velocity=5.0), bar])
    >>> found = ri.fit(guess, ri.Measured(record, (1, 0.4), shift=0.0, gain=1.0),
    ...                {"bodies.0.velocity": (1.0, 20.0)}, until=2e-4, starts=1)
    >>> round(found.system.bodies[0].velocity, 6), found.misfits[0] < 1e-6
    (10.0, True)
    """

    system: System
    measured: tuple[Measured, ...]
    fitted: tuple[Fitted, ...]
    covariance: Floats
    predicted: tuple[Signal, ...]
    bands: tuple[Floats, ...]
    misfits: tuple[float, ...]
    descents: tuple[Descent, ...]
    notes: tuple[str, ...]
    additions: tuple[Addition, ...] = ()
    misfit_left_out: float = math.nan

    @property
    def values(self) -> dict[str, float]:
        """Best values by name."""
        return {f.name: f.value for f in self.fitted}

    @property
    def standard_errors(self) -> dict[str, float]:
        """Standard errors by name."""
        return {f.name: f.standard_error for f in self.fitted}

    @property
    def correlation(self) -> Floats:
        """Correlations of the errors, shape (number, number)."""
        return correlation_of(self.covariance)

    @property
    def table_of_additions(self) -> str:
        """Misfits without and with each addition, and which earn their place, as text.

        It is the part of the printed fit that is about `additions`.
        """
        return align(self._rows_of_additions())

    def against(self, other: Fit) -> Fit:
        """Return a copy of this fit with notes on changes under another law or theory.

        Parameters
        ----------
        other : Fit
            A fit of the same records, with another law or theory.

        Returns
        -------
        Fit
            Its `notes` compare the numbers that both fits have, in the same unit.

        Raises
        ------
        InvalidModel
            If `other` is not a Fit, or has no number in common with this fit.
        """
        check_kind("other", other, Fit, "fit(system, measured, vary, until)")
        other_values = {(f.name, f.unit): f.value for f in other.fitted}
        notes = []
        for f in self.fitted:
            if (f.name, f.unit) in other_values:
                change = other_values[f.name, f.unit] - f.value
                notes.append(_note_on_change(f, change))
        if not notes:
            raise invalid_argument(
                "other", "has no number in common with this fit; vary the same numbers"
            )
        misfits = ", ".join(f"{100 * misfit:.3g} %" for misfit in other.misfits)
        notes.append(f"Misfit of the other fit: {misfits}.")
        return replace(self, notes=(*self.notes, *notes))

    def to_dataframe(self) -> Any:
        """The fitted numbers as a pandas DataFrame, one a row (extra ``dataframe``).

        The columns are the fields of `Fitted`: name, unit, value, standard error,
        bounds.

        Examples
        --------
        >>> import rodimpact as ri
        >>> steel = ri.materials.steel
        >>> bar = ri.Rod(1.0, area=1e-4, material=steel)
        >>> row = ri.System([bar.replace(length=0.2, velocity=10.0), bar])
        >>> record = ri.solve(row, until=2e-4).gauge(1, 0.4).signal(1e-6)
        >>> guess = ri.System([bar.replace(length=0.2, velocity=5.0), bar])
        >>> found = ri.fit(guess, ri.Measured(record, (1, 0.4), shift=0.0, gain=1.0),
        ...                {"bodies.0.velocity": (1.0, 20.0)}, until=2e-4, starts=1)
        >>> found.to_dataframe()[["name", "unit"]].values.tolist()
        [['bodies.0.velocity', 'm/s']]
        """
        pandas = optional("pandas", "dataframe")
        return pandas.DataFrame(self.fitted, columns=list(Fitted._fields))

    def to_csv(self, path: PathLike, *, force: bool = False) -> None:
        """Write value, standard error and bounds of each number, in its unit.

        A header comes first. The unit of a number without a unit is "1".

        Raises
        ------
        FileExistsError
            If the file exists and `force` is false.
        """
        lines = [CSV_HEADER]
        for f in self.fitted:
            unit = f.unit
            if unit == "":
                unit = "1"
            numbers = map(repr, (f.value, f.standard_error, f.low, f.high))
            lines.append(",".join([f.name, unit, *numbers]))
        write_text(path, "\n".join([*lines, ""]), force=force)

    def __str__(self) -> str:
        """Tables of numbers, correlations, misfits and additions, then the notes.

        Correlations are left out for a single number, additions if there are none.
        """
        tables = [self._table_of_numbers()]
        if len(self.fitted) > 1:
            tables.append(self._table_of_correlations())
        tables.append(self._table_of_misfits())
        if self.additions:
            tables.append(self._rows_of_additions())
        notes = "\n".join([*self.notes, MODEL_ERROR])
        return "\n\n".join([*map(align, tables), notes])

    def _table_of_numbers(self) -> list[list[str]]:
        """Rows of value, standard error and bounds of each number, header first.

        An infinite bound is "-".
        """
        rows = [["", "value", "standard error", "from", "to"]]
        for f in self.fitted:
            row = [f.name, *_value_and_error(f)]
            for bound in (f.low, f.high):
                if math.isfinite(bound):
                    row.append(format_si(bound, f.unit, digits=4))
                else:
                    row.append("-")
            rows.append(row)
        return rows

    def _table_of_correlations(self) -> list[list[str]]:
        """Correlations below the diagonal of their matrix, by number; header first.

        The last number needs no column: each pair of numbers occurs once.
        """
        columns = len(self.fitted) - 1
        correlation = self.correlation
        rows = [["correlation", *map(str, range(1, columns + 1))]]
        for i, f in enumerate(self.fitted):
            row = [f"{i + 1} {f.name}"]
            for j in range(columns):
                text = ""
                if j < i:
                    text = f"{correlation[i, j]:.2f}"
                row.append(text)
            rows.append(row)
        return rows

    def _table_of_misfits(self) -> list[list[str]]:
        """Misfit of each record, header first."""
        rows = [["record", "misfit"]]
        for record, misfit in zip(self.measured, self.misfits, strict=True):
            rows.append([record.title, f"{100 * misfit:.3g} %"])
        return rows

    def _rows_of_additions(self) -> list[list[str]]:
        """Misfits without and with each addition, and the verdict; header first."""
        rows = [["addition", "misfit", "of blocks left out", "earns its place"]]
        rows.append(["none", *_misfits(self), ""])
        for addition in self.additions:
            answer = "no"
            if addition.earns_its_place:
                answer = "yes"
            rows.append([addition.name, *_misfits(addition.fit), answer])
        return rows


def _misfits(fit: Fit) -> list[str]:
    """Misfit of all records, and that of blocks left out, as texts."""
    misfits = (fit.descents[0].misfit, fit.misfit_left_out)
    return [f"{100 * misfit:.2f} %" for misfit in misfits]


def correlation_of(covariance: Floats) -> Floats:
    """Correlations of errors: 1 on the diagonal, else 0 for a number without error."""
    errors = np.sqrt(np.diag(covariance))
    errors[errors == 0] = np.inf
    correlation: Floats = covariance / np.outer(errors, errors)
    np.fill_diagonal(correlation, 1.0)
    return correlation


def _note_on_change(f: Fitted, change: float) -> str:
    """Sentence on the change of a number under another law or theory.

    The change is also given in standard errors, if the number has an error.
    """
    amount = format_si(change, f.unit, digits=3)
    if f.standard_error:
        ratio = abs(change) / f.standard_error
        amount += f", {ratio:.1f} standard errors"
    return f"With the other law or theory {f.name} changes by {amount}."


def _value_and_error(f: Fitted) -> list[str]:
    """Value and standard error as texts with units, both to the error's second digit.

    The value has six digits if it is 0, or if its error is 0 or not finite.
    """
    digits = 6
    if 0 < f.standard_error < math.inf and f.value:
        first_digit = math.floor(math.log10(abs(f.value)))
        first_of_error = math.floor(math.log10(abs(f.standard_error)))
        # Significant digits of the value, down to the second of the error.
        digits = first_digit - first_of_error + 2
        digits = min(max(digits, 2), 15)
    value = format_si(f.value, f.unit, digits)
    return [value, format_si(f.standard_error, f.unit, digits=2)]
