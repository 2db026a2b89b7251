"""exact(): a collision in fractions, a run of the kernel of the method "fronts"."""

from collections.abc import Iterable, Mapping
from fractions import Fraction
from operator import attrgetter
from typing import Any

from ..hints import explain_arguments
from ..methods.row import Row
from ..methods.row_builder import build_row
from ..model import Segment, System
from ..model.frozen import InvalidModel, Problems, raise_if_problems
from ..model.paths import entries_by_path, suggestion
from .checks import (
    check_arguments,
    check_final,
    check_system,
    decimal_fraction,
    fractions_of,
)
from .exact_results import Exact, map_numbers
from .exact_run import RowNumbers, WaveMaterial, read_numbers, run_exactly
from .square_roots import rational_root
from .traced_fraction import TracedFraction

MAX_EVENTS = 5_000
"""Default cap on the events of a collision."""


@explain_arguments
def exact(
    system: System,
    values: Mapping[str, Any] | None = None,
    *,
    max_events: int = MAX_EVENTS,
) -> Exact:
    """Solve a collision in fractions.

    Numbers are taken as they are written: 0.1 is one tenth. Transit times, impedances,
    velocities and gaps enter the mechanics. Wave speeds sqrt(E/rho) need not be
    rational, only their ratios: time is then measured by the first of them. With gaps
    they must be rational.

    Parameters
    ----------
    system : System
        Uniform or stepped rods, free or against walls, in rigid or bonded contact; no
        family.
    values : mapping, optional
        Fractions, whole numbers or texts such as ``"1/3"`` in place of numbers of the
        system, by their paths, such as ``bodies.0.length``; also
        ``bodies.0.transit_time``, s, and ``bodies.0.impedance``, kg/s, in place of
        lengths, areas and materials.
    max_events : int
        Cap on the events of the run.

    Returns
    -------
    Exact

    Raises
    ------
    InvalidModel
        If a number is not rational, or the system has physics that this method lacks;
        if the collision is not over after `max_events`.

    Examples
    --------
    >>> import rodimpact as ri
    >>> left = ri.Rod(0.4, area=1e-4, material=ri.materials.steel, velocity=1.0)
    >>> right = ri.Rod(1.0, area=1e-4, material=ri.materials.steel)
    >>> exact(ri.System([left, right])).restitution
    Fraction(2, 5)
    """
    check_system(system)
    check_arguments(max_events=max_events)
    row = build_row(system)
    entries = entries_by_path(system)
    value_at: dict[str, Fraction] = {}
    for path, value in fractions_of(values).items():
        # The path of a material stands for the full paths of all its segments.
        for full_path in entries.get(path, [path]):
            value_at[full_path] = value

    source = _CaseNumbers(value_at)
    numbers = read_numbers(row, source)
    _check_wave_speeds(row, source)
    problems = _unknown_paths(value_at, source.paths, entries)
    problems += _non_positive(row, numbers)
    raise_if_problems(problems)
    run = run_exactly(row, numbers, max_events)
    check_final(run.is_final, max_events)
    results = map_numbers(run.results, attrgetter("value"))
    # The unit of time is that in which a wave at the unit of speed runs 1 m.
    return results._replace(time_unit=float(source.squared_speed_unit) ** -0.5)


class _CaseNumbers:
    """Numbers as they are written in a system, or as they are given in their place.

    Attributes
    ----------
    paths : dict of str to None
        Paths that were asked for, in order.
    squared_speeds : dict of str to Fraction
        E/rho of segments whose wave speed was asked for, by path, m^2/s^2.
    """

    def __init__(self, value_at: Mapping[str, Fraction]) -> None:
        """Take the given values, by path."""
        self._value_at = value_at
        self.paths: dict[str, None] = {}
        self.squared_speeds: dict[str, Fraction] = {}

    def number(self, path: str, value: Any) -> Any:
        """Number at a path: the given one, else `value` as the system has it written.

        None for a transit time or an impedance that is not given: it follows from other
        numbers. The path is added to `paths`.
        """
        self.paths[path] = None
        if path in self._value_at:
            return TracedFraction(self._value_at[path])
        if path.endswith((".transit_time", ".impedance")):
            return None
        return TracedFraction(decimal_fraction(value))

    def material(self, path: str, segment: Segment) -> WaveMaterial:
        """Wave speed, in units of sqrt(`squared_speed_unit`), and density.

        E/rho is added to `squared_speeds`. A wave speed whose ratio to the unit is
        irrational is given as 1; `_check_wave_speeds` refuses the row afterwards.
        InvalidModel is raised unless E and rho are positive.
        """
        material: Any = segment.material
        E = self.number(f"{path}.material.youngs_modulus", material.youngs_modulus)
        rho = self.number(f"{path}.material.density", material.density)
        if E <= 0 or rho <= 0:
            raise InvalidModel([(f"{path}.material", "needs numbers above 0")])
        squared_speed = E.value / rho.value
        self.squared_speeds[path] = squared_speed  # the first of all sets the unit
        speed = rational_root(squared_speed / self.squared_speed_unit)
        if speed is None:
            speed = Fraction(1)  # stands in for it until `_check_wave_speeds` raises
        return WaveMaterial(TracedFraction(speed), rho)

    @property
    def squared_speed_unit(self) -> Fraction:
        """Square of the speed by which times are measured, m^2/s^2.

        It is that of the first rod, or 1 if that rod has a rational wave speed.
        """
        first = next(iter(self.squared_speeds.values()), Fraction(1))
        if rational_root(first):
            return Fraction(1)
        return first


def _check_wave_speeds(row: Row, source: _CaseNumbers) -> None:
    """Raise InvalidModel if an irrational wave speed would have to be rounded.

    This is the first speed whose ratio to that of the first rod is irrational. If there
    is none, it is the first rod's own irrational speed, if there are gaps or given
    transit times.
    """
    unit = source.squared_speed_unit
    is_first_irrational = unit != 1  # it is 1 if the first rod's speed is rational
    irrational = []
    for path, squared_speed in source.squared_speeds.items():
        if rational_root(squared_speed / unit) is None:
            irrational.append(path)
    # Gaps and given transit times are measured in metres and seconds. A segment whose
    # transit time and impedance are given was not asked for its wave speed.
    has_gaps = any(row.system.gaps)
    has_given_times = len(source.squared_speeds) < len(row.segments)
    if irrational:
        path = irrational[0]
        relation = ", also relative to the first rod"
    elif (has_gaps or has_given_times) and is_first_irrational:
        path = next(iter(source.squared_speeds))
        relation = ""
    else:
        return
    remedy = f"give {path}.transit_time and {path}.impedance, or take closed_form()"
    raise InvalidModel([(path, f"has an irrational wave speed{relation}; {remedy}")])


def _unknown_paths(
    value_at: Iterable[str],
    asked_paths: Mapping[str, None],
    entries: Mapping[str, list[str]],
) -> Problems:
    """Problems of given values whose paths belong to no number of the system.

    Paths are right if the run asked for their numbers; so is the path of a material
    whose first number was asked for.
    """
    parameters = dict(asked_paths)
    for path, full_paths in entries.items():
        if full_paths[0] in asked_paths:
            parameters[path] = None
    problems: Problems = []
    for path in value_at:
        if path not in parameters:
            hint = suggestion(path, parameters)
            message = f"is not a parameter of the system; {hint}"
            problems.append((path, message))
    return problems


def _non_positive(row: Row, numbers: RowNumbers) -> Problems:
    """A problem for each transit time and each impedance that is not positive.

    The path is that of the segment. The list is empty if all numbers are positive.
    """
    problems: Problems = []
    paths = row.paths[1:]  # paths of the segments; the first one lies outside the row
    for path, T in zip(paths, numbers.transit_times, strict=True):
        if T <= 0:
            problems.append((path, f"needs numbers above 0, got transit {T.value}"))
    for path, Z in zip(paths, numbers.impedances, strict=True):
        if Z <= 0:
            problems.append((path, f"needs numbers above 0, got impedance {Z.value}"))
    return problems
