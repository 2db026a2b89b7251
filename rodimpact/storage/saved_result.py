"""The [result] of a case file: how the run of a saved solution ended, and its outcome.

A solution is saved as its case. When the file is loaded, the case is solved again, and
the new outcome is compared with the one that is stored here.
"""

from collections.abc import Collection, Mapping
from typing import Any, NamedTuple

from ..hints import nearest
from ..methods.run import (
    DURATION,
    IMPULSE,
    MEASURES,
    PEAK_FORCE,
    TIME,
    VELOCITY,
)
from ..model.frozen import Problems, add_problem, raise_if_problems

ENERGY = "energy"
COUNT = "count"
BY_BODY = {"velocity_after": VELOCITY, "vibration_after": ENERGY}
BY_CONTACT = {
    "impulse": IMPULSE,
    "peak_force": PEAK_FORCE,
    "duration": DURATION,
    "first": TIME,
    "last": TIME,
    "episodes": COUNT,
}
OUTCOME_ENERGIES = (
    "kinetic_after",
    "contact_energy",
    "dissipated",
    "damped",
    "numerical",
    "radiated",
    "soil_work",
    "drag_work",
    "wall_work",
    "drive_work",
    "gravity_work",
)
"""Energies of the whole row, J, by their names in an `Outcome`."""
LATER_ENERGIES = ("soil_work", "drag_work")
"""Energies that are missing in files of earlier versions, where they were 0."""
MEASURE_OF = BY_BODY | BY_CONTACT | dict.fromkeys(OUTCOME_ENERGIES, ENERGY)
"""Measure of each number of an outcome; its stated error applies to the number."""


WORDS = ("version", "method", "stopped_by", "status")
"""Entries of a `SavedResult` that are text."""


class SavedResult(NamedTuple):
    """How a run ended, and its outcome, as the table [result] of a case file.

    Attributes
    ----------
    version : str
        Version of rodimpact that solved the case.
    method : str
        Method that solved the case, never ``"auto"``.
    stopped_by, status : str
        Why the run ended, in a word and in a sentence.
    final : bool
        Whether it is proved that no contact can press again.
    numbers : dict of str to float
        Numbers of the outcome in SI units: ``"velocity_after.I"`` of body I,
        ``"impulse.K"`` of contact K, and so on, and the `OUTCOME_ENERGIES`.
    accuracy : dict of str to float
        Stated relative errors by measure, as in `Solution.accuracy`.
    """

    version: str
    method: str
    stopped_by: str
    status: str
    final: bool
    numbers: Mapping[str, float]
    accuracy: Mapping[str, float]


def read_result(table: Mapping[str, Any], bodies: int) -> SavedResult:
    """Make a `SavedResult` from the table [result] of a case file.

    All numbers of an outcome are required, except those of `LATER_ENERGIES`: they are 0
    if they are missing. The table of the accuracy is required, but may be empty.

    Parameters
    ----------
    table : dict
        Table as `tomllib` reads it.
    bodies : int
        Number of bodies of the case.

    Returns
    -------
    SavedResult

    Raises
    ------
    InvalidModel
        With all mistakes, each with the path of its entry in the table.
    """
    problems: Problems = []
    keys = SavedResult._fields
    _check_keys(problems, "", table, allowed=keys, required=keys)
    # A missing entry is a problem already; the defaults of `get` pass these checks.
    for name in WORDS:
        if not isinstance(table.get(name, ""), str):
            add_problem(problems, name, "must be text", table[name])
    if not isinstance(table.get("final", True), bool):
        add_problem(problems, "final", "must be true or false", table["final"])
    names = names_of_numbers(bodies)
    required = [name for name in names if name not in LATER_ENERGIES]
    numbers = _read_numbers(problems, "numbers", table, names, required)
    for name in LATER_ENERGIES:
        numbers.setdefault(name, 0.0)
    accuracy = _read_numbers(problems, "accuracy", table, MEASURES)
    for name, error in accuracy.items():
        if not error >= 0:  # also true for nan
            add_problem(problems, f"accuracy.{name}", "must not be negative", error)
    raise_if_problems(problems)
    return SavedResult(
        version=table["version"],
        method=table["method"],
        stopped_by=table["stopped_by"],
        status=table["status"],
        final=table["final"],
        numbers=numbers,
        accuracy=accuracy,
    )


def names_of_numbers(bodies: int) -> list[str]:
    """Names of all numbers of the outcome of a row with this number of bodies.

    Energies of the row are first. Names such as "velocity_after.0", with the index of
    the body, and "impulse.0", with the index of the contact, follow.
    """
    names = [*OUTCOME_ENERGIES]
    # There is a contact between each body and the next one.
    for by_owner, count in ((BY_BODY, bodies), (BY_CONTACT, bodies - 1)):
        for name in by_owner:
            for owner in range(count):
                names.append(f"{name}.{owner}")
    return names


def _check_keys(
    problems: Problems,
    path: str,
    table: Mapping[str, Any],
    allowed: Collection[str],
    required: Collection[str],
) -> None:
    """Add a problem for each key of a table that is unknown, and for each missing key.

    A key is unknown if it is not in `allowed`, and missing if it is in `required`, but
    not in the table. The path of a problem is `path` followed by the key; `path` is ""
    or ends in a dot.
    """
    for key in table:
        if key not in allowed:
            problems.append((path + key, f"unknown key; {nearest(key, allowed)}"))
    for key in required:
        if key not in table:
            problems.append((path + key, "is missing"))


def _read_numbers(
    problems: Problems,
    name: str,
    table: Mapping[str, Any],
    allowed: Collection[str],
    required: Collection[str] = (),
) -> dict[str, float]:
    """Numbers of the subtable `name` of [result]; they may be infinite or nan.

    Mistakes are added to `problems`: keys that are not allowed or missing, and values
    that are not numbers, which are left out. If there is no such table, the result is
    {}; only an entry that is not a table is a problem then.
    """
    group = table.get(name)
    if not isinstance(group, dict):
        if name in table:  # a missing table is a problem of `read_result`
            add_problem(problems, name, "must be a table of numbers", group)
        return {}
    _check_keys(problems, f"{name}.", group, allowed, required)
    numbers: dict[str, float] = {}
    for key, value in group.items():
        try:
            if isinstance(value, bool | str):
                raise TypeError  # `float` would convert these, too
            numbers[key] = float(value)
        except (TypeError, OverflowError):
            add_problem(problems, f"{name}.{key}", "must be a number", value)
    return numbers
