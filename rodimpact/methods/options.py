"""What a run is asked for: checked here, whoever asks."""

from __future__ import annotations

from dataclasses import dataclass
from numbers import Integral
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..model import System
from ..model.arguments import array
from ..model.frozen import InvalidModel, Problems, number
from .abilities import LACKS, choose, refuse, require_end

MAX_EVENTS = 5_000_000
MOST_COUNTED = 10**18
METHODS = ("auto", *LACKS)


@dataclass(frozen=True)
class Options:
    """How to run a collision, or each one of a family.

    Parameters
    ----------
    until : float, optional
        Time to run to, s.
    method : str
    max_events : int
    dt : float, optional
        Time step, s.
    rtol : float, optional
    cells : int, optional
    snapshots : int or array_like, optional
        How many states to keep, or at which times, s.

    Raises
    ------
    InvalidModel
        With all mistakes, each with the name of its option.

    See Also
    --------
    rodimpact.solve : Says what they mean.
    """

    until: float | None = None
    method: str = "auto"
    max_events: int = MAX_EVENTS
    dt: float | None = None
    rtol: float | None = None
    cells: int | None = None
    snapshots: int | ArrayLike | None = None

    def __post_init__(self) -> None:
        problems: Problems = []
        for name, unit, sign in (
            ("until", "s", "non-negative"), ("dt", "s", "positive"), ("rtol", "", "positive"),
        ):
            if getattr(self, name) is not None:
                self._set(name, _single(problems, name, getattr(self, name), unit, sign))
        for name in ("dt", "cells"):
            if getattr(self, name) is not None and self.rtol is not None:
                problems.append((name, "fixes the step, rtol chooses it; give one of them"))
        if self.method not in METHODS:
            known = ", ".join(f'"{m}"' for m in METHODS)
            problems.append(("method", f"must be one of {known}, got {self.method!r}"))
        self._set("max_events", count(problems, "max_events", self.max_events))
        if self.cells is not None:
            self._set("cells", count(problems, "cells", self.cells))
        if self.snapshots is not None:
            self._set("snapshots", _snapshots(problems, self.snapshots, self.until))
        if problems:
            raise InvalidModel(problems)

    def _set(self, name: str, value: Any) -> None:
        object.__setattr__(self, name, value)

    def method_for(self, system: Any) -> str:
        """Choose the method that is to run.

        Parameters
        ----------
        system : System
            Of any shape; what any member needs, the method has.

        Raises
        ------
        InvalidModel
            If that is no System, the method lacks something that it has, an option is for another
            method, or `until` is missing.
        """
        if not isinstance(system, System):
            message = f"must be a System, such as System([rod, Wall()]), got {system!r}"
            raise InvalidModel([("system", message)])
        stepping, gridded = (
            [name for name in names if getattr(self, name) is not None]
            for names in (("dt", "rtol"), ("cells", "snapshots"))
        )
        method = self.method
        if method == "auto":
            method = choose(system, 2 if gridded else 1 if stepping else 0)
        refuse(method, system)
        problems: Problems = []
        if method == "fronts":
            problems += [(name, 'method "fronts" is exact and has no time step; leave it out')
                         for name in stepping]
        if method != "finite-difference":
            problems += [(name, f'is for method "finite-difference", not "{method}"; leave it out')
                         for name in gridded]
        if problems:
            raise InvalidModel(problems)
        require_end(system, self.until)
        return method


def count(problems: Problems, name: str, value: Any) -> int:
    """A positive whole number that a register can hold; 0 and a problem if it is none."""
    whole = not isinstance(value, bool) and isinstance(value, Integral)
    if whole and 1 <= int(value) < MOST_COUNTED:
        return int(value)
    most = " below 10^18" if whole and value > 0 else ""
    problems.append((name, f"must be a positive whole number{most}, got {value!r}"))
    return 0


def _single(problems: Problems, name: str, value: Any, unit: str, sign: str) -> Any:
    found = number(problems, name, value, unit, sign)
    if not isinstance(found, float):
        problems.append((name, f"must be a single number, got {value!r}"))
    return found


def _snapshots(problems: Problems, value: Any, until: float | None) -> int | tuple[float, ...]:
    if most := count([], "snapshots", value):
        return most
    try:
        times = array("snapshots", value, "s")
    except (TypeError, ValueError):
        times = np.zeros(0)
    if times.ndim != 1 or not times.size or isinstance(value, str):
        message = f"must be a positive whole number, or a list of times, got {value!r}"
        problems.append(("snapshots", message))
        return 0
    good = np.isfinite(times) & (times >= 0)
    if not good.all():
        bad = float(times[~good][0])
        problems.append(("snapshots", f"must be times of 0 s or more, got {bad!r}"))
    elif until is not None and times.max() > until:
        message = f"must lie before until = {until!r} s, got {float(times.max())!r}"
        problems.append(("snapshots", message))
    return tuple(times.tolist())
