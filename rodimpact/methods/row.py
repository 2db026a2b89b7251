"""The one walk through a system: a row of segments, rigid masses and links, as flat lists.

Every method starts from a `Row`. Segments are counted 1 to n from left to right; 0 and n + 1 are
what lies outside. Node k joins the segments k and k + 1: rigid masses may stand there, and links
join what stands beside each other. Numbers are those of the system, in SI: floats, or for a family
arrays.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable
from functools import cached_property, partial
from itertools import pairwise
from typing import Any

import numpy as np

from .. import model
from ..model import InvalidModel
from ..model.profiles import extremes
from . import scales
from .laws import Law
from .scales import largest as largest
from .scales import smallest

SMALLEST, LARGEST = sys.float_info.min, sys.float_info.max
AS_GOOD_AS_RIGID = "is as good as rigid beside these rods, got {!r}; use {}()"
ROOM = 2.0**60  # for sums over steps and cells
STIFFEST = 2.0**80  # of a contact, times transit time over impedance
KINDS = {
    model.Fixed: "velocity", model.Moved: "velocity", model.Pushed: "force",
    model.Absorbing: "absorbing", model.Incoming: "absorbing",
}
Array = np.ndarray[Any, np.dtype[Any]]


class Row:
    """A system, or a family of them, as a row of links, masses and segments.

    Attributes
    ----------
    system : System
    segments : list of Segment
    paths : list of str
        By segment, what the user calls it; "" for 0.
    spans : tuple of (int, int)
        First and last segment of each body; (1, 0) for a wall or a rigid mass.
    first : list of int
        Masses left of each node; the links of node k begin at k + first[k].
    masses, mass_velocity : list of float
        Bodies bonded together are one mass.
    mass_of : list of int
        Mass of each body; len(masses) + 0 or 1 if bonded to the left or right wall, -1 for a rod or
        a wall.
    laws, stiffness, exponent, damping, strength, gap : list
        By link; where it yields `damping` is the hardening, as a share of the stiffness; the gap of
        a joint is its stretch.
    contact_link : list of int
        Link of each contact, -1 where it joins rigid bodies for good.
    outside : list of (str, value)
        Left and right: ``"none"``, ``"velocity"``, ``"force"`` or ``"absorbing"``; the value of
        the last is the strain of the wave that comes in.
    """

    def __init__(self, system: model.System) -> None:
        self.system, self.gravity = system, system.gravity
        self.laws: list[Law] = []
        self.stiffness: list[Any] = []
        self.exponent: list[Any] = []
        self.damping: list[Any] = []
        self.strength: list[Any] = []
        self.gap: list[Any] = []
        self.contact_link: list[int] = []
        self.masses: list[Any] = []
        self.mass_velocity: list[Any] = []
        self.mass_of: list[int] = []
        self.first = [0]
        self.segments: list[Any] = []
        self.paths = [""]
        self.outside: list[tuple[str, Any]] = [("none", 0.0), ("none", 0.0)]
        spans: list[tuple[int, int]] = []
        for i, body in enumerate(system.bodies):
            law = system.contacts[i - 1] if i else None
            spans.append((1, 0))
            if i == 0 and not isinstance(body, model.Wall):
                self._end(0, system.ends[0])
            elif isinstance(law, model.Bonded) and not (
                isinstance(body, model.Rod) or isinstance(system.bodies[i - 1], model.Rod)
            ):
                self.contact_link.append(-1)
                self._merge(body)
                continue
            elif i > 0:
                self.contact_link.append(len(self.laws))
                self._link(law, system.gaps[i - 1])
            self.mass_of.append(-1)
            if isinstance(body, model.Rod):
                spans[-1] = (len(self.segments) + 1, len(self.segments) + len(body.segments))
                self._rod(f"bodies.{i}", body)
            elif isinstance(body, model.RigidMass):
                self.mass_of[-1] = len(self.masses)
                self.masses.append(body.mass)
                self.mass_velocity.append(body.velocity)
            else:
                self.outside[0 if i == 0 else 1] = ("velocity", body.velocity)
        if not isinstance(system.bodies[-1], model.Wall):
            self._end(1, system.ends[1])
        self.first.append(len(self.masses))
        for i, m in enumerate(self.mass_of):
            if m < 0 and isinstance(system.bodies[i], model.RigidMass):
                self.mass_of[i] = len(self.masses) + any(stop for _, stop in spans[:i])
        self.spans = tuple(spans)

    def _rod(self, path: str, rod: model.Rod) -> None:
        stepped = len(rod.segments) > 1
        for j, segment in enumerate(rod.segments):
            if j:
                self._add(Law.BOND)
            self.segments.append(segment)
            self.paths.append(f"{path}.segments.{j}" if stepped else path)
            self.first.append(len(self.masses))

    def _add(
        self, law: Law, damping: Any = 0.0, gap: Any = 0.0, stiffness: Any = 0.0,
        exponent: Any = 1.0, strength: Any = 0.0,
    ) -> None:
        self.laws.append(law)
        self.stiffness.append(stiffness)
        self.exponent.append(exponent)
        self.damping.append(damping)
        self.strength.append(strength)
        self.gap.append(gap)

    def _link(self, law: Any, gap: Any) -> None:
        if isinstance(law, model.Bonded):
            self._add(Law.BOND)
        elif isinstance(law, model.Rigid):
            e = law.restitution
            self._add(Law.RIGID if e is None else Law.IMPACT, 0.0 if e is None else e, gap)
        elif isinstance(law, model.Joint):
            self._add(Law.JOINT, law.damping, law.stretch, law.stiffness)
        elif isinstance(law, model.Yielding):
            k = law.stiffness
            self._add(Law.YIELD, law.hardening / k, gap, k, strength=law.yield_force)
        elif isinstance(law, model.Law):
            self._add(Law.OWN, 1.0, gap)  # whatever it is, it may depend on the rate
        else:
            kind = Law.SPRING if law.law.startswith("spring") else Law.POWER
            damping = getattr(law, "damping", 0.0)
            self._add(kind, damping, gap, law.stiffness, law.exponent)

    def _end(self, side: int, end: Any) -> None:
        kind = KINDS.get(type(end), "none")
        self.outside[side] = (kind, getattr(end, "value", 0.0))
        push = Law.PUSH_RIGHT if side else Law.PUSH_LEFT
        self._add(push if kind in ("none", "force") else Law.BOND)

    def outside_name(self, side: int) -> str:
        """What acts on the left or right end, as an `Outside` names it."""
        if isinstance(self.system.bodies[-side], model.Wall):
            return "wall"
        return "absorbing" if self.outside[side][0] == "absorbing" else "drive"

    def wave_of_strain(self, side: int) -> Any:
        """The wave that comes in through an end is this, m/s, times its strain."""
        return (-2, 2)[side] * self.segments[-side].wave_speed

    def _merge(self, body: Any) -> None:
        """Join a rigid body to the one before it: two masses, or a mass and a wall."""
        if isinstance(body, model.Wall):
            self.outside[1] = ("velocity", body.velocity)
            self.masses.pop()
            self.mass_velocity.pop()
            top = len(self.masses)
            self.mass_of = [-1 if m == top else m for m in self.mass_of]
            self.mass_of.append(-1)
        elif self.mass_of[-1] < 0:  # the wall it is bonded to
            self.mass_of.append(-1)
        else:
            m = self.mass_of[-1]
            M, more = self.masses[m], body.mass
            momentum = M * self.mass_velocity[m] + more * body.velocity
            self.masses[m], self.mass_velocity[m] = M + more, momentum / (M + more)
            self.mass_of.append(m)

    @cached_property
    def members(self) -> int:
        """How many rows the family has; 1 where it is none."""
        return math.prod(self.system.shape)

    def of(self, value: Any) -> Array:
        """A number for each member, [member] in C order."""
        if np.ndim(value) == 0:
            return np.full(self.members, float(value))
        return np.broadcast_to(value, self.system.shape).ravel().astype(float)

    @cached_property
    def beside(self) -> list[tuple[tuple[str, int], tuple[str, int]]]:
        """By link, what stands on its left and on its right.

        ("outside", side), ("mass", m) or ("segment", s).
        """
        stands = [("outside", 0)]
        for k, (start, stop) in enumerate(pairwise(self.first)):
            stands += [("mass", m) for m in range(start, stop)]
            stands.append(("segment", k + 1) if k < len(self.segments) else ("outside", 1))
        return list(pairwise(stands))

    @cached_property
    def by_law(self) -> dict[int, int]:
        """Links of the contacts whose force follows from a law, all but the bonded, by contact."""
        links = enumerate(self.contact_link)
        return {k: i for k, i in links if i >= 0 and self.laws[i] > Law.BOND}

    @cached_property
    def opening(self) -> dict[int, int]:
        """Links of the contacts that can open, by contact."""
        return {k: i for k, i in self.by_law.items() if self.laws[i] >= Law.RIGID}

    # Scales ---------------------------------------------------------------------------------------

    @cached_property
    def frame(self) -> Any:
        """Velocity of the frame in which methods other than fronts count velocities, m/s."""
        walls = [b.velocity for b in self.system.bodies if isinstance(b, model.Wall)]
        return _plain(scales.frame_of(walls, self._velocities))

    @cached_property
    def scale(self) -> Any:
        """Scale of velocities, m/s."""
        strained: list[Any] = []
        pushed: list[Any] = []
        for body, (start, stop) in zip(self.system.bodies, self.spans, strict=True):
            if isinstance(body, model.Rod):
                c = largest([s.wave_speed for s in self.segments[start - 1 : stop]])
                strained += [c * abs(e) for e in extremes(body.strain)]
        for side, (kind, value) in enumerate(self.outside):
            if kind == "force":
                pushed += [abs(F) for F in extremes(value)]
            elif kind == "absorbing":
                strained += [abs(e * self.wave_of_strain(side)) for e in extremes(value)]
        for link in self.by_law.values():
            if self.laws[link] == Law.JOINT:
                pushed.append(abs(self.stiffness[link] * self.gap[link]))
            elif self.laws[link] >= Law.SPRING and np.any(np.asarray(self.gap[link]) < 0):
                overlap = np.maximum(-np.asarray(self.gap[link]), 0.0)
                pushed.append(self.stiffness[link] * overlap ** self.exponent[link])
        fall = abs(self.gravity) * largest([s.transit_time for s in self.segments])
        return _plain(scales.scale_of(
            self._velocities, strained, pushed, self._least_impedance, fall))

    @cached_property
    def _velocities(self) -> list[Any]:
        velocities = list(self.mass_velocity)
        for body in self.system.bodies:
            if isinstance(body, model.Rod | model.Wall):
                velocities += extremes(body.velocity)
        for kind, value in self.outside:
            if kind == "velocity":
                velocities += extremes(value)
        return velocities

    @cached_property
    def _least_impedance(self) -> Any:
        """Smallest impedance, kg/s."""
        return smallest([
            s.material.density * s.wave_speed * extremes(s.area)[0] for s in self.segments
        ])

    def beyond_scales(self) -> list[tuple[Any, str, Callable[[], str]]]:
        """Where steps overflow, vanish, or lose an indentation in round-off.

        Returns
        -------
        list of (bool or array, str, function)
            Whether that is so, path, and what makes the sentence.
        """
        speed: Any = self.scale
        heaviest: Any = largest([*self.masses, *(s.mass for s in self.segments)])
        impedance: Any = largest([
            s.material.density * s.wave_speed * extremes(s.area)[1] for s in self.segments
        ])
        T: Any = largest([s.transit_time for s in self.segments])
        beyond: list[tuple[Any, str, Callable[[], str]]] = []
        with np.errstate(over="ignore", invalid="ignore", under="ignore"):
            force = speed * impedance
            for square, what in (
                (np.multiply(speed, speed) * heaviest, "energies"),
                (np.multiply(force, force), f"squares of forces, {np.max(force):.3g} N,"),
            ):
                good = np.less(SMALLEST * ROOM, square) & np.less(square, LARGEST / ROOM)
                beyond.append((
                    np.not_equal(speed, 0) & ~good, "bodies",
                    partial(_beyond_numbers, speed, square, what),
                ))
            for i, link in self.by_law.items():
                if self.laws[link] >= Law.SPRING or self.laws[link] == Law.JOINT:
                    k, p = self.stiffness[link], np.asarray(self.exponent[link])
                    stiff = k * (T / self._least_impedance) * np.power(speed * T, p - 1)
                    beyond.append((
                        ~np.less_equal(stiff, STIFFEST), f"contacts.{i}.stiffness",
                        partial(AS_GOOD_AS_RIGID.format, k,
                                "Bonded" if self.laws[link] == Law.JOINT else "Rigid"),
                    ))
        return beyond

    def check_scales(self) -> None:
        """Raise InvalidModel where steps overflow, vanish, or lose an indentation in round-off."""
        problems = [(path, sentence()) for bad, path, sentence in self.beyond_scales() if bad]
        if problems:
            raise InvalidModel(problems[:1] if problems[0][0] == "bodies" else problems)


def _beyond_numbers(speed: Any, square: Any, what: str) -> str:
    how = "vanish; use larger" if square < 1 else "overflow; use smaller"
    return f"velocities and strains of {speed!r} m/s make {what} that {how}"


def _plain(value: Any) -> Any:
    """A number as a float, those of a family as an array."""
    return value if np.ndim(value) else float(value)


def squeezed(seconds: float) -> InvalidModel:
    """What to raise where a rigid mass cannot move."""
    message = (
        f"two walls squeeze a rigid mass at {seconds:.6g} s; give one of its contacts a compliant "
        "law"
    )
    return InvalidModel([("contacts", message)])


def whole(values: list[int]) -> Array:
    """Return whole numbers as an array for a kernel."""
    return np.array(values, dtype=np.int64)
