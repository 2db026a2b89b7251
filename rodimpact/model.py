"""The description of a collision: materials, rods, walls, contacts, and the row they form.

Everything here is frozen and checked when it is made; nothing here moves. A `System` is the
bodies from left to right with the gaps and contact laws between neighbours. Any number may be an
array: the system is then a family of collisions whose `shape` is the NumPy broadcast of them all.

Axis x points to the right; velocity is positive to the right, strain positive in tension; SI units.
"""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any, ClassVar, TypeAlias

import numpy as np

from .frozen import (
    Frozen,
    InvalidModel,
    Number,
    Problems,
    first_false,
    holds,
    in_range,
    number,
    plain,
    short,
)


class Material(Frozen):
    """A linear elastic material.

    Parameters
    ----------
    name : str
        How it is called in tables.
    youngs_modulus : float or array
        E, Pa.
    density : float or array
        rho, kg/m^3.
    poisson_ratio : float or array, optional
        nu, between -1 and 0.5; waves in bars as modelled here do not depend on it.
    viscosity : float or array
        Kelvin-Voigt viscosity eta of sigma = E eps + eta d(eps)/dt, Pa s; the exact method
        `fronts` takes 0 only.

    Raises
    ------
    InvalidModel
        Naming every field that is not what it should be.

    Examples
    --------
    >>> steel = Material("steel", youngs_modulus=200e9, density=7850)
    >>> round(steel.wave_speed)
    5048
    """

    name: str
    youngs_modulus: Number
    density: Number
    poisson_ratio: Number | None
    viscosity: Number

    def __init__(
        self,
        name: str,
        *,
        youngs_modulus: Any,
        density: Any,
        poisson_ratio: Any = None,
        viscosity: Any = 0.0,
    ) -> None:
        problems: Problems = []
        if not isinstance(name, str) or not name:
            problems.append(("name", f"must be a word, got {name!r}"))
        E = number(problems, "youngs_modulus", youngs_modulus, " of pascals", "positive")
        rho = number(problems, "density", density, " of kg/m^3", "positive")
        eta = number(problems, "viscosity", viscosity, " of Pa s", "non-negative")
        nu = None
        if poisson_ratio is not None:
            nu = number(problems, "poisson_ratio", poisson_ratio, "")
            good = (np.asarray(nu) > -1) & (np.asarray(nu) <= 0.5)
            if not problems and not np.all(good):
                at, (got,) = first_false(good, nu)
                problems.append((f"poisson_ratio{at}", f"must lie in (-1, 0.5], got {got!r}"))
        if not problems:
            with np.errstate(all="ignore"):
                ratio = E / rho
            if not holds(good := in_range(ratio)):
                at, (modulus, dense) = first_false(good, E, rho)
                message = f"gives no finite wave speed with density {dense!r}, got {modulus!r}"
                problems.append((f"youngs_modulus{at}", message))
        if problems:
            raise InvalidModel(problems)
        self._set(name=name, youngs_modulus=E, density=rho, poisson_ratio=nu, viscosity=eta)

    @property
    def wave_speed(self) -> Number:
        """Bar speed c = sqrt(E/rho), m/s."""
        ratio = self.youngs_modulus / self.density
        return math.sqrt(ratio) if isinstance(ratio, float) else np.sqrt(ratio)

    def to_dict(self) -> dict[str, Any]:  # noqa: D102  (documented in Frozen)
        return {
            "name": self.name,
            "youngs_modulus": plain(self.youngs_modulus),
            "density": plain(self.density),
            "poisson_ratio": plain(self.poisson_ratio),
            "viscosity": plain(self.viscosity),
        }


class Segment(Frozen):
    """A uniform piece of rod.

    Parameters
    ----------
    length : float or array
        m.
    area : float or array
        Cross-section, m^2.
    material : Material

    Raises
    ------
    InvalidModel
        Naming every field that is not what it should be.
    """

    length: Number
    area: Number
    material: Material

    def __init__(self, length: Any, area: Any, material: Any) -> None:
        problems: Problems = []
        L = number(problems, "length", length, " of metres", "positive")
        A = number(problems, "area", area, " of square metres", "positive")
        if not isinstance(material, Material):
            message = f"must be a Material, such as materials.steel, got {material!r}"
            problems.append(("material", message))
        if problems:
            raise InvalidModel(problems)
        self._set(length=L, area=A, material=material)
        with np.errstate(all="ignore"):
            derived = (self.impedance, self.transit_time, self.mass)
        if not holds(good := in_range(*derived)):
            at, (long, wide) = first_false(good, L, A)
            message = (
                f"a segment of length {long!r}, area {wide!r} and {material!r} has no finite, "
                "positive impedance, transit time and mass; use consistent units"
            )
            raise InvalidModel([(f"area{at}", message)])

    @property
    def wave_speed(self) -> Number:
        """Bar speed c, m/s."""
        return self.material.wave_speed

    @property
    def impedance(self) -> Number:
        """Z = rho A c, kg/s."""
        return self.material.density * self.area * self.material.wave_speed

    @property
    def transit_time(self) -> Number:
        """T = L/c, s."""
        return self.length / self.material.wave_speed

    @property
    def mass(self) -> Number:
        """Z T, kg."""
        return self.impedance * self.transit_time

    def to_dict(self) -> dict[str, Any]:  # noqa: D102
        return {name: plain(getattr(self, name)) for name in ("length", "area", "material")}


class Steps(Frozen):
    """A profile along a body that is constant between jumps.

    Parameters
    ----------
    values : sequence of numbers
        One value for each piece, from left to right.
    at : sequence of numbers
        Positions of the jumps, m from the left end of the body, increasing; one fewer than values.

    Raises
    ------
    InvalidModel
        When the counts do not fit, the positions do not increase, or a number is none.
    """

    values: tuple[Number, ...]
    at: tuple[Number, ...]

    def __init__(self, values: Any, at: Any) -> None:
        problems: Problems = []
        lists: dict[str, tuple[Number, ...]] = {}
        for name, items, sign in (("values", values, "any"), ("at", at, "positive")):
            if isinstance(items, str) or not np.iterable(items):
                problems.append((name, f"must be a list of numbers, got {items!r}"))
                items = ()
            lists[name] = tuple(
                number(problems, f"{name}.{i}", v, "", sign) for i, v in enumerate(items)
            )
        if not problems and len(lists["values"]) != len(lists["at"]) + 1:
            message = f"needs one value more than jumps, got {len(lists['values'])} values"
            problems.append(("values", f"{message} for {len(lists['at'])} jumps"))
        for i, (a, b) in enumerate(zip(lists["at"], lists["at"][1:], strict=False)):
            if not problems and not np.all(good := np.asarray(b) > a):
                at, (before, got) = first_false(good, a, b)
                problems.append((f"at.{i + 1}{at}", f"must lie right of {before!r}, got {got!r}"))
        if problems:
            raise InvalidModel(problems)
        self._set(**lists)

    def to_dict(self) -> dict[str, Any]:  # noqa: D102
        return {"values": plain(self.values), "at": plain(self.at)}


class Rod(Frozen):
    """An elastic rod, uniform or stepped.

    Give `length`, `area` and `material`, or `segments`.

    Parameters
    ----------
    length : float or array
        m.
    area : float or array
        Cross-section, m^2.
    material : Material
    segments : sequence of Segment
        Pieces of a stepped rod, from left to right.
    velocity : float, array or Steps
        Initial velocity, m/s.
    strain : float, array or Steps
        Initial strain, positive in tension.

    Raises
    ------
    InvalidModel
        Naming every field that is not what it should be.
    """

    segments: tuple[Segment, ...]
    velocity: Number | Steps
    strain: Number | Steps

    def __init__(
        self,
        length: Any = None,
        *,
        area: Any = None,
        material: Any = None,
        segments: Any = None,
        velocity: Any = 0.0,
        strain: Any = 0.0,
    ) -> None:
        problems: Problems = []
        pieces: tuple[Segment, ...] = ()
        if segments is None:
            try:
                pieces = (Segment(length, area, material),)
            except InvalidModel as error:
                problems += error.problems
        elif length is not None or area is not None or material is not None:
            message = "give either segments or length, area and material, not both"
            problems.append(("segments", message))
        elif isinstance(segments, list | tuple) and segments:
            for i, segment in enumerate(segments):
                if not isinstance(segment, Segment):
                    problems.append((f"segments.{i}", f"must be a Segment, got {segment!r}"))
            pieces = tuple(segments)
        else:
            message = f"must be a list of at least one Segment, got {segments!r}"
            problems.append(("segments", message))
        profiles = {}
        for name, value, unit in (("velocity", velocity, " of m/s"), ("strain", strain, "")):
            is_profile = isinstance(value, Steps)
            profiles[name] = value if is_profile else number(problems, name, value, unit)
        if not problems:
            total = sum(s.length for s in pieces)
            for name, value in profiles.items():
                jumps = value.at if isinstance(value, Steps) else ()
                if jumps and not np.all(good := np.asarray(jumps[-1]) < total):
                    at, (long, got) = first_false(good, total, jumps[-1])
                    message = f"must lie inside the rod of length {long!r}, got {got!r}"
                    problems.append((f"{name}.at.{len(jumps) - 1}{at}", message))
        if problems:
            raise InvalidModel(problems)
        self._set(segments=pieces, **profiles)

    @property
    def length(self) -> Number:
        """Length of all segments together, m."""
        return sum(s.length for s in self.segments)

    @property
    def mass(self) -> Number:
        """kg."""
        return sum(s.mass for s in self.segments)

    @property
    def transit_time(self) -> Number:
        """Time a wave takes from one end to the other, s."""
        return sum(s.transit_time for s in self.segments)

    def to_dict(self) -> dict[str, Any]:  # noqa: D102
        shape = (
            self.segments[0].to_dict()
            if len(self.segments) == 1
            else {"segments": plain(self.segments)}
        )
        moving = {"velocity": plain(self.velocity), "strain": plain(self.strain)}
        return {"kind": "rod", **shape, **moving}

    def __repr__(self) -> str:
        if len(self.segments) > 1:
            return super().__repr__()
        piece = repr(self.segments[0])[len("Segment(") : -1]
        return f"Rod({piece}, velocity={short(self.velocity)}, strain={short(self.strain)})"


class Wall(Frozen):
    """An immovable body, or one that keeps its velocity whatever hits it.

    Parameters
    ----------
    velocity : float or array
        m/s.
    """

    velocity: Number

    def __init__(self, velocity: Any = 0.0) -> None:
        problems: Problems = []
        v = number(problems, "velocity", velocity, " of m/s")
        if problems:
            raise InvalidModel(problems)
        self._set(velocity=v)

    def to_dict(self) -> dict[str, Any]:  # noqa: D102
        return {"kind": "wall", "velocity": plain(self.velocity)}


class Rigid(Frozen):
    """Unilateral contact without compliance: gap >= 0, force >= 0, force times gap = 0."""

    law: ClassVar[str] = "rigid"

    def to_dict(self) -> dict[str, Any]:  # noqa: D102
        return {"law": self.law}


class Bonded(Frozen):
    """Two neighbours joined for good: they share velocity and force, in tension too."""

    law: ClassVar[str] = "bonded"

    def to_dict(self) -> dict[str, Any]:  # noqa: D102
        return {"law": self.law}


Body: TypeAlias = Rod | Wall
ContactLaw: TypeAlias = Rigid | Bonded
CONTACT_LAWS: dict[str, type[ContactLaw]] = {law.law: law for law in (Rigid, Bonded)}


class System(Frozen):
    """A row of bodies from left to right.

    Parameters
    ----------
    bodies : sequence of Rod or Wall
        A wall may stand only at the ends of the row.
    gaps : sequence of numbers, optional
        Initial distance between each body and its right neighbour, m, walls counted; default 0.
    contacts : sequence of contact laws, optional
        What acts between each body and its right neighbour, walls counted; default `Rigid`.

    Raises
    ------
    InvalidModel
        Naming every field that is not what it should be.

    Examples
    --------
    >>> steel = Material("steel", youngs_modulus=200e9, density=7850)
    >>> rod = Rod(0.4, area=1e-4, material=steel, velocity=[1.0, 2.0, 3.0])
    >>> System([rod, Wall()]).shape
    (3,)
    """

    bodies: tuple[Body, ...]
    gaps: tuple[Number, ...]
    contacts: tuple[ContactLaw, ...]
    _shape: tuple[int, ...]

    def __init__(self, bodies: Any, gaps: Any = None, contacts: Any = None) -> None:
        problems: Problems = []
        if not isinstance(bodies, list | tuple) or not bodies:
            raise InvalidModel([("bodies", f"must be a list of at least one rod, got {bodies!r}")])
        for i, body in enumerate(bodies):
            if not isinstance(body, Rod | Wall):
                problems.append((f"bodies.{i}", f"must be a Rod or a Wall, got {body!r}"))
            elif isinstance(body, Wall) and 0 < i < len(bodies) - 1:
                message = "a wall may stand only at an end of the row; make two systems of this one"
                problems.append((f"bodies.{i}", message))
        if not problems and not any(isinstance(body, Rod) for body in bodies):
            problems.append(("bodies", "needs at least one rod between the walls"))
        pairs = len(bodies) - 1
        gaps = _per_pair(problems, "gaps", gaps, 0.0, pairs)
        contacts = _per_pair(problems, "contacts", contacts, RIGID, pairs)
        widths = tuple(
            number(problems, f"gaps.{i}", gap, " of metres", "non-negative")
            for i, gap in enumerate(gaps)
        )
        for i, law in enumerate(contacts):
            if not isinstance(law, Rigid | Bonded):
                problems.append((f"contacts.{i}", f"must be Rigid() or Bonded(), got {law!r}"))
            elif isinstance(law, Bonded) and i < len(widths) and np.any(widths[i]):
                at, (got,) = first_false(np.asarray(widths[i]) == 0, widths[i])
                message = f"must be 0 where bodies are bonded, got {got!r}"
                problems.append((f"gaps.{i}{at}", message))
        if problems:
            raise InvalidModel(problems)
        self._set(bodies=tuple(bodies), gaps=widths, contacts=tuple(contacts))
        shapes = [v.shape for _, v in self._numbers() if isinstance(v, np.ndarray)]
        try:
            shape = np.broadcast_shapes(*shapes) if shapes else ()
        except ValueError:
            message = "arrays of the family do not broadcast: " + ", ".join(
                f"{path} has shape {v.shape}" for path, v in self.parameters.items()
            )
            raise InvalidModel([(next(iter(self.parameters)), message)]) from None
        self._set(_shape=shape)

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the family; () for a single collision."""
        return self._shape

    @property
    def parameters(self) -> dict[str, Any]:
        """Numbers in which the members of a family differ, by the paths of a case file.

        Arrays as they were given: they broadcast to `shape`.
        """
        return {path: v for path, v in self._named_numbers() if isinstance(v, np.ndarray)}

    def _named_numbers(self) -> list[tuple[str, Number]]:
        """Every number with the path that it has in a case file."""
        found = []
        for path, value in self._numbers():
            kind, i, *rest = path.split(".")
            body = self.bodies[int(i)]
            if kind == "gaps":
                path = f"contacts.{i}.gap"
            elif isinstance(body, Rod) and rest[0] == "segments" and len(body.segments) == 1:
                path = ".".join([kind, i, *rest[2:]])
            found.append((path, value))
        return found

    def __getitem__(self, index: Any) -> System:
        """Member of a family, or a smaller family, by NumPy's rules of indexing."""
        member = self._member(self.shape, index)
        member._set(_shape=np.broadcast_shapes(
            *(v.shape for _, v in member._numbers() if isinstance(v, np.ndarray))
        ))
        return member

    def to_dict(self) -> dict[str, Any]:  # noqa: D102
        contacts = [
            {"gap": plain(gap), **law.to_dict()}
            for gap, law in zip(self.gaps, self.contacts, strict=True)
        ]
        return {"bodies": plain(self.bodies), "contacts": contacts}

    @classmethod
    def from_dict(cls, data: dict[str, Any]) -> System:
        """Make the system that `to_dict` described."""
        return cls(
            [_body(body) for body in data["bodies"]],
            gaps=[contact["gap"] for contact in data["contacts"]],
            contacts=[CONTACT_LAWS[contact["law"]]() for contact in data["contacts"]],
        )

    def reversed(self) -> System:
        """Return the same state with every velocity turned round: the film run backwards."""
        bodies = [
            Wall(-body.velocity)
            if isinstance(body, Wall)
            else Rod(segments=body.segments, velocity=_negative(body.velocity), strain=body.strain)
            for body in self.bodies
        ]
        return System(bodies, self.gaps, self.contacts)

    def mirrored(self) -> System:
        """Return the row seen in a mirror: right becomes left."""
        bodies: list[Body] = [
            Wall(-body.velocity)
            if isinstance(body, Wall)
            else Rod(
                segments=body.segments[::-1],
                velocity=_negative(_flipped(body.velocity, body.length)),
                strain=_flipped(body.strain, body.length),
            )
            for body in reversed(self.bodies)
        ]
        return System(bodies, self.gaps[::-1], self.contacts[::-1])


RIGID = Rigid()


def _per_pair(problems: Problems, name: str, items: Any, default: Any, pairs: int) -> Any:
    if items is None:
        return (default,) * pairs
    if not isinstance(items, list | tuple):
        message = f"must be a list with one entry for each neighbouring pair, got {items!r}"
        problems.append((name, message))
        return ()
    if len(items) != pairs:
        message = f"needs one entry for each of the {pairs} neighbouring pairs, got {len(items)}"
        problems.append((name, message))
    return items


def _negative(profile: Number | Steps) -> Number | Steps:
    if isinstance(profile, Steps):
        return Steps([-v for v in profile.values], profile.at)
    return -profile


def _flipped(profile: Number | Steps, length: Number) -> Number | Steps:
    if not isinstance(profile, Steps):
        return profile
    at = [length - x for x in profile.at[::-1]]
    # next to the other end two places may round to one; the piece between them has no width
    edges = [0.0, *at, length]
    kept = [i for i, (a, b) in enumerate(pairwise(edges)) if np.any(np.asarray(b) > a)]
    return Steps([profile.values[::-1][i] for i in kept], [edges[i] for i in kept[1:]])


def _body(data: dict[str, Any]) -> Body:
    if data["kind"] == "wall":
        return Wall(data["velocity"])
    profiles = {
        name: Steps(**data[name]) if isinstance(data[name], dict) else data[name]
        for name in ("velocity", "strain")
    }
    pieces = data.get("segments", [data])
    return Rod(segments=[_segment(piece) for piece in pieces], **profiles)


def _segment(data: dict[str, Any]) -> Segment:
    return Segment(data["length"], data["area"], Material(**data["material"]))
