"""gradient(): derivatives of the result of a collision by the numbers of its system.

The system is solved with each number a little smaller and a little larger, and the
differences are extrapolated to steps of length 0. Each side of the number has its own
derivative, since results of collisions have kinks: where two events change their order,
the derivatives on both sides differ.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from ..hints import explain_arguments, explain_missing, nearest, similar
from ..methods.groups import groups, unilateral
from ..methods.registry import METHODS, Options
from ..methods.row import Array
from ..methods.row_builder import build_row
from ..methods.run import MAX_EVENTS
from ..methods.scales import largest, smallest, velocities_of
from ..model import Absorbing, System
from ..model.frozen import InvalidModel, Problems, invalid_argument, raise_if_problems
from ..model.paths import (
    entries_by_path,
    field_at,
    numbers_of,
    suggestion,
    with_numbers,
)
from ..progress import Progress, ProgressFunction, ProgressReport, check_progress
from ..results.labels import quantity_of_column, quantity_of_parameter
from ..results.outcome import UndefinedRestitution
from ..units import multiply_unit, shown, written_unit
from .columns import ENDED
from .differences import Estimate, Sides, sides_of
from .solving import solve
from .sweeping import sweep

SMOOTH_RTOL = 1e-10
"""Tolerance of the method "characteristics".

Finer runs cost more and are hardly more accurate.
"""
FRONTS_RTOL = 2.0**-48
"""Relative round-off of a run by fronts.

It is relative to the largest velocity, impulse or duration.
"""
DURATION_ERROR_RATIO = 10.0  # error of durations over the stated error of forces
STEPS_PER_STAGE = 6  # steps on each side; each is half the previous one
MAX_STAGES = 4
"""Largest number of stages; each begins at half the smallest step of the last one."""
LARGEST_STEP = {
    "fronts": 2.0**-6,
    "characteristics": 2.0**-6,
    "finite-difference": 2.0**-3,
}
"""First and largest step over the size of the number, by method.

A method with less accurate results has longer steps.
"""
PROBING_CHANGE = 2.0**-6
"""Change over the size of a number, to find the physics of the changed systems."""
NOISE_AMPLIFICATION = 16.0
"""Error of a derivative, times the smallest step, over the error of the values."""
MAX_ERROR_OVER_NOISE = 10.0
"""Stated error over the error by noise below which no smaller steps are taken."""
SCALED_BY_MOTION = {"velocity", "strain", "value", "position"}
"""Words in the paths of numbers whose size is `_natural_size`, whatever their value."""
NUMBER_RTOL = 2.0**-52  # round-off of a number of the system


@explain_missing()
class Kink(NamedTuple):
    """One-sided derivatives by a number, where they differ or only one exists.

    Each attribute is a number, or an array of the shape of the family: nan for members
    without a kink.

    Attributes
    ----------
    below, above : float
        Derivatives on the side of smaller and of larger numbers; nan on a side that
        does not exist, such as below a gap of 0.
    jump : float
        Value of the quantity above minus its value below; 0 if it is continuous.

    Examples
    --------
    At equal lengths e = l1/l2 below and e = l2/l1 above:

    >>> import rodimpact as ri
    >>> steel = ri.materials.steel
    >>> rods = [ri.Rod(1.0, area=1e-4, material=steel, velocity=v) for v in (1.0, 0.0)]
    >>> slopes = ri.gradient(ri.System(rods), wrt=["bodies.0.length"])
    >>> kink = slopes.kinks["bodies.0.length"]
    >>> round(float(kink.below), 6), round(float(kink.above), 6)
    (1.0, -1.0)
    """

    below: Any
    above: Any
    jump: Any


@explain_missing()
@dataclass(frozen=True)
class Gradient:
    """Derivatives of a result of a collision by numbers of its system.

    ``numpy.asarray`` makes an array of them, [..., path].

    Attributes
    ----------
    of : str
        Name of the quantity.
    wrt : tuple of str
        Paths of the numbers.
    value : float or array
        The quantity itself.
    values : dict of str to float or array
        Derivative by path; nan where the derivatives on both sides differ.
    errors : dict of str to float or array
        Stated error by path: it bounds the error of the derivative, or at a kink the
        errors of the one-sided derivatives.
    one_sided : dict of str to (float or array, float or array)
        Derivatives below and above each number.
    kinks : dict of str to Kink
        Kinks by path; paths without a kink are left out.
    unit : str
        Unit of the quantity; "" if it has none.
    units : dict of str to str
        Unit of each derivative, by path.

    Examples
    --------
    >>> import rodimpact as ri
    >>> steel = ri.materials.steel
    >>> left = ri.Rod(0.4, area=1e-4, material=steel, velocity=1.0)
    >>> right = ri.Rod(1.0, area=1e-4, material=steel)
    >>> slopes = ri.gradient(ri.System([left, right]), wrt=["bodies.0.length"])
    >>> path = "bodies.0.length"  # e = l1/l2
    >>> round(float(slopes[path]), 9), slopes.units[path]
    (1.0, '1/m')
    >>> bool(slopes.errors[path] < 1e-9)
    True
    """

    of: str
    wrt: tuple[str, ...]
    value: Any
    values: Mapping[str, Any]
    errors: Mapping[str, Any]
    one_sided: Mapping[str, tuple[Any, Any]]
    kinks: Mapping[str, Kink]
    unit: str
    units: Mapping[str, str]

    def __array__(self, dtype: Any = None, copy: Any = None) -> Array:
        """The derivatives as an array, [..., path]; always a new one.

        Paths are in the order of `wrt`. The default of `dtype` is float. `copy` is
        ignored.
        """
        columns = [self.values[path] for path in self.wrt]
        if dtype is None:
            dtype = float
        return np.stack(columns, -1).astype(dtype)

    def __getitem__(self, path: str) -> Any:
        if not isinstance(path, str) or path not in self.values:
            raise KeyError(f"no derivative by {shown(path)}; {nearest(path, self.wrt)}")
        return self.values[path]

    def __str__(self) -> str:
        """The value, then a line for each derivative; for a family names and size."""
        if np.ndim(self.value) > 0:
            members = f"of {np.size(self.value)} members, by {', '.join(self.wrt)}"
            return f"derivatives of {self.of} {members}"
        value = f"{self.value:.10g} {self.unit}".rstrip()
        lines = [f"{self.of} = {value}; its derivative by"]
        for path in self.wrt:
            lines.append(f"  {path}: {self._described(path)}")
        return "\n".join(lines)

    def _described(self, path: str) -> str:
        """Derivative by the number at a path, with its unit and stated error, as text.

        The gradient is that of a single collision. At a kink the text has the
        derivatives on both sides, and the jump of the result if that is not 0.
        """
        unit = f" {self.units[path]}".rstrip()  # "" without a unit
        error = float(self.errors[path])
        if path in self.kinks:
            below, above, jump = self.kinks[path]
            text = f"{below:.8g} below, {above:.8g} above{unit}"
            if jump != 0:
                text += f", a jump by {jump:.8g} {self.unit}".rstrip()
        else:
            text = f"{self.values[path]:.8g}{unit}"
        return f"{text}, stated error {error:.1g}"


@explain_arguments
def gradient(
    system: System,
    of: str = "restitution",
    wrt: Sequence[str] = (),
    *,
    method: str = "auto",
    until: float | None = None,
    max_events: int = MAX_EVENTS,
    rtol: float | None = None,
    workers: int | None = None,
    progress: bool | ProgressFunction = True,
) -> Gradient:
    """Derivatives of a result of a collision, with stated errors.

    They are found by finite differences. The collision is solved on both sides of each
    number, at 6 to 24 steps on each side, each half the previous one. Derivatives
    follow by Richardson's extrapolation. If the derivatives on both sides differ, or if
    the quantity jumps, the number has a kink. Smaller steps are taken as long as a kink
    seems near, or as the error is larger than the accuracy of the solutions makes
    necessary. A kink at a relative distance below about 1e-7 cannot be distinguished
    from a kink at the number itself.

    Parameters
    ----------
    system : System
        A single collision or a family.
    of : str
        ``"restitution"``, ``"velocity_after.1"`` (m/s, of a body), ``"impulse.0"``
        (N s), ``"peak_force.0"`` (N) or ``"duration.0"`` (s, of a contact). A body that
        an absorbing end slows down for ever has no velocity after.
    wrt : sequence of str
        Paths of numbers as in a case file: ``"bodies.0.length"``,
        ``"contacts.0.stiffness"``, ``"materials.steel.wave_speed"``.
    method, until, max_events
        As for `sweep`. With `until`, all quantities count up to that time.
    rtol : float, optional
        Relative accuracy of the solutions: by default 1e-10 for "characteristics", and
        1e-3 for "finite-difference". "fronts" is exact to round-off and takes none.
    workers : int, optional
        Number of threads; default: the processors at hand.
    progress : bool or function
        Whether a bar may show the progress of long work. A function is called with the
        number of collisions solved so far, and None, since their total number is not
        known.

    Returns
    -------
    Gradient
        In SI units. The entries of a member are nan if it does not have the quantity,
        or if its run does not end.

    Raises
    ------
    InvalidModel
        If an argument is wrong, if the system has no such quantity or no number at a
        path, or if the method cannot solve the system.
    UndefinedRestitution
        If the quantity of a single collision is undefined.

    Notes
    -----
    The stated error is the sum of two parts. The truncation error is ten times the
    change by the last order of the extrapolation. Noise is bounded by the stated errors
    of the solutions (round-off for "fronts") times the factor by which the differences
    amplify it. The "accuracy" of a sweep holds for velocities and forces; the error of
    durations is taken to be ten times larger.

    Examples
    --------
    Rods of one section: e is the ratio of their lengths.

    >>> import rodimpact as ri
    >>> left = ri.Rod(0.4, area=1e-4, material=ri.materials.steel, velocity=1.0)
    >>> right = ri.Rod(1.0, area=1e-4, material=ri.materials.steel)
    >>> lengths = ["bodies.0.length", "bodies.1.length"]
    >>> g = ri.gradient(ri.System([left, right]), wrt=lengths)
    >>> print(g)  # doctest: +ELLIPSIS
    restitution = 0.4; its derivative by
      bodies.0.length: 1 1/m, stated error ...
      bodies.1.length: -0.4 1/m, stated error ...
    """
    options = Options(until=until, method=method, max_events=max_events, rtol=rtol)
    options.method_for(system)  # raises if no method can solve it
    _check_arguments(system, of, wrt, until, progress)
    numbers = []
    for path in wrt:
        numbers.append(_number(system, path))
    options = _common_options(options, system, numbers)
    with Progress(progress, "gradient", "collisions") as report:
        result = _Result(of, options, workers, report)
        estimate = result.of_members(system)
        is_single = system.shape == ()
        if is_single and math.isnan(estimate.value):
            raise UndefinedRestitution(_why_undefined(system, of, options))
        columns = []
        for number in numbers:
            sides = _extrapolated(number, result, estimate)
            column = _column(sides, np.isfinite(estimate.value))
            columns.append(column)
    return _gradient(system, of, tuple(wrt), estimate.value, columns)


def _common_options(
    options: Options, system: System, numbers: Sequence["_Number"]
) -> Options:
    """Options with one method that can solve the system and all its neighbours.

    A neighbour is the system with one of the numbers a little larger. It may have more
    physics, such as a gravity that is not 0, and need another method. If the method is
    "characteristics" and no rtol is given, the rtol is `SMOOTH_RTOL`.
    """
    methods = [options.method_for(system)]
    for number in numbers:
        # A list of one change: a family with one index more in front
        neighbours = number.neighbours([number.size * PROBING_CHANGE])
        methods.append(options.method_for(neighbours.system))
    by_physics = list(METHODS)  # methods that can solve more systems come later
    most_able = max(methods, key=by_physics.index)
    if most_able == "characteristics" and options.rtol is None:
        options = replace(options, rtol=SMOOTH_RTOL)
    return replace(options, method=most_able)


def _why_undefined(system: System, of: str, options: Options) -> str:
    """Reason why the result `of` of a single collision is undefined, as a sentence.

    The collision is solved again. The reason is that of an undefined restitution, or
    else why the run ended.
    """
    solution = solve(
        system,
        until=options.until,
        method=options.method,
        max_events=options.max_events,
        rtol=options.rtol,
    )
    if of == "restitution":
        reason = solution.outcome.why_no_restitution()
        if reason:
            return reason
    return f"{of} is undefined: {solution.status}"


class _Result:
    """A result of a collision as a function of its system.

    Parameters
    ----------
    of : str
        Name of the result that is differentiated.
    options : Options
    workers : int or None
    report : function
        Called with the number of collisions solved so far.
    """

    def __init__(
        self, of: str, options: Options, workers: int | None, report: ProgressReport
    ) -> None:
        """Store the arguments; no collision has been solved yet."""
        self.of = of
        self.options = options
        self._workers = workers
        self._report = report
        self._solved = 0  # collisions so far, for `report`

    def of_members(self, system: System) -> Estimate:
        """Values of the result and their stated errors, of the family's shape.

        Every member is solved and counted for the report. The value is nan where a run
        did not reach its end, where the method refuses a member, and where the result
        is undefined. The errors are absolute, in the unit of the result.
        """
        options = self.options
        is_exact = options.method == "fronts"
        also = ["accuracy"]  # stated error of each member, which "fronts" does not need
        if is_exact:
            also = []
        swept = sweep(
            system,
            options.method,
            until=options.until,
            max_events=options.max_events,
            rtol=options.rtol,
            also=also,
            workers=self._workers,
            # None: the total number of collisions is not known.
            progress=lambda done, _: self._report(self._solved + done, None),
        )
        self._solved += math.prod(system.shape)
        columns = swept.columns
        ended = np.isin(columns["status"], ENDED)
        value = np.where(ended, columns[self.of], math.nan)
        accuracy = FRONTS_RTOL  # relative error
        if not is_exact:
            accuracy = columns["accuracy"]
        return Estimate(value, accuracy * self._size(system, columns))

    def _size(self, system: System, columns: Mapping[str, Any]) -> Any:
        """Size to which the stated error of the result is relative, of each member.

        The size has the unit of the result. For a velocity it is the velocity scale of
        the row; for an impulse or a peak force the largest one of all contacts that can
        open; for a duration ten times the largest one, since durations are less
        accurate; for the restitution see `_size_of_restitution`. `columns` are those of
        a sweep.
        """
        kind, _, _ = self.of.partition(".")  # "impulse" of "impulse.0"
        if kind == "velocity_after":
            return velocity_scale(system)
        if kind == "restitution":
            (k,) = unilateral(system)  # exactly one contact can open
            return self._size_of_restitution(system, columns, k)
        sizes = []
        for k in unilateral(system):
            sizes.append(np.abs(columns[f"{kind}.{k}"]))
        size = largest(sizes)
        if kind == "duration":
            size = size * DURATION_ERROR_RATIO
        return size

    def _size_of_restitution(
        self, system: System, columns: Mapping[str, Any], k: int
    ) -> Any:
        """Size of the error of e at contact k, of each member: 2 V/closing + abs(e).

        V is the velocity scale of the row and e = parting/closing. The stated relative
        error, times V, bounds the error of each of the two velocities after, whose
        difference is the parting velocity. The closing velocity is parting/e; it is
        taken as V where e = 0.
        """
        e = columns["restitution"]
        left_velocity = columns[f"velocity_after.{k}"]
        right_velocity = columns[f"velocity_after.{k + 1}"]
        parting = right_velocity - left_velocity
        with np.errstate(divide="ignore", invalid="ignore"):
            scale_over_closing = velocity_scale(system) * e / parting  # V/(parting/e)
        scale_over_closing = np.where(e == 0, 1.0, scale_over_closing)
        return 2 * np.abs(scale_over_closing) + np.abs(e)


def velocity_scale(system: System) -> Any:
    """Velocity to which stated errors of velocities are relative, m/s, of each member.

    It is the velocity scale of the row; without rods it is the largest difference of
    the velocities before the collision.
    """
    row = build_row(system)
    if len(row.segments) > 0:  # only rods have segments
        return row.scale
    velocities = velocities_of(row)
    return largest(velocities) - smallest(velocities)


class _Neighbours(NamedTuple):
    """Copies of a system in which one number is changed, one for each change."""

    system: System  # a family, [change, ...]
    allowed: Any  # [change, ...]; where it is False, the number is not changed


class _Number(NamedTuple):
    """A number of a system, or of each member of a family."""

    system: System
    entries: list[str]  # all paths at which the system has this same number
    x: Any  # its value: a number, or an array that broadcasts to the family's shape
    size: Any  # size to which its changes are relative, > 0; shaped as `x`, or a number

    def neighbours(self, changes: Any) -> "_Neighbours":
        """Copies of the system with the number plus each of the changes.

        `changes` has the shape [change, ...]. A change is not allowed if the
        declaration of the number or the system refuses it; then the number keeps its
        value, and `allowed` is False. A change that the system refuses for one member
        is not allowed for any.
        """
        field = field_at(self.system, self.entries[0])  # declaration: unit, sign
        changes = np.asarray(changes)
        allowed = np.asarray(field.holds(self.x + changes))
        allowed_changes = np.where(allowed, changes, 0.0)
        try:
            return _Neighbours(self._changed(allowed_changes), allowed)
        except InvalidModel:
            # The system refuses some change, such as a number that must stay less than
            # another one. Each change is tried alone, for all members, to find which.
            for k in range(len(changes)):
                if not self._can_change(allowed_changes[k]):
                    allowed[k] = False
            allowed_changes = np.where(allowed, changes, 0.0)
            return _Neighbours(self._changed(allowed_changes), allowed)

    def _can_change(self, change: Any) -> bool:
        """Whether the system accepts the number plus a change."""
        try:
            self._changed(change)
        except InvalidModel:
            return False
        return True

    def _changed(self, change: Any) -> System:
        """A copy of the system with the number plus a change, at all its paths.

        The result is a family if the change is an array. InvalidModel is raised if the
        system refuses the changed number.
        """
        value = self.x + change
        if np.ndim(value) == 0:  # a scalar of NumPy becomes a float of Python
            value = float(value)
        return with_numbers(self.system, dict.fromkeys(self.entries, value))

    def members(self, chosen: Any) -> "_Number":
        """The same number in the members of the family for which `chosen` is true.

        The shape of the smaller family is (number of chosen members,). For a single
        collision the number itself is returned, whether it is chosen or not.
        """
        if self.system.shape == ():
            return self
        x = np.broadcast_to(self.x, self.system.shape)
        size = np.broadcast_to(self.size, self.system.shape)
        return _Number(self.system[chosen], self.entries, x[chosen], size[chosen])


def _number(system: System, path: str) -> _Number:
    """The number at a path, with the size to which its changes are relative.

    The size is the absolute value of the number. It is `_natural_size` instead if the
    number is 0, if its path has a word of `SCALED_BY_MOTION`, or if it is a gap larger
    than that. InvalidModel if the natural size is needed, but is 0 or nan.
    """
    entries = entries_by_path(system)[path]  # all paths at which the system has it
    entry = entries[0]  # any of them: the number is the same at all
    x = numbers_of(system)[entry]
    natural = _natural_size(system, entry)
    is_zero = np.equal(x, 0)
    words = entry.split(".")
    is_scaled_by_motion = not SCALED_BY_MOTION.isdisjoint(words)
    if is_scaled_by_motion:
        size = natural
    elif words[-1] == "gap":
        size = np.where(is_zero, natural, np.minimum(x, natural))
    else:
        size = np.where(is_zero, natural, np.abs(x))
    if not np.all(np.greater(size, 0)):  # 0 or nan
        message = (
            f"{path} is 0, and nothing else gives it a scale; give it a small value"
        )
        raise invalid_argument("wrt", message)
    return _Number(system, entries, x, size)


def _natural_size(system: System, path: str) -> Any:
    """Size of a quantity of the unit of the number at a path, of each member.

    It follows from the scales of the row: the velocity scale V, the longest transit
    time T, the largest wave speed c, the largest impedance Z and the largest modulus E.
    A velocity has the size V, a pure number 1, a gap V T, a strain V/c, a force Z V. A
    unit without a size in the list below gives nan. A row without rods has only V: all
    units but those of a velocity and a pure number give nan.
    """
    row = build_row(system)
    V = velocity_scale(system)
    unit = quantity_of_parameter(system, path).unit
    if unit == "m/s":
        return V
    if unit == "1":  # a pure number
        return 1.0
    if len(row.segments) == 0:
        return math.nan
    T = _largest_of(row.segments, "transit_time")
    c = _largest_of(row.segments, "wave_speed")
    Z = _largest_of(row.segments, "impedance")
    E = largest([segment.material.youngs_modulus for segment in row.segments])
    sizes = {
        "": V / c,  # a strain has the unit "", a pure number "1"
        "m": V * T,
        "m/s^2": V / T,
        "N": Z * V,
        "N/m": Z / T,
        "N s/m": Z,
        "s/m": 1 / V,
        "Pa s": E * T,
    }
    return sizes.get(unit, math.nan)


def _largest_of(segments: Sequence[Any], name: str) -> Any:
    """Largest value of an attribute of segments, by its name; of each member."""
    return largest([getattr(segment, name) for segment in segments])


def _extrapolated(number: _Number, result: _Result, estimate: Estimate) -> Sides:
    """One-sided derivatives and limits of a result, by a number, of each member.

    They are found in up to `MAX_STAGES` stages of `STEPS_PER_STAGE` ever smaller steps.
    `estimate` is the result at the number itself, with its error. Stages after the
    first solve only the members that `_unsettled` chooses. A member whose result is nan
    has nan, with the error inf.
    """
    shape = number.system.shape
    size = np.broadcast_to(number.size, shape)
    noise = np.broadcast_to(estimate.error, shape)
    first_step = LARGEST_STEP[result.options.method]  # over the size
    # Steps and values of all stages so far, [step, ...]; the value of a member that a
    # stage did not solve is nan.
    steps = np.zeros((0, *shape))
    below = np.zeros((0, *shape))
    above = np.zeros((0, *shape))
    chosen = np.isfinite(estimate.value)  # members that are solved in the next stage
    for stage in range(MAX_STAGES):
        halvings = STEPS_PER_STAGE * stage + np.arange(STEPS_PER_STAGE)
        relative_steps = first_step * 2.0**-halvings
        stage_steps = np.multiply.outer(relative_steps, size)  # [step, ...]
        stage_below = np.full(stage_steps.shape, math.nan)
        stage_above = np.full(stage_steps.shape, math.nan)
        if chosen.any():
            # [step, chosen member]; a single collision, `chosen` of shape (), is one.
            chosen_steps = stage_steps[:, chosen]
            values = _values_beside(number.members(chosen), result, chosen_steps)
            stage_below[:, chosen] = values.below
            stage_above[:, chosen] = values.above
        steps = np.concatenate([steps, stage_steps])
        below = np.concatenate([below, stage_below])
        above = np.concatenate([above, stage_above])
        # The number plus a step is rounded. This round-off changes the result, too: by
        # the slope of the result times the round-off.
        rise_above = np.abs(above - estimate.value)
        rise_below = np.abs(below - estimate.value)
        slopes = np.fmax(rise_above, rise_below) / steps  # of the steeper side
        largest_slope = np.fmax.reduce(slopes, axis=0, initial=0.0)  # leaves out nan
        rounding = NUMBER_RTOL * np.abs(number.x) * largest_slope
        at_point = sides_of(below, above, steps, noise + rounding)
        next_step = steps[-1] / 2  # the next stage begins with it
        chosen = _unsettled(at_point, estimate, noise + rounding, next_step)
        if not chosen.any():
            break
    return at_point


class _ValuesBeside(NamedTuple):
    """Values of a result beside a number, [step, member]; nan where there is none."""

    below: Array  # at the number minus each step
    above: Array  # at the number plus each step


def _values_beside(number: _Number, result: _Result, steps: Array) -> _ValuesBeside:
    """Values of a result with the number minus and plus each step, [step, member].

    A value is nan if the changed number is not allowed, or if the result does not
    exist. `steps` has the shape [step, member]; a single collision is one member.
    """
    changes = np.concatenate([-steps, steps])  # first below, then above
    neighbours = number.neighbours(changes)
    results = result.of_members(neighbours.system)
    values = np.where(neighbours.allowed, results.value, math.nan)
    count = len(steps)
    return _ValuesBeside(below=values[:count], above=values[count:])


def _unsettled(sides: Sides, estimate: Estimate, noise: Any, next_step: Any) -> Any:
    """Whether each member needs smaller steps: an array of truth values.

    A member needs them if its derivatives on both sides differ by more than their
    errors, and by more than the error by noise at the next steps; if its values jump;
    or if the error of its derivative is much larger than the error by noise. A member
    whose result is nan never needs them. `noise` is the bound of the error of values,
    and `next_step` the largest of the next steps.
    """
    # Error by noise of a derivative from the next steps
    from_noise = NOISE_AMPLIFICATION * noise / next_step
    bend = np.abs(sides.bend.value)  # difference of the derivatives on both sides
    bent = bend > sides.bend.error
    # The bend is the difference of two derivatives, each with the error `from_noise`.
    bend_can_be_told = bend > 2 * from_noise
    jumps = np.abs(sides.jump.value) > sides.jump.error
    inaccurate = sides.central.error > MAX_ERROR_OVER_NOISE * from_noise
    unsettled = (bent & bend_can_be_told) | jumps | inaccurate
    return unsettled & np.isfinite(estimate.value)


class _Column(NamedTuple):
    """Derivatives by one number; each is a number or an array of the family's shape."""

    value: Any  # derivative; nan at a kink
    error: Any  # stated error of the derivative, or at a kink of the one-sided ones
    below: Any  # derivative on the side of smaller numbers
    above: Any  # derivative on the side of larger numbers
    jump: Any  # value of the result above minus that below
    kinked: Any  # whether there is a kink, see `Kink`


def _column(sides: Sides, defined: Any) -> _Column:
    """Derivatives by one number, with kinks where the two sides do not agree.

    Where the sides agree, all derivatives are the central derivative or the mean of the
    one-sided ones, whichever has the smaller error. Elsewhere `value` is nan, and
    `error` the largest error of the sides that exist; nan if no side exists. `defined`
    tells for each member whether the result itself is a number.
    """
    smooth = sides.smooth & defined
    mean = (sides.below.value + sides.above.value) / 2
    mean_error = (sides.below.error + sides.above.error) / 2
    take_central = sides.central.error <= mean_error
    value = np.where(take_central, sides.central.value, mean)
    error = np.where(take_central, sides.central.error, mean_error)
    # A side exists if its derivative was found: its error is then finite.
    exists_below = np.isfinite(sides.below.error)
    exists_above = np.isfinite(sides.above.error)
    exists = exists_below | exists_above
    error_below = np.where(exists_below, sides.below.error, 0.0)
    error_above = np.where(exists_above, sides.above.error, 0.0)
    error_at_kink = np.maximum(error_below, error_above)
    error_at_kink = np.where(exists, error_at_kink, math.nan)
    jumps = np.abs(sides.jump.value) > sides.jump.error
    jump = np.where(jumps, sides.jump.value, 0.0)
    column = _Column(
        value=np.where(smooth, value, math.nan),
        error=np.where(smooth, error, error_at_kink),
        below=np.where(smooth, value, sides.below.value),
        above=np.where(smooth, value, sides.above.value),
        jump=jump,
        kinked=exists & ~smooth & defined,
    )
    entries = []
    for entry in column:
        # [()] makes a number of an array of shape ().
        entries.append(np.asarray(entry)[()])
    return _Column(*entries)


def lasting_bodies(system: System) -> set[int]:
    """Indices of the bodies that have a velocity after the collision.

    A body at an absorbing end is slowed down for ever and has none. The same holds for
    all bodies that are bonded or joined to it.
    """
    last = len(system.bodies) - 1  # the right end is that of the last body
    radiating = set()  # bodies with an absorbing end
    for body, end in zip((0, last), system.ends, strict=True):  # left end, right end
        if isinstance(end, Absorbing):
            radiating.add(body)
    lasting: set[int] = set()
    for group in groups(system):  # indices of bodies that are bonded or joined
        if radiating.isdisjoint(group):
            lasting.update(group)
    return lasting


def _check_arguments(
    system: System, of: Any, wrt: Any, until: float | None, progress: Any
) -> None:
    """Raise InvalidModel with the mistakes of these arguments of `gradient`.

    `of` must be a result of the system: the velocity of a body that has a velocity
    afterwards, a total of a contact that can open, or the restitution if exactly one
    contact can open and both of its bodies have a velocity afterwards. `wrt` must be a
    list of one or more paths of numbers.
    """
    problems: Problems = []
    check_progress(problems, progress)
    # Bodies that have a velocity at the end: all if the run ends at a given time
    bodies = set(range(len(system.bodies)))
    if until is None:
        bodies = lasting_bodies(system)
    contacts = unilateral(system)
    choices = []
    for i in sorted(bodies):
        choices.append(f"velocity_after.{i}")
    for name in ("impulse", "peak_force", "duration"):
        for k in contacts:
            choices.append(f"{name}.{k}")
    if len(contacts) == 1:
        k = contacts[0]  # contact k is between the bodies k and k + 1
        both_have_velocities = {k, k + 1} <= bodies
        if both_have_velocities:
            choices.append("restitution")
    if not isinstance(of, str) or of not in choices:
        message = f"must be one of {', '.join(choices)}, got {shown(of)}"
        meant = similar(of, choices)
        if meant is not None:
            message += f"; perhaps {meant!r} is meant"
        problems.append(("of", message))
    if not _is_list_of_text(wrt):
        message = (
            f"must be a list of paths, such as ['bodies.0.length'], got {shown(wrt)}"
        )
        problems.append(("wrt", message))
        wrt = ()  # the paths are not checked
    paths = entries_by_path(system)
    for path in wrt:
        if path not in paths:
            remedy = suggestion(path, paths)
            message = f"the system has no parameter {shown(path)}; {remedy}"
            problems.append(("wrt", message))
    raise_if_problems(problems)


def _is_list_of_text(value: Any) -> bool:
    """Whether a value is a list or tuple of one or more strings."""
    if not isinstance(value, list | tuple) or len(value) == 0:
        return False
    return all(isinstance(item, str) for item in value)


def _gradient(
    system: System, of: str, wrt: tuple[str, ...], value: Any, columns: list[_Column]
) -> Gradient:
    """The `Gradient`, from the value of the result `of` and a column for each path.

    The units are found here. `kinks` has only the paths at which some member has a
    kink; members without a kink have nan there. For a single collision, values are
    numbers instead of arrays.
    """
    unit = quantity_of_column(system, of).unit
    values = {}
    errors = {}
    one_sided = {}
    kinks = {}
    units = {}
    for path, column in zip(wrt, columns, strict=True):
        values[path] = column.value
        errors[path] = column.error
        one_sided[path] = (column.below, column.above)
        units[path] = _per(unit, quantity_of_parameter(system, path).unit)
        if np.any(column.kinked):
            # [()] makes a number of an array of shape ().
            kinks[path] = Kink(
                below=np.where(column.kinked, column.below, math.nan)[()],
                above=np.where(column.kinked, column.above, math.nan)[()],
                jump=np.where(column.kinked, column.jump, math.nan)[()],
            )
    if unit == "1":  # a pure number has no unit
        unit = ""
    return Gradient(
        of=of,
        wrt=wrt,
        value=np.asarray(value)[()],
        values=values,
        errors=errors,
        one_sided=one_sided,
        kinks=kinks,
        unit=unit,
        units=units,
    )


def _per(unit: str, other: str) -> str:
    """Unit of the derivative of a quantity in `unit` by one in `other`; "" for none.

    The derivative of a pure number by a quantity in N/m^1.5 has the unit m^1.5/N. If a
    power is not a number, as in N/m^p, the texts are combined instead: "1/(N/m^p)".
    """
    powers: dict[str, float] = {}  # by symbol; `multiply_unit` changes the dict
    try:
        multiply_unit(powers, unit, 1)
        multiply_unit(powers, other, -1)
    except ValueError:
        if unit == "":
            unit = "1"
        return f"{unit}/({other})"
    return written_unit(powers)
