"""Checks of arguments: systems with exact numbers, fractions, caps on events."""

from collections.abc import Iterator, Mapping
from fractions import Fraction
from typing import Any

import numpy as np

from ..methods.abilities import needs
from ..methods.registry import checked_count
from ..model import Bonded, Free, Rod, Steps, System, Wall
from ..model.arguments import check_kind
from ..model.frozen import InvalidModel, Problems, raise_if_problems
from ..model.quantities import is_integer
from ..progress import ProgressFunction, check_progress
from ..units import shown


def check_system(system: System) -> None:
    """Raise InvalidModel for a family, or a system with physics that is not exact."""
    check_kind("system", system, System, "System([rod, Wall()])")
    problems: Problems = []
    if system.shape:
        problems.append(
            ("system", f"has members of shape {system.shape}; take one: system[0]")
        )
    for path, refusal in _refusals(system):
        problems.append((path, f"formulas and fractions {refusal}, or solve()"))
    raise_if_problems(problems)


def _refusals(system: System) -> Iterator[tuple[str, str]]:
    """Path, and end of the sentence "formulas and fractions ...", for each refusal.

    Refused are physics that these methods lack, several velocities in a rod, strain,
    ends that are not free, and rods bonded to a wall.
    """
    for path, physics in needs(system):
        yield path, f"know no {physics}; leave it out"
    for i, body in enumerate(system.bodies):
        if not isinstance(body, Rod):
            continue
        if isinstance(body.velocity, Steps) or body.strain != 0:
            yield (
                f"bodies.{i}",
                "need a uniform velocity and no strain; put pieces of rod there",
            )
    for side, end in zip(("left", "right"), system.ends, strict=True):
        if not isinstance(end, Free):
            yield (
                f"ends.{side}",
                f'need free ends, got "{end.kind}"; leave it out',
            )
    for k, law in enumerate(system.contacts):
        neighbours = system.bodies[k : k + 2]
        if isinstance(law, Bonded) and Wall in map(type, neighbours):
            yield f"contacts.{k}", "know no rod bonded to a wall; let it touch"


def check_arguments(progress: bool | ProgressFunction = True, **caps: Any) -> None:
    """Raise InvalidModel unless all caps are positive whole numbers.

    `progress` must be a bool or a function.
    """
    problems: Problems = []
    for name, value in caps.items():
        checked_count(problems, name, value)
    check_progress(problems, progress)
    raise_if_problems(problems)


class FormulaTooLong(InvalidModel):
    """A run on fractions has too many events, or a formula too many terms or digits."""


def check_final(is_final: bool, max_events: int) -> None:
    """Raise FormulaTooLong for a run that was stopped by its cap on events."""
    if not is_final:
        message = f"the collision is not over after {max_events} events; raise it"
        raise FormulaTooLong([("max_events", message)])


def fractions_of(values: Any) -> dict[str, Fraction]:
    """Fractions of the numbers or texts that the user gave in a mapping by path.

    The result is empty for None. InvalidModel is raised for anything but a mapping, and
    names each key that is no text and each path whose value is no number.
    """
    if values is None:
        return {}
    if not isinstance(values, Mapping):
        message = "must be numbers by path, such as {'bodies.0.length': '1/3'}"
        raise InvalidModel([("values", f"{message}, got {shown(values)}")])
    fractions: dict[str, Fraction] = {}
    problems: Problems = []
    for path, value in values.items():
        if not isinstance(path, str):
            message = f"must be by paths such as 'bodies.0.length', got {shown(path)}"
            problems.append(("values", message))
            continue
        try:
            fractions[path] = _fraction(value)
        except (ValueError, TypeError, ZeroDivisionError, OverflowError):
            problems.append(
                (path, f'must be a number or a text such as "1/3", got {shown(value)}')
            )
    raise_if_problems(problems)
    return fractions


def _fraction(value: Any) -> Fraction:
    """Value as a fraction.

    A value that is no finite number, and no text of one, raises TypeError, ValueError,
    ZeroDivisionError or OverflowError.
    """
    if isinstance(value, float | np.floating):
        return decimal_fraction(float(value))
    if is_integer(value):
        return Fraction(int(value))
    if isinstance(value, np.generic):
        raise TypeError  # `Fraction` would take some of these as whole numbers
    return Fraction(value)


def decimal_fraction(x: float) -> Fraction:
    """Fraction of a number as it is written: 0.1 is one tenth."""
    return Fraction(repr(x))
