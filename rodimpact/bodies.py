"""What a row is made of: rods of elastic material, rigid masses and walls.

Axis x points to the right; velocity is positive to the right, strain positive in tension; SI units.
Any number may be an array, which makes a family.
"""

from __future__ import annotations

import math
from typing import Any, TypeAlias

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
from .profiles import Profile, along_rod, profile_from


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
    velocity : float, array, Steps, Samples or function
        Initial velocity, m/s; a function of the distance from the left end, m, is sampled at 1025
        places from end to end.
    strain : float, array, Steps, Samples or function
        Initial strain, positive in tension; a function as for the velocity.

    Raises
    ------
    InvalidModel
        Naming every field that is not what it should be.
    """

    segments: tuple[Segment, ...]
    velocity: Profile
    strain: Profile

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
        total = None if problems else sum(s.length for s in pieces)
        profiles = {
            name: along_rod(problems, name, value, unit, total)
            for name, value, unit in (("velocity", velocity, " of m/s"), ("strain", strain, ""))
        }
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


class RigidMass(Frozen):
    """A body that moves as a whole: no wave runs through it.

    Parameters
    ----------
    mass : float or array
        kg.
    velocity : float or array
        Initial velocity, m/s.

    Raises
    ------
    InvalidModel
        Naming every field that is not what it should be.
    """

    mass: Number
    velocity: Number

    def __init__(self, mass: Any, *, velocity: Any = 0.0) -> None:
        problems: Problems = []
        m = number(problems, "mass", mass, " of kilograms", "positive")
        v = number(problems, "velocity", velocity, " of m/s")
        if problems:
            raise InvalidModel(problems)
        self._set(mass=m, velocity=v)

    def to_dict(self) -> dict[str, Any]:  # noqa: D102
        return {"kind": "mass", "mass": plain(self.mass), "velocity": plain(self.velocity)}


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


Body: TypeAlias = Rod | RigidMass | Wall


def body_from(data: dict[str, Any]) -> Body:
    """Make the body that `to_dict` described."""
    if data["kind"] == "wall":
        return Wall(data["velocity"])
    if data["kind"] == "mass":
        return RigidMass(data["mass"], velocity=data["velocity"])
    moving = {name: profile_from(data[name]) for name in ("velocity", "strain")}
    return Rod(segments=[_segment(piece) for piece in data.get("segments", [data])], **moving)


def _segment(data: dict[str, Any]) -> Segment:
    return Segment(data["length"], data["area"], Material(**data["material"]))
