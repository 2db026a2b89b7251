"""Result of a fit: best values, their standard errors, and notes."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from ..model import System
from ..model.arguments import of_kind
from ..model.frozen import refusal
from ..model.quantities import Floats
from ..records.signal import Signal
from ..results.notebook import Shown
from ..storage.tables import align
from ..storage.writing import PathLike, write_text
from ..units import format_si
from .measured import Measured
from .parameters import share_of_range

MODEL_ERROR = (
    "The standard errors follow from the residuals. They do not include model error: errors of the "
    "fixed parameters, the contact law, the theory and the calibration. Fit another law or theory "
    "to the same records; fit.against(other) then states how much each fitted number changes."
)
LOOSE = 0.5  # of the range: a number with a larger standard error is not determined
AT_BOUND = 1e-3  # of the range: of its logarithm if it spans a factor of 10 or more
FAR_ABOVE_NOISE = 4.0  # times the noise before the pulse: a misfit of the model
LEAST_MISFIT_TOLD = 0.005  # of the level: a smaller misfit is not worth a note
PULSE_BEGINS = 0.01  # of the largest predicted value
FEWEST_NOISE_SAMPLES = 8  # before the pulse, from which noise is known
ALIKE = 0.98  # correlation from which on two numbers are hardly told apart
SAME, NONE = (
    1e-3,
    1e-9,
)  # differences of misfits that count as none: of them, of the level
APART = 0.3  # standard errors by which searches may end apart
TABLE = "number,unit,value,standard error,low,high"


class Fitted(NamedTuple):
    """A number that was fitted.

    Attributes
    ----------
    name : str
        Path of the number, such as ``records.0.shift``, or its name in `vary` if it ties several
        records.
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


class Descent(NamedTuple):
    """Where a search ended.

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
    >>> found.descents[0].complete, round(found.descents[0].values["bodies.0.velocity"], 6)
    (True, 10.0)
    """

    misfit: float
    values: dict[str, float]
    complete: bool


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
        Of `fitted`, in their units.
    predicted : tuple of Signal
        At the times of each record, in its unit.
    bands : tuple of array
        Standard errors of the predictions that follow from the covariance.
    misfits : tuple of float
        Root mean square of the residual of each record, divided by its level.
    descents : tuple of Descent
        Where the searches ended, the best first.
    notes : tuple of str
        Numbers that are not determined, lie at a bound, or depend on the start of the search; and
        records whose misfit is far above the noise before their pulse.

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

    def against(self, other: Fit) -> Fit:
        """Return this fit with a note on the change of each number under another law or theory.

        Parameters
        ----------
        other : Fit
            Of the same records, with another law or theory.

        Returns
        -------
        Fit
            Its `notes` compare the numbers that both fits have, in the same unit.

        Raises
        ------
        InvalidModel
            If `other` is not a Fit, or has no number in common with this fit.
        """
        of_kind("other", other, Fit, "fit(system, measured, vary, until)")
        theirs = {(f.name, f.unit): f.value for f in other.fitted}
        notes = []
        for f in self.fitted:
            if (f.name, f.unit) in theirs:
                moved = theirs[f.name, f.unit] - f.value
                often = f", {abs(moved) / f.standard_error:.1f} standard errors"
                notes.append(
                    f"With the other law or theory {f.name} changes by "
                    f"{format_si(moved, f.unit, 3)}{often if f.standard_error else ''}."
                )
        if not notes:
            raise refusal(
                "other", "has no number in common with this fit; vary the same numbers"
            )
        misfits = ", ".join(f"{100 * misfit:.3g} %" for misfit in other.misfits)
        return replace(
            self, notes=(*self.notes, *notes, f"Misfit of the other fit: {misfits}.")
        )

    def to_csv(self, path: PathLike, *, force: bool = False) -> None:
        """Write a row for each number: its value, standard error and bounds, in its unit.

        Raises
        ------
        FileExistsError
            If the file exists and `force` is false.
        """
        rows = [
            ",".join([f.name, f.unit or "1", *map(repr, f[2:])]) for f in self.fitted
        ]
        write_text(path, "\n".join([TABLE, *rows, ""]), force=force)

    def __str__(self) -> str:
        names, last = [f.name for f in self.fitted], len(self.fitted) - 1
        numbers = [["", "value", "standard error", "from", "to"]]
        numbers += [
            [
                f.name,
                *_with_error(f),
                *(
                    format_si(end, f.unit, 4) if math.isfinite(end) else "-"
                    for end in (f.low, f.high)
                ),
            ]
            for f in self.fitted
        ]
        matrix = [["correlation", *map(str, range(1, last + 1))]]
        matrix += [
            [
                f"{i + 1} {name}",
                *(f"{c:.2f}" for c in self.correlation[i, :i]),
                *[""] * (last - i),
            ]
            for i, name in enumerate(names)
        ]
        misfits = [["record", "misfit"]]
        misfits += [
            [m.title, f"{100 * misfit:.3g} %"]
            for m, misfit in zip(self.measured, self.misfits, strict=True)
        ]
        tables = [numbers, *([matrix] if last else []), misfits]
        return "\n\n".join([*map(align, tables), "\n".join([*self.notes, MODEL_ERROR])])


def doubts(
    fitted: Sequence[Fitted], relative: Floats, descents: Sequence[Descent]
) -> Iterator[str]:
    """Notes on the parameters; `relative` is their covariance relative to their ranges."""
    errors = np.sqrt(np.diag(relative))
    open_ones = errors > LOOSE
    for f, is_open in zip(fitted, open_ones, strict=True):
        if is_open:
            yield (
                f"{f.name} is not determined: its standard error is as large as its range. "
                "Fix this parameter, or add a record that depends on it."
            )
        if not f.high - f.low < np.inf:
            continue
        share = share_of_range(f.value, f.low, f.high)
        for end, distance, remedy in (
            (f.low, share, "lower"),
            (f.high, 1.0 - share, "raise"),
        ):
            if distance <= AT_BOUND:
                yield (
                    f"{f.name} is at its bound, {format_si(end, f.unit)}, so its "
                    f"standard error is not reliable: {remedy} the bound, or fix the parameter."
                )
    correlation = correlation_of(relative)
    for i, j in np.argwhere(np.triu(np.abs(correlation) > ALIKE, 1)):
        if not (open_ones[i] or open_ones[j]):
            yield (
                f"{fitted[i].name} and {fitted[j].name} are hardly distinguishable: the "
                f"correlation of their errors is {correlation[i, j]:.3f}. Fix one of them."
            )
    best, *others = descents
    if not best.complete:
        yield "The best search was stopped before it reached a minimum."
    worse = [d.misfit for d in others if d.misfit > (1 + SAME) * best.misfit + NONE]
    if worse:
        yield (
            f"{len(worse)} of {len(descents)} searches ended at larger misfits, "
            f"{100 * min(worse):.3g} % and more: there are several minima. Use more starts or "
            "narrower bounds to test whether this minimum is the best."
        )
    for f in fitted:
        same = [
            d.values[f.name] for d in descents if d.misfit <= (1 + SAME) * best.misfit
        ]
        if np.ptp(same) > APART * f.standard_error:
            ends = f"{format_si(min(same), f.unit)} to {format_si(max(same), f.unit)}"
            yield f"Searches with the same misfit ended at different values of {f.name}: {ends}."


def misfit_notes(
    measured: Sequence[Measured],
    predicted: Sequence[Signal],
    misfits: Sequence[float],
) -> Iterator[str]:
    """Notes on records that the model does not describe to within their noise."""
    for record, prediction, misfit in zip(measured, predicted, misfits, strict=True):
        noise = noise_before_pulse(record, prediction)
        if misfit > max(FAR_ABOVE_NOISE * noise, LEAST_MISFIT_TOLD):
            yield (
                f"{record.title}: the misfit, {100 * misfit:.2g} %, is far above the noise "
                f"before the pulse, {100 * noise:.2g} %. The model does not describe this record: "
                "try another contact law or theory, vary more numbers, or free the blur."
            )


def noise_before_pulse(record: Measured, prediction: Signal) -> float:
    """Noise of a record over its level: nan if its pulse begins with the record.

    The prediction tells where the pulse begins. Samples of the second half before it are left out,
    since the measured pulse may begin a little earlier.
    """
    values = np.abs(prediction.values)
    begin = int(np.argmax(values > PULSE_BEGINS * values.max()))
    before = record.signal.values[: begin // 2]
    if len(before) < FEWEST_NOISE_SAMPLES:
        return math.nan
    return float(np.std(before)) / record.size


def correlation_of(covariance: Floats) -> Floats:
    """Correlations; 0 of what has no error."""
    errors = np.sqrt(np.diag(covariance))
    errors[errors == 0] = np.inf
    correlation: Floats = covariance / np.outer(errors, errors)
    np.fill_diagonal(correlation, 1.0)
    return correlation


def _with_error(f: Fitted) -> list[str]:
    """Value and standard error, both to the second digit of the error."""
    digits = 6
    if 0 < f.standard_error < math.inf and f.value:
        first, last = (
            math.floor(math.log10(abs(x))) for x in (f.value, f.standard_error)
        )
        digits = min(max(first - last + 2, 2), 15)
    return [format_si(f.value, f.unit, digits), format_si(f.standard_error, f.unit, 2)]
