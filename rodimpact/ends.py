"""The two ends of a row: free, held, endless or driven.

A driven end follows a profile in time. SI units; a number may be an array, which makes a family.
"""

from __future__ import annotations

from typing import Any, ClassVar, TypeAlias

from .frozen import Frozen, InvalidModel, Problems, plain
from .profiles import Profile, in_time, profile_from


class _End(Frozen):
    """An end of a row, described by its kind and what drives it."""

    kind: ClassVar[str]

    def to_dict(self) -> dict[str, Any]:
        return {"kind": self.kind, **{name: plain(v) for name, v in self.__dict__.items()}}


class Free(_End):
    """No force acts."""

    kind: ClassVar[str] = "free"


class Fixed(_End):
    """The end of a rod is held at rest, in tension too."""

    kind: ClassVar[str] = "fixed"


class Absorbing(_End):
    """The rod goes on for ever: waves leave and none comes back.

    What comes from outside stays what the initial state of the rod has there.
    """

    kind: ClassVar[str] = "absorbing"


class Force(_End):
    """A force pushes on the end of a rod or on a mass.

    Parameters
    ----------
    value : float, array, Steps, Samples or function
        N over time, s; positive pushes into the row, which compresses it, at both ends. `Steps`
        take times for `at`, `Samples` need their `step`; a function of time is sampled.
    duration : float, optional
        s, for a function only: it is sampled at 4097 times from 0 to this, and its last value holds
        on.

    Raises
    ------
    InvalidModel
        Naming every field that is not what it should be.

    Examples
    --------
    >>> from rodimpact.profiles import Steps
    >>> Force(Steps([1e3, 0.0], at=[1e-4]))
    Force(value=Steps(values=(1000.0, 0.0), at=(0.0001,)))
    """

    kind: ClassVar[str] = "force"
    value: Profile

    def __init__(self, value: Any, *, duration: Any = None) -> None:
        problems: Problems = []
        F = in_time(problems, "value", value, "N", duration)
        if problems:
            raise InvalidModel(problems)
        self._set(value=F)


class Velocity(_End):
    """The end of a rod moves as prescribed, whatever force that takes, in tension too.

    Parameters
    ----------
    value : float, array, Steps, Samples or function
        m/s over time, s, positive to the right at both ends. `Steps` take times for `at`, `Samples`
        need their `step`; a function of time is sampled.
    duration : float, optional
        s, for a function only: it is sampled at 4097 times from 0 to this, and its last value holds
        on.

    Raises
    ------
    InvalidModel
        Naming every field that is not what it should be.
    """

    kind: ClassVar[str] = "velocity"
    value: Profile

    def __init__(self, value: Any, *, duration: Any = None) -> None:
        problems: Problems = []
        v = in_time(problems, "value", value, "m/s", duration)
        if problems:
            raise InvalidModel(problems)
        self._set(value=v)


End: TypeAlias = Free | Fixed | Absorbing | Force | Velocity
ENDS: dict[str, type[End]] = {
    end.kind: end for end in (Free, Fixed, Absorbing, Force, Velocity)
}
FREE = Free()


def end_from(data: dict[str, Any]) -> End:
    """Make the end that `to_dict` described."""
    driven = {"value": profile_from(data["value"])} if "value" in data else {}
    return ENDS[data["kind"]](**driven)
