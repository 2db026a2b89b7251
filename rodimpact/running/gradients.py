"""gradient(): derivatives of the result of a collision by the numbers of its system.

The system is solved with each number a little smaller and a little larger, and the
differences are extrapolated to steps of length 0. Both sides are kept apart, since
results of collisions have kinks: where two events change their order, the derivative
differs on both sides.
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
STEPS_PER_STAGE = 6  # steps on each side, halved from one to the next
MAX_STAGES = 4
"""Stages, each of which begins at half the smallest step of the one before."""
LARGEST_STEP = {
    "fronts": 2.0**-6,
    "characteristics": 2.0**-6,
    "finite-difference": 2.0**-3,
}
"""Largest step over the number, by method.

The less accurate the results of a method are, the longer is the step.
"""
PROBING_CHANGE = 2.0**-6  # change over the number that shows what physics others take
NOISE_AMPLIFICATION = 16.0  # error of a derivative, times the step, over that of values
MAX_ERROR_OVER_NOISE = 10.0  # stated error over that by noise at which steps are kept
SCALED_BY_MOTION = {"velocity", "strain", "value", "position"}
"""Words in paths of numbers whose changes are measured by the row's motion alone."""
NUMBER_RTOL = 2.0**-52  # round-off of a number of the system


@explain_missing()
class Kink(NamedTuple):
    """A place where the derivative differs on both sides, or exists on one side only.

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
    """Derivatives of a result of a collision; as an array, [..., path].

    Attributes
    ----------
    of : str
        Name of the quantity.
    wrt : tuple of str
        Paths of the numbers.
    value : float or array
        The quantity itself.
    values : dict of str to float or array
        Derivative by path, where it is the same on both sides; else nan.
    errors : dict of str to float or array
        Stated error by path: it bounds the error of the derivative, or at a kink the
        errors of the one-sided derivatives.
    one_sided : dict of str to (float or array, float or array)
        Derivatives below and above each number.
    kinks : dict of str to Kink
        By the paths that have any.
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

        Paths are in the order of `wrt`. The type is float unless `dtype` tells another.
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
        """The value and a line for each derivative; of a family only names and size."""
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

        This is for a single collision. At a kink the text has the derivatives on both
        sides, and the jump of the result in its own unit if there is one.
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
    number, at 6 to 24 steps on each side that are halved from one to the next.
    Derivatives follow by Richardson's extrapolation. If they differ on both sides, or
    if the quantity jumps, the number has a kink. Steps become smaller as long as a kink
    seems near, or the error is larger than the accuracy of the solutions makes
    necessary. Kinks closer to the number than about 1e-7 of it cannot be told from a
    kink at the number.

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
        Whether a bar may show that long work goes on. A function is called with the
        number of collisions solved so far, and None: nobody knows how many there will
        be.

    Returns
    -------
    Gradient
        In SI units. A member without such a quantity, or whose run does not end, has
        nan.

    Raises
    ------
    InvalidModel
        If there is no such quantity, a path is none of the system, or the method lacks
        something.
    UndefinedRestitution
        If a single collision has no such number.

    Notes
    -----
    The stated error is the sum of two parts. The truncation error is ten times the
    change by the last order of the extrapolation. Noise is bounded by the stated errors
    of the solutions (round-off for "fronts") times the factor by which the differences
    amplify it. The "accuracy" of a sweep is about velocities and forces; durations
    count as ten times less accurate.

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
    """Options with one method by which the system and all its neighbours can be solved.

    Neighbours, with one of the numbers changed, may have more physics, such as a
    gravity that is not 0. Methods with more physics come later in `METHODS`. If none
    was given, "characteristics" gets `SMOOTH_RTOL` as rtol.
    """
    methods = [options.method_for(system)]
    for number in numbers:
        neighbours = number.neighbours([number.size * PROBING_CHANGE])
        methods.append(options.method_for(neighbours.system))
    by_physics = list(METHODS)
    most_able = max(methods, key=by_physics.index)
    if most_able == "characteristics" and options.rtol is None:
        options = replace(options, rtol=SMOOTH_RTOL)
    return replace(options, method=most_able)


def _why_undefined(system: System, of: str, options: Options) -> str:
    """Why a single collision has no result of that name, as a sentence.

    The collision is solved once more to find the reason: that of the restitution, or
    why the run ended.
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
        """Keep the arguments, and count the collisions solved from 0 on."""
        self.of = of
        self.options = options
        self._workers = workers
        self._report = report
        self._solved = 0  # collisions so far, for `report`

    def of_members(self, system: System) -> Estimate:
        """Values of the result and their stated errors, of the family's shape.

        Every member is solved, and counted for the report. The value is nan where a run
        does not end, or the method refuses a member.
        """
        options = self.options
        is_exact = options.method == "fronts"
        also = ["accuracy"]
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
            # How many more collisions follow is not known: None.
            progress=lambda done, _: self._report(self._solved + done, None),
        )
        self._solved += math.prod(system.shape)
        columns = swept.columns
        ended = np.isin(columns["status"], ENDED)
        value = np.where(ended, columns[self.of], math.nan)
        accuracy = FRONTS_RTOL  # relative
        if not is_exact:
            accuracy = columns["accuracy"]
        return Estimate(value, accuracy * self._size(system, columns))

    def _size(self, system: System, columns: Mapping[str, Any]) -> Any:
        """Size to which the stated error of the result is relative, of each member.

        It is in the unit of the result: the velocity scale of the row, the largest
        impulse or peak force of a contact, or the size of the restitution. That of
        durations, which are less accurate, is ten times the largest one. `columns` are
        those of a sweep.
        """
        kind, _, _ = self.of.partition(".")
        if kind == "velocity_after":
            return velocity_scale(system)
        if kind == "restitution":
            (k,) = unilateral(system)  # the only contact that can open
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
        """2 V/closing + e at contact k, with the velocity scale V, of each member.

        In e = parting/closing each of the two velocities after may be wrong by a
        fraction of V. The velocity of closing is parting/e; it counts as V where e = 0.
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

    It is the velocity scale of the row; without rods, the largest difference of the
    velocities before.
    """
    row = build_row(system)
    if len(row.segments) > 0:
        return row.scale
    velocities = velocities_of(row)
    return largest(velocities) - smallest(velocities)


class _Neighbours(NamedTuple):
    """Systems with a changed number, by change."""

    system: System  # a family, [change, ...]
    allowed: Any  # [change, ...], whether the change is allowed; if not, there is none


class _Number(NamedTuple):
    """A number of a system, or of each member of a family."""

    system: System
    entries: list[str]  # all paths at which the system has it
    x: Any  # its value
    size: Any  # the size by which its changes are measured, > 0

    def neighbours(self, changes: Any) -> "_Neighbours":
        """Systems with the number plus each of the changes, [change, ...].

        Changes that the declaration of the number or the system refuses are not made:
        the number stays there, and `allowed` is false. A change that the system refuses
        for one member is refused for all.
        """
        field = field_at(self.system, self.entries[0])  # the declaration
        changes = np.asarray(changes)
        allowed = np.asarray(field.holds(self.x + changes))
        allowed_changes = np.where(allowed, changes, 0.0)
        try:
            return _Neighbours(self._changed(allowed_changes), allowed)
        except InvalidModel:
            # The system refuses some change, such as a number that must be less than
            # another one: each change is tried alone, for all members.
            for k in range(len(changes)):
                if not self._can_change(allowed_changes[k]):
                    allowed[k] = False
            allowed_changes = np.where(allowed, changes, 0.0)
            return _Neighbours(self._changed(allowed_changes), allowed)

    def _can_change(self, change: Any) -> bool:
        """Whether the system with the number plus a change is a valid one."""
        try:
            self._changed(change)
        except InvalidModel:
            return False
        return True

    def _changed(self, change: Any) -> System:
        """The system with the number, wherever it stands, plus a change.

        It is a family if the change is an array. InvalidModel if the system refuses
        the changed number.
        """
        value = self.x + change
        if np.ndim(value) == 0:  # in place of a number of NumPy
            value = float(value)
        return with_numbers(self.system, dict.fromkeys(self.entries, value))

    def members(self, chosen: Any) -> "_Number":
        """The same number of the members of the family for which `chosen` is true.

        The members stand along one axis. A single collision is returned as it is,
        whether it is chosen or not.
        """
        if self.system.shape == ():
            return self
        x = np.broadcast_to(self.x, self.system.shape)
        size = np.broadcast_to(self.size, self.system.shape)
        return _Number(self.system[chosen], self.entries, x[chosen], size[chosen])


def _number(system: System, path: str) -> _Number:
    """The number at a path, with the size by which its changes are measured.

    The size of most numbers is their absolute value, that of a gap at most its
    `_natural_size`. The natural size stands for 0, and for all numbers that are
    `SCALED_BY_MOTION`. InvalidModel if a number is 0 and has no natural size.
    """
    entries = entries_by_path(system)[path]  # where the system has this number
    entry = entries[0]  # the same number as the others
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
    """Size that the row gives to the number at a path by its unit, of each member.

    Let V be the velocity scale of the row, T the longest transit time, c the largest
    wave speed, Z the largest impedance and E the largest modulus. A gap is V T, a
    strain V/c, a force Z V. A pure number is 1. It is nan for any other unit, and
    without rods for any but that of a velocity.
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
        "": V / c,  # a strain
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
    """Largest attribute of that name of segments: a number, or one for each member."""
    return largest([getattr(segment, name) for segment in segments])


def _extrapolated(number: _Number, result: _Result, estimate: Estimate) -> Sides:
    """Derivatives and values of a result on both sides of a number, of each member.

    They are found in up to `MAX_STAGES` stages of ever smaller steps. `estimate` is the
    result itself, with its error. Each stage has `STEPS_PER_STAGE` steps. A stage after
    the first solves only those members that `_unsettled` chooses. A member without a
    result has nan.
    """
    shape = number.system.shape
    size = np.broadcast_to(number.size, shape)
    noise = np.broadcast_to(estimate.error, shape)
    first_step = LARGEST_STEP[result.options.method]  # over the size
    # All stages so far, [step, ...]; values are nan where no member was solved.
    steps = np.zeros((0, *shape))
    below = np.zeros((0, *shape))
    above = np.zeros((0, *shape))
    chosen = np.isfinite(estimate.value)  # members that are solved in the next stage
    for stage in range(MAX_STAGES):
        halvings = STEPS_PER_STAGE * stage + np.arange(STEPS_PER_STAGE)
        relative_steps = first_step * 2.0**-halvings
        stage_steps = np.multiply.outer(relative_steps, size)
        stage_below = np.full(stage_steps.shape, math.nan)
        stage_above = np.full(stage_steps.shape, math.nan)
        if chosen.any():
            chosen_steps = stage_steps[:, chosen]
            values = _values_beside(number.members(chosen), result, chosen_steps)
            stage_below[:, chosen] = values.below
            stage_above[:, chosen] = values.above
        steps = np.concatenate([steps, stage_steps])
        below = np.concatenate([below, stage_below])
        above = np.concatenate([above, stage_above])
        # The number plus a step is rounded. That is an error of the result, too: its
        # slope times the round-off.
        rise_above = np.abs(above - estimate.value)
        rise_below = np.abs(below - estimate.value)
        slopes = np.fmax(rise_above, rise_below) / steps  # of the steeper side
        largest_slope = np.fmax.reduce(slopes, axis=0, initial=0.0)
        rounding = NUMBER_RTOL * np.abs(number.x) * largest_slope
        at_point = sides_of(below, above, steps, noise + rounding)
        next_step = steps[-1] / 2
        chosen = _unsettled(at_point, estimate, noise + rounding, next_step)
        if not chosen.any():
            break
    return at_point


class _ValuesBeside(NamedTuple):
    """Values of a result beside a number, [step, member]; nan where it has none."""

    below: Array
    above: Array


def _values_beside(number: _Number, result: _Result, steps: Array) -> _ValuesBeside:
    """Values of a result with the number minus and plus each step, [step, member].

    They are nan where the number may not have this value, or there is no result. A
    single collision is one member.
    """
    changes = np.concatenate([-steps, steps])
    neighbours = number.neighbours(changes)
    results = result.of_members(neighbours.system)
    values = np.where(neighbours.allowed, results.value, math.nan)
    count = len(steps)
    return _ValuesBeside(below=values[:count], above=values[count:])


def _unsettled(sides: Sides, estimate: Estimate, noise: Any, next_step: Any) -> Any:
    """Whether smaller steps may tell more of each member: an array of truth values.

    They may if the derivatives on both sides differ by more than their errors, and by
    more than noise would be at the next steps; if the values jump; or if the error is
    much larger than that noise. They never do where the result itself is no number.
    `noise` is the bound of the error of values, and `next_step` the largest of further
    steps.
    """
    # Error of a derivative by noise, if the next steps are taken
    from_noise = NOISE_AMPLIFICATION * noise / next_step
    bend = np.abs(sides.bend.value)  # difference of the derivatives on both sides
    bent = bend > sides.bend.error
    bend_can_be_told = bend > 2 * from_noise  # each of both has the error `from_noise`
    jumps = np.abs(sides.jump.value) > sides.jump.error
    inaccurate = sides.central.error > MAX_ERROR_OVER_NOISE * from_noise
    unsettled = (bent & bend_can_be_told) | jumps | inaccurate
    return unsettled & np.isfinite(estimate.value)


class _Column(NamedTuple):
    """Derivatives by one number; each is a number or an array of the family's shape."""

    value: Any  # derivative; nan at a kink
    error: Any  # stated error of the derivative, or of those on both sides
    below: Any  # derivative on the side of smaller numbers
    above: Any  # derivative on the side of larger numbers
    jump: Any  # value of the result above minus that below
    kinked: Any  # whether the derivatives on both sides differ, or one does not exist


def _column(sides: Sides, defined: Any) -> _Column:
    """Derivatives by one number: one where both sides agree, else those of both sides.

    Where they agree it is the central one or the mean of both, whichever has the
    smaller error. Elsewhere it is nan; the error is then the larger one of the sides
    that exist. `defined` tells of each member whether its result is a number.
    """
    smooth = sides.smooth & defined
    mean = (sides.below.value + sides.above.value) / 2
    mean_error = (sides.below.error + sides.above.error) / 2
    take_central = sides.central.error <= mean_error
    value = np.where(take_central, sides.central.value, mean)
    error = np.where(take_central, sides.central.error, mean_error)
    # A side exists if its derivative was found. Without any, the error is nan.
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

    A body at an absorbing end is slowed down for ever, and so are those that are bonded
    or joined to it: they have none.
    """
    last = len(system.bodies) - 1
    radiating = set()  # bodies with an absorbing end
    for body, end in zip((0, last), system.ends, strict=True):
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

    `of` must be a result that the system has: the velocity of a body that has one
    afterwards, a total of a contact that can open, or the restitution if there is one
    such contact. `wrt` must be a list of paths of numbers.
    """
    problems: Problems = []
    check_progress(problems, progress)
    bodies = set(range(len(system.bodies)))  # those that have a velocity at the end
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
        k = contacts[0]
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
        wrt = ()
    paths = entries_by_path(system)
    for path in wrt:
        if path not in paths:
            remedy = suggestion(path, paths)
            message = f"the system has no parameter {shown(path)}; {remedy}"
            problems.append(("wrt", message))
    raise_if_problems(problems)


def _is_list_of_text(value: Any) -> bool:
    """Whether a value is a list or tuple of strings, at least one."""
    if not isinstance(value, list | tuple) or len(value) == 0:
        return False
    return all(isinstance(item, str) for item in value)


def _gradient(
    system: System, of: str, wrt: tuple[str, ...], value: Any, columns: list[_Column]
) -> Gradient:
    """The result of `gradient`, from the value of `of` and a column for each path.

    Units are added. `kinks` has only paths at which some member has a kink, with nan
    for the others. In a single collision arrays become numbers.
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
    if unit == "1":
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
    """Unit of a derivative, from the units of both quantities; "" if it has none.

    It is m^1.5/N for a pure number by N/m^1.5. With a power that is no number, such as
    in N/m^p, it is the text of both units: "1/(N/m^p)".
    """
    powers: dict[str, float] = {}  # of the symbols of the unit, changed below
    try:
        multiply_unit(powers, unit, 1)
        multiply_unit(powers, other, -1)
    except ValueError:
        if unit == "":
            unit = "1"
        return f"{unit}/({other})"
    return written_unit(powers)
