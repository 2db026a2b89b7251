"""The methods, the physics that each lacks, and the options of a run, with checks."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import replace
from typing import Any, NamedTuple

from numpy.typing import ArrayLike

from ..model import System
from ..model.arguments import array, check_choice, check_kind
from ..model.frozen import (
    FrozenDataclass,
    Problems,
    add_problem,
    invalid_argument,
    quantity,
    raise_if_problems,
)
from ..model.quantities import is_integer
from ..progress import ProgressReport, is_function, no_report
from ..units import shown
from . import abilities
from .abilities import Needs
from .family import Columns
from .fronts import families as front_families
from .fronts import method as fronts
from .grid import method as grid
from .pieces import method as pieces
from .row import Row
from .row_builder import build_row
from .run import MAX_EVENTS, READ, Run


class Method(NamedTuple):
    """A way to solve a system.

    Attributes
    ----------
    lacks : sequence of str
        Physics that it lacks, by the names of `abilities`.
    takes : tuple of str
        Names of the options that not every method takes.
    run : function
        Runs a single collision.
    family : function, optional
        Runs many members of a family in one call; returns their columns.
    members_per_call : function
        Number of members of a row to run in one call of `family`; 0 if each member must
        be run by itself.
    also : tuple of str
        Further columns that `family` computes on request. Other columns are computed
        from runs of single members.
    """

    lacks: Sequence[str]
    takes: tuple[str, ...]
    run: Callable[..., Run]
    family: Callable[..., Columns] | None = None
    members_per_call: Callable[[Row], int] = lambda _: 0
    also: tuple[str, ...] = ()

    def lacking(self, needs: Needs) -> Needs:
        """The needs, pairs of path and name of physics, that the method lacks."""
        return [(path, physics) for path, physics in needs if physics in self.lacks]


METHODS = {
    "fronts": Method(
        fronts.LACKS,
        (),
        fronts.solve,
        front_families.solve_family,
        front_families.members_per_call,
        READ,
    ),
    "characteristics": Method(
        pieces.LACKS,
        ("rtol",),
        pieces.solve,
        pieces.solve_family,
        pieces.members_per_call,
        ("accuracy",),
    ),
    "finite-difference": Method(
        grid.LACKS, ("dt", "rtol", "cells", "snapshots"), grid.solve
    ),
}
"""Methods in the order in which ``"auto"`` tries them.

The fastest is first; the last one lacks nothing.
"""

LARGEST_COUNT = 10**15
METHOD_NAMES = ("auto", *METHODS)


class Options(FrozenDataclass):
    """Options of the run of a collision, or of each member of a family.

    Parameters
    ----------
    until : float, optional
        End of the run, s; by default the proof that the collision is over.
    method : str
        Name of the method, or ``"auto"``.
    max_events : int
        Largest number of events, such as arrivals of waves at ends.
    dt : float, optional
        Time step of a grid, s.
    rtol : float, optional
        Accepted relative error of the outcome; not for fronts.
    cells : int, optional
        Cells of a grid in the segment with the longest transit time.
    snapshots : int or array_like, optional
        Number of states of a grid to keep, or the times at which to keep them, s.

    Raises
    ------
    InvalidModel
        If options are wrong. It has all mistakes, each with the name of its option.

    See Also
    --------
    rodimpact.solve : Tells more of each.

    Examples
    --------
    >>> import rodimpact as ri
    >>> ri.Options(until=1e-3, rtol=1e-6).rtol
    1e-06
    """

    until: float | None = quantity("s", "non-negative", default=None, scalar=True)
    method: str = "auto"
    max_events: int = MAX_EVENTS
    dt: float | None = quantity("s", "positive", default=None, scalar=True)
    rtol: float | None = quantity("", "positive", default=None, scalar=True)
    cells: int | None = None
    snapshots: int | ArrayLike | None = None

    def _check(self, problems: Problems) -> None:
        """Check all options, and append a problem for each mistake to `problems`.

        `max_events` and `cells` are replaced by plain numbers, `snapshots` by a number
        or a tuple of times. `rtol` must be 1 or less, and must not be given together
        with `dt` or `cells`. An unknown method raises its own InvalidModel.
        """
        self._set(max_events=checked_count(problems, "max_events", self.max_events))
        if self.cells is not None:
            self._set(cells=checked_count(problems, "cells", self.cells))
        if self.snapshots is not None:
            self._set(snapshots=_snapshots(problems, self.snapshots, self.until))
        # Options with a problem so far; an option is not reported twice.
        reported = [path for path, _ in problems]
        if "rtol" not in reported:
            is_too_large = self.rtol is not None and self.rtol > 1
            if is_too_large:
                message = "must be at most 1, the whole outcome"
                add_problem(problems, "rtol", message, self.rtol)
        for name in ("dt", "cells"):
            has_both = self.rtol is not None and getattr(self, name) is not None
            if has_both and name not in reported:
                message = "fixes the step, rtol chooses it; give one of them"
                problems.append((name, message))
        check_choice("method", self.method, METHOD_NAMES)

    def method_for(self, system: Any) -> str:
        """Return the name of the method that is to run.

        It is the given method. For ``"auto"`` it is the fastest method that has all
        physics of the system, and that takes `rtol` if this option is given. The method
        can solve the system with these options, or InvalidModel is raised.

        Parameters
        ----------
        system : System
            System of any shape; the method can solve every member.

        Raises
        ------
        InvalidModel
            If `system` is no System, if the method lacks physics of the system, if an
            option belongs to another method, or if `until` must be given.
        """
        check_kind("system", system, System, "System([rod, Wall()])")
        needs = abilities.needs(system)
        capable = capable_of(needs)  # never empty: the last method lacks nothing
        method = self.method
        if method == "auto":
            method = self._first_that_fits(capable)  # the first that takes `rtol`
        missing = METHODS[method].lacking(needs)  # (path, physics) of each
        if len(missing) > 0:  # the given method is not capable
            # The message is such as: has no gravity; method "characteristics" has
            remedy = f'method "{capable[0]}" has'
            # Steps can replace a taper. The advice helps if only tapers are missing.
            if all(physics == abilities.TAPER for _, physics in missing):
                remedy += ", or give rod.in_steps(n)"
            problems: Problems = []
            for path, physics in missing:
                problems.append((path, f'method "{method}" has no {physics}; {remedy}'))
            raise_if_problems(problems)
        self._check_options_of(method)
        if self.until is None and abilities.has_external_drive(system):
            raise invalid_argument(
                "until",
                "must be given: where gravity, drives, soil or drag act, there is no "
                "last contact to wait for",
            )
        return method

    def _check_options_of(self, method: str) -> None:
        """Raise InvalidModel if options are given that only other methods take.

        The options are `dt`, `rtol`, `cells` and `snapshots`; the error has a problem
        for each of them that `method` does not take.
        """
        used = f'"{method}"'
        if self.method == "auto":
            used += ', which "auto" takes'
        problems: Problems = []
        # This method takes all options that a method can take.
        for name in METHODS["finite-difference"].takes:
            is_given = getattr(self, name) is not None
            if is_given and name not in METHODS[method].takes:
                message = f"is for method {_takers(name)}, not {used}"
                problems.append((name, f"{message}; leave it out, or give another"))
        raise_if_problems(problems)

    def run(
        self, method: str, system: System, report: ProgressReport = no_report
    ) -> Run:
        """Run a single collision by the method that `method_for` chose.

        Parameters
        ----------
        method : str
        system : System
            Of shape ().
        report : function
            Called now and then with the progress of a long run.

        Raises
        ------
        InvalidModel
            If the method does not exist or lacks physics of the system, if the system
            is a family or no System, or if `report` is no function.
        """
        check_choice("method", method, tuple(METHODS))
        check_kind("system", system, System, "System([rod, Wall()])")
        if system.shape:  # not (), that of a single system
            message = f"is a family of shape {system.shape}; take a member, system[0]"
            raise invalid_argument("system", message)
        problems: Problems = []
        check_function(problems, "report", report)
        for path, physics in METHODS[method].lacking(abilities.needs(system)):
            problems.append((path, f'method "{method}" has no {physics}'))
        raise_if_problems(problems)
        return self._run_checked(method, system, report)

    def _run_checked(self, method: str, system: System, report: ProgressReport) -> Run:
        """Run a single collision, as `run`; the arguments are not checked.

        If ``"auto"`` could not take the fastest method because of single entries of the
        system, such as its gravity, the sentence of `_why` is added to the status of
        the run.
        """
        # Options that not every method takes
        own_options = {name: getattr(self, name) for name in METHODS[method].takes}
        run = METHODS[method].run(
            build_row(system),
            self.until,
            self.max_events,
            **own_options,
            report=report,
        )
        fastest = next(iter(METHODS))  # the first method
        if self.method == "auto" and method != fastest:
            reason = self._why(method, system)
            if reason:
                return replace(run, status=f"{run.status} {reason}")
        return run

    def _first_that_fits(self, capable: list[str]) -> str:
        """The first of these methods; if `rtol` is given, the first that takes it."""
        if self.rtol is None:
            return capable[0]
        # There is one: the last method is always capable, and takes `rtol`.
        return next(name for name in capable if "rtol" in METHODS[name].takes)

    def _why(self, method: str, system: System) -> str:
        """Sentence on single entries that prevent a faster method, or "" if none do.

        Physics of `abilities.SINGLE`, such as gravity, needs a single entry of a rod or
        of the system. The faster method is the one that ``"auto"`` would take without
        such entries. If this is `method` itself, other physics needs it, and the text
        is empty. `method` must be the one that ``"auto"`` chooses: then any other
        `faster` lacks some of the physics.
        """
        needs = abilities.needs(system)
        other_needs: Needs = []  # without physics of single entries
        for path, physics in needs:
            if physics not in abilities.SINGLE:
                other_needs.append((path, physics))
        faster = self._first_that_fits(capable_of(other_needs))
        if faster == method:
            return ""
        missing = METHODS[faster].lacking(needs)
        path, physics = missing[0]  # the message names the first and counts the others
        more = ""
        if len(missing) > 1:
            more = f" and {len(missing) - 1} more"
        return (
            f'Solved by the slower method "{method}" because of {path}{more}: '
            f'the method "{faster}" has no {physics}.'
        )


def capable_of(needs: Needs) -> list[str]:
    """Names of the methods that lack none of these physics, the fastest first.

    The last method always is among them.
    """
    return [name for name, method in METHODS.items() if not method.lacking(needs)]


def _takers(option: str) -> str:
    """Names of the methods that take an option, quoted and joined by "or"."""
    return " or ".join(
        f'"{name}"' for name, method in METHODS.items() if option in method.takes
    )


def checked_count(problems: Problems, name: str, value: Any) -> int:
    """Return the value of an option as a whole number from 1 to `LARGEST_COUNT`.

    If it is no such number, append a problem with the name of the option to `problems`,
    and return 0.
    """
    counted = 0  # out of range, if `value` is no whole number
    if is_integer(value):
        counted = int(value)
    if 1 <= counted <= LARGEST_COUNT:
        return counted
    limit = ""
    if counted > 1:  # it is too large
        limit = f" of at most {LARGEST_COUNT:g}"
    problems.append(
        (name, f"must be a positive whole number{limit}, got {shown(value)}")
    )
    return 0


def check_function(problems: Problems, name: str, value: Any) -> None:
    """Append a problem to `problems` if a value other than None is no function."""
    if value is not None and not is_function(value):
        problems.append((name, f"must be a function, got {shown(value)}"))


def _snapshots(
    problems: Problems, value: Any, until: float | None
) -> int | tuple[float, ...]:
    """Return `snapshots` as a number of states or as a tuple of their times, s.

    Times must be a list of at least one entry, not negative, and not after `until` if
    that is given; they may have a unit. If the value is neither a number nor times,
    append a problem to `problems`, and return 0.
    """
    # If the value is no number it may still be times: its problem is discarded here.
    discarded: Problems = []
    number = checked_count(discarded, "snapshots", value)
    if number > 0:
        return number
    interval = "non-negative"
    before = ""
    if until is not None:
        interval = f"[0, {until!r}]"
        before = f" up to until = {until!r} s"
    with suppress(ValueError):  # if it is no array of times, see the message below
        times = array("snapshots", value, "s", interval)
        if times.ndim == 1 and times.size:
            return tuple(times.tolist())
    message = f"must be a positive whole number, or a list of times from 0 s on{before}"
    problems.append(("snapshots", f"{message}, got {shown(value)}"))
    return 0
