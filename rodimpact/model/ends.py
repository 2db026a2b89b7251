"""Boundary conditions at the two ends of a row: free, fixed, absorbing or driven.

A prescribed force, a prescribed velocity and an incoming wave follow a profile in time.
SI units; a number may be an array, which makes a family.
"""

from typing import Any, ClassVar, TypeAlias, get_args

from .frozen import Frozen, Problems, quantity, raise_if_problems
from .positions import velocity_of
from .profiles import Profile, ProfileLike, Steps, in_time


class Free(Frozen, kind="free"):
    """A free end: no force acts on it.

    Examples
    --------
    >>> import rodimpact as ri
    >>> rod = ri.Rod(1.0, area=1e-4, material=ri.materials.steel)
    >>> ri.System([rod]).ends
    (Free(), Free())
    """


class Fixed(Frozen, kind="fixed"):
    """A fixed end: the end of a rod is held at rest, also under tension.

    Examples
    --------
    A rod with a fixed right end vibrates forever:

    >>> import rodimpact as ri
    >>> rod = ri.Rod(1.0, area=1e-4, material=ri.materials.steel, velocity=1.0)
    >>> swing = ri.solve(ri.System([rod], ends=[ri.Free(), ri.Fixed()]), until=1e-4)
    >>> float(swing.velocity(0, 1.0, 1e-4))
    0.0
    """


class Absorbing(Frozen, kind="absorbing"):
    """An absorbing end: waves leave and none returns, as in an infinite rod.

    The wave that enters the rod from outside keeps its value at t = 0. Under gravity
    the infinite rod outside falls, too, because nothing holds it.

    Examples
    --------
    A pulse leaves through the right end, and the rod is at rest:

    >>> import rodimpact as ri
    >>> short = ri.Rod(0.1, area=1e-4, material=ri.materials.steel, velocity=1.0)
    >>> rods = [short, short.replace(length=0.5, velocity=0.0)]
    >>> run = ri.solve(ri.System(rods, ends=[ri.Free(), ri.Absorbing()]), until=3e-4)
    >>> run.velocity(1, [0.1, 0.4], 3e-4).tolist()
    [0.0, 0.0]
    """


class _Driven(Frozen):
    """An end at which a force, a velocity or a wave follows a profile in time."""

    value: Profile

    def __init__(self, value: ProfileLike, *, duration: float | None = None) -> None:
        self._set(value=in_time(value, self.fields["value"], duration))


class Pushed(_Driven, kind="pushed"):
    """A prescribed force on the end of a rod or on a mass.

    Parameters
    ----------
    value : float, array, Steps, Samples or function
        Force over time, N. At both ends a positive force pushes into the row and
        compresses it. `Steps` take times for `at`, `Samples` need their `step`; a
        function of time, s, is sampled.
    duration : float, optional
        Time for which a function is sampled, s; no other value takes it. The function
        is sampled at 4097 times from 0 to the duration, and its last value holds on.

    Raises
    ------
    InvalidModel
        Naming every field that is not what it should be.

    Examples
    --------
    >>> from rodimpact.model.profiles import Steps
    >>> Pushed(Steps([1e3, 0.0], at=[1e-4]))
    Pushed(value=Steps(values=(1000.0, 0.0), at=(0.0001,)))
    """

    value: Profile = quantity("N", label="force", along="time")


class Moved(_Driven, kind="moved"):
    """A prescribed velocity or position of the end of a rod, for any force.

    The force may be a tension.

    Parameters
    ----------
    value : float, array, Steps, Samples or function
        Velocity over time, m/s, positive to the right at both ends. `Steps` take times
        for `at`, `Samples` need their `step`; a function of time, s, is sampled.
    position : Samples or function, optional
        Position over time, m, in place of the velocity. Only its changes matter, so the
        origin is arbitrary. Straight lines between the samples give a stepwise
        velocity, and a smooth curve gives a smooth velocity. After the last sample the
        end is at rest.
    duration : float, optional
        Time for which a function is sampled, s; no other value takes it. The function
        is sampled at 4097 times from 0 to the duration, and its last value holds on.

    Raises
    ------
    InvalidModel
        Naming every field that is not what it should be.

    Examples
    --------
    >>> from rodimpact.model.profiles import Samples
    >>> Moved(Samples([0.0, 1.0, 0.0], step=1e-4))
    Moved(value=Samples(values=array(3,), step=0.0001))

    An end that goes 1 mm to the right in 0.1 ms, and stops:

    >>> Moved(position=Samples([0.0, 1e-3], step=1e-4)).value
    Steps(values=(10.0, 0.0), at=(0.0001,))
    """

    _alternatives: ClassVar[dict[str, tuple[str, ...]]] = {
        "value": ("position",),
        "position": ("value",),
    }
    value: Profile = quantity("m/s", label="velocity", along="time", default=None)
    position: "Profile | None" = quantity(
        "m", label="position", along="time", default=None
    )

    def __init__(
        self,
        value: "ProfileLike | None" = None,
        *,
        position: "ProfileLike | None" = None,
        duration: float | None = None,
    ) -> None:
        """Set the velocity as given, or the position and the velocity that follows.

        A function of time is sampled from 0 to `duration`, s. InvalidModel unless
        exactly one of `value` and `position` is given, for a position that jumps
        (`Steps`), and for mistakes in the profile.
        """
        problems: Problems = []
        if value is None and position is None:
            problems.append(("value", "is missing; give a velocity, or a position"))
        elif value is not None and position is not None:
            problems.append(("position", "give either value or position, not both"))
        elif isinstance(position, Steps):
            message = (
                "jumps, and an end cannot jump; give Samples of the position, or the "
                "velocity as value"
            )
            problems.append(("position", message))
        raise_if_problems(problems)
        if value is not None:
            super().__init__(value, duration=duration)
            return
        field = self.fields["position"]
        profile = in_time(position, field, duration, "position")
        velocity = velocity_of(problems, profile)
        raise_if_problems(problems)
        self._set(position=profile, value=velocity)

    def _parameters(self) -> dict[str, Any]:
        """The parameter that was given: the position, or the velocity."""
        if self.position is not None:
            return {"position": self.position}
        return {"value": self.value}


class Incoming(_Driven, Absorbing, kind="incoming"):
    """An absorbing end through which a wave comes in, such as a measured pulse.

    The wave is added to the initial state of the rod. Waves that reach the end leave
    the rod, as they do at an absorbing end.

    Parameters
    ----------
    value : float, array, Steps, Samples or function
        Strain of the incoming wave alone, at the end of the rod, over time. At both
        ends it is negative for a compressive pulse. `Steps` take times for `at`,
        `Samples` need their `step`; a function of time, s, is sampled.
    duration : float, optional
        Time for which a function is sampled, s; no other value takes it. The function
        is sampled at 4097 times from 0 to the duration, and its last value holds on.

    Raises
    ------
    InvalidModel
        Naming every field that is not what it should be.

    Examples
    --------
    >>> from rodimpact.model.profiles import Samples
    >>> Incoming(Samples([0.0, -1e-3, -1e-3, 0.0], step=2e-5))
    Incoming(value=Samples(values=array(4,), step=2e-05))
    """

    value: Profile = quantity("", label="strain", along="time")


End: TypeAlias = Free | Fixed | Absorbing | Pushed | Moved | Incoming
ENDS: dict[str, type[End]] = {end.kind: end for end in get_args(End)}
END_OF_KIND: dict[str, type[End]] = {**ENDS, "force": Pushed, "velocity": Moved}
"""Ends by their kinds in files; earlier versions wrote "force" and "velocity"."""
FREE = Free()
