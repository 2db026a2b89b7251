"""A row of bodies as links, masses and segments: what any method on a time step starts from."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ..model import Absorbing, Bonded, Fixed, Moved, Pushed, Rigid, RigidMass, Rod, System, Wall
from ..model.frozen import InvalidModel, Problems
from ..model.profiles import extremes
from .contact_law_kernel import BOND, COMPLIANT, FORCE, FREE, IMPACT, RIGID, SPRING

ROOM = 2.0**60  # for sums over steps and cells
STIFFEST = 2.0**80  # of a contact, times transit time over impedance
LEAST = 2.0**-800  # stiffness, where time is counted in steps
Array = np.ndarray[Any, np.dtype[Any]]


class Plan:
    """A single system as a row of links, masses and segments, in SI, without a step yet.

    Attributes
    ----------
    spans, segments, paths
        As in `Clockwork`; segments in order.
    first : list of int
        Masses left of each node; the links of node k begin at k + first[k].
    masses, mass_velocity : list of float
        Bodies bonded together are one mass.
    mass_of : list of int
        Mass of each body; len(masses) + 0 or 1 if bonded to the left or right wall, -1 for a rod or
        a wall.
    laws, stiffness, exponent, damping, gap : list
        By link.
    contact_link : list of int
        Link of each contact, -1 where it joins rigid bodies for good.
    outside : list of (str, value)
        Left and right: ``"none"``, ``"velocity"``, ``"force"`` or ``"absorbing"``.
    frame, scale : float
        Velocity of the frame, and scale of velocities, m/s.
    """

    def __init__(self, system: System) -> None:
        self.system = system
        self.gravity = float(system.gravity)
        self.laws: list[int] = []
        self.stiffness: list[float] = []
        self.exponent: list[float] = []
        self.damping: list[float] = []
        self.gap: list[float] = []
        self.contact_link: list[int] = []
        self.masses: list[float] = []
        self.mass_velocity: list[float] = []
        self.mass_of: list[int] = []
        self.first: list[int] = [0]
        self.segments: list[Any] = []
        self.paths = [""]
        spans: list[tuple[int, int]] = []
        self.outside: list[tuple[str, Any]] = [("none", 0.0), ("none", 0.0)]
        last = len(system.bodies) - 1
        for i, body in enumerate(system.bodies):
            joined = i > 0 and isinstance(system.contacts[i - 1], Bonded)
            rigid_before = i > 0 and not isinstance(system.bodies[i - 1], Rod)
            if i == 0 and not isinstance(body, Wall):
                self._end(0, system.ends[0])
            elif i > 0 and joined and rigid_before and not isinstance(body, Rod):
                self.contact_link.append(-1)
                self._merge(body)
                spans.append((1, 0))
                continue
            elif i > 0:
                self.contact_link.append(len(self.laws))
                self._link(system.contacts[i - 1], float(system.gaps[i - 1]))
            if isinstance(body, Rod):
                for j, segment in enumerate(body.segments):
                    if j:
                        self._add(BOND)
                    self.segments.append(segment)
                    stepped = len(body.segments) > 1
                    self.paths.append(f"bodies.{i}.segments.{j}" if stepped else f"bodies.{i}")
                    self.first.append(len(self.masses))
                n = len(self.segments)
                spans.append((n - len(body.segments) + 1, n))
                self.mass_of.append(-1)
                continue
            spans.append((1, 0))
            if isinstance(body, RigidMass):
                self.masses.append(float(body.mass))
                self.mass_velocity.append(float(body.velocity))
                self.mass_of.append(len(self.masses) - 1)
            else:
                self.outside[0 if i == 0 else 1] = ("velocity", float(body.velocity))
                self.mass_of.append(-1)
        if not isinstance(system.bodies[last], Wall):
            self._end(1, system.ends[1])
        self.first.append(len(self.masses))
        for i, m in enumerate(self.mass_of):
            if m < 0 and isinstance(system.bodies[i], RigidMass):
                self.mass_of[i] = len(self.masses) + any(stop for _, stop in spans[:i])
        self.spans = tuple(spans)
        self.frame, self.scale = self._frame_and_scale()
        largest = max(*self.masses, *(float(s.mass) for s in self.segments), 0.0)
        if not self.scale * self.scale * largest * ROOM < math.inf:
            size = f"velocities and strains of {self.scale!r} m/s"
            raise InvalidModel([("bodies", f"{size} overflow the energy; use smaller")])

        self._check_stiffness()

    def _check_stiffness(self) -> None:
        """Refuse contacts so stiff beside the rods that their indentation is lost in round-off."""
        T = max(float(s.transit_time) for s in self.segments)
        yielding = T / self._weakest()
        problems: Problems = []
        for i, link in enumerate(self.contact_link):
            law = self.laws[link] if link >= 0 else BOND
            if law >= SPRING and (
                self.stiffness[link] * yielding * (self.scale * T) ** (self.exponent[link] - 1)
                > STIFFEST
            ):
                message = f"is as good as rigid beside these rods, got {self.stiffness[link]!r}"
                problems.append((f"contacts.{i}.stiffness", f"{message}; use Rigid()"))
        if problems:
            raise InvalidModel(problems)

    def _add(
        self, law: int, damping: float = 0.0, gap: float = 0.0, stiffness: float = 0.0,
        exponent: float = 1.0,
    ) -> None:
        self.laws.append(law)
        self.stiffness.append(stiffness)
        self.exponent.append(exponent)
        self.damping.append(damping)
        self.gap.append(gap)

    def _link(self, law: Any, gap: float) -> None:
        if isinstance(law, Bonded):
            self._add(BOND)
        elif isinstance(law, Rigid):
            impact = law.restitution is not None
            self._add(IMPACT if impact else RIGID, float(law.restitution or 0.0), gap)
        else:
            damping = float(getattr(law, "damping", 0.0))
            stiffness, exponent = float(law.stiffness), float(law.exponent)
            self._add(COMPLIANT[law.law], damping, gap, stiffness, exponent)

    def _end(self, side: int, end: Any) -> None:
        kinds = {Fixed: "velocity", Moved: "velocity", Pushed: "force", Absorbing: "absorbing"}
        kind = kinds.get(type(end), "none")
        self.outside[side] = (kind, getattr(end, "value", 0.0))
        self._add({"none": FREE, "force": FORCE}.get(kind, BOND))

    def _merge(self, body: Any) -> None:
        """Join a rigid body to the one before it: two masses, or a mass and a wall."""
        if isinstance(body, Wall):
            self.outside[1] = ("velocity", float(body.velocity))
            self.masses.pop()
            self.mass_velocity.pop()
            top = len(self.masses)
            self.mass_of = [-1 if m == top else m for m in self.mass_of]
            self.mass_of.append(-1)
        elif self.mass_of[-1] < 0:  # the wall it is bonded to
            self.mass_of.append(-1)
        else:
            m = self.mass_of[-1]
            M, more = self.masses[m], float(body.mass)
            momentum = M * self.mass_velocity[m] + more * float(body.velocity)
            self.masses[m], self.mass_velocity[m] = M + more, momentum / (M + more)
            self.mass_of.append(m)

    def _frame_and_scale(self) -> tuple[float, float]:
        walls = [float(b.velocity) for b in self.system.bodies if isinstance(b, Wall)]
        velocities, strained, pushed = [*walls, *self.mass_velocity], 0.0, 0.0
        for body, (start, stop) in zip(self.system.bodies, self.spans, strict=True):
            if isinstance(body, Rod):
                velocities += extremes(body.velocity)
                c = max(float(s.wave_speed) for s in self.segments[start - 1 : stop])
                strained = max(strained, *(c * abs(e) for e in extremes(body.strain)))
        for kind, value in self.outside:
            if kind == "velocity":
                velocities += extremes(value)
            elif kind == "force":
                pushed = max(pushed, *(abs(F) for F in extremes(value))) / self._weakest()
        low, high = min(velocities), max(velocities)
        frame = sum(walls) / len(walls) if walls else low / 2 + high / 2
        fall = abs(self.gravity) * max(float(s.transit_time) for s in self.segments)
        return frame, high - low + strained + pushed + fall

    def _weakest(self) -> float:
        """Smallest impedance, kg/s."""
        return min(
            float(s.material.density) * float(s.wave_speed) * extremes(s.area)[0]
            for s in self.segments
        )

    def stiffness_in_steps(self, step: float) -> Array:
        """Stiffness of each link where time is counted in steps, s, and lengths as velocities."""
        scaled = [k * step**p for k, p in zip(self.stiffness, self.exponent, strict=True)]
        for k, p, small in zip(self.stiffness, self.exponent, scaled, strict=True):
            if k > 0 and small < LEAST:
                message = f"a force of {k!r} times the indentation to the {p:g} vanishes in steps"
                raise InvalidModel([("contacts", f"{message} of {step:.3g} s; use a lower power")])
        return np.array(scaled)

    def wall_speed(self, side: int, times: Array) -> Array:
        """Velocity of the left or right wall at times, s, in the frame."""
        wall = float(self.outside[side][1]) - self.frame
        found: Array = wall - self.gravity * times
        return found


def squeezed(seconds: float) -> InvalidModel:
    """What to raise where a rigid mass cannot move."""
    message = (
        f"a rigid mass is squeezed between walls that leave it no room, at {seconds:.6g} s; give a "
        "contact there a compliant law"
    )
    return InvalidModel([("contacts", message)])


def whole(values: list[int]) -> Array:
    """Return whole numbers as an array for a kernel."""
    return np.array(values, dtype=np.int64)
