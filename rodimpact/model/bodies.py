"""What a row is made of: rods of elastic material, rigid masses and walls.

Axis x points to the right; velocity is positive to the right, strain positive in tension; SI units.
Any number may be an array, which makes a family.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import KW_ONLY
from itertools import pairwise
from typing import Any, ClassVar, TypeAlias, get_args

import numpy as np
from numpy.typing import ArrayLike

from ..units import shown
from . import frozen, profiles
from .arguments import array, broadcast_arguments, demand, of_kind, whole
from .frozen import (
    Declared,
    Frozen,
    Number,
    Numeric,
    NumericOrNone,
    Problems,
    Taken,
    quantity,
)
from .lateral_inertia import MINDLIN_HERRMANN, RAYLEIGH_LOVE, THEORIES
from .profiles import Floats, Profile, ProfileLike, Samples, Steps

NOTHING: Any = None
Area: TypeAlias = "Taken[Number | Samples, ProfileLike | None]"
Moment: TypeAlias = "Taken[Number | str | None, ArrayLike | str | None]"
MOST_STEPS = 100_000  # of a taper
CIRCULAR = "circular"  # the cross-section is a solid disc


class Material(Declared):
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
        nu, between -1 and 0.5, for rods with `lateral_inertia`, for exact waves in round bars
        (`rodimpact.waves`), and for `Hertz.from_radii`; other waves do not depend on it.
    viscosity : float or array
        Kelvin-Voigt viscosity eta of sigma = E eps + eta d(eps)/dt, Pa s; `damped` finds it from a
        loss factor. Only the method "finite-difference" takes other than 0.

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
    _: KW_ONLY
    youngs_modulus: Numeric = quantity("Pa", "positive", "Young's modulus")
    density: Numeric = quantity("kg/m^3", "positive")
    poisson_ratio: NumericOrNone = quantity(
        "", "(-1, 0.5]", "Poisson's ratio", default=None
    )
    viscosity: Numeric = quantity("Pa s", "non-negative", default=0.0)

    def _check(self, problems: Problems) -> None:
        if not isinstance(self.name, str) or not self.name:
            problems.insert(0, ("name", f"must be a word, got {shown(self.name)}"))
        if not problems:
            E, rho = self.youngs_modulus, self.density
            message = "gives no finite wave speed with density {1!r}, got {0!r}"
            frozen.require(
                problems, frozen.in_range(E / rho), "youngs_modulus", message, E, rho
            )

    def to_dict(self) -> dict[str, Any]:  # noqa: D102
        described = super().to_dict()
        described.setdefault("poisson_ratio", None)  # as digests on disk have it
        return described

    @property
    def wave_speed(self) -> Number:
        """Bar speed c = sqrt(E/rho), m/s."""
        ratio = self.youngs_modulus / self.density
        return math.sqrt(ratio) if isinstance(ratio, float) else np.sqrt(ratio)

    def damped(self, loss_factor: ArrayLike, frequency: ArrayLike) -> Material:
        """Return the same material with the viscosity that gives it a loss factor.

        eta = E tan(delta)/(2 pi f): the loss factor tan(delta) of a Kelvin-Voigt material is
        proportional to frequency, so a measured one holds at its own frequency and near it.

        Parameters
        ----------
        loss_factor : float or array
            tan(delta), of a stress that oscillates and the strain that follows it, 1.
        frequency : float or array
            f at which it is this, Hz.

        Returns
        -------
        Material

        Raises
        ------
        InvalidModel
            If the loss factor is negative or the frequency not positive.

        Examples
        --------
        >>> rubber = Material("rubber", youngs_modulus=5e6, density=1100)
        >>> round(rubber.damped(loss_factor=0.1, frequency=1e3).viscosity, 3)
        79.577
        """
        tangent, f, E = broadcast_arguments(
            loss_factor=(loss_factor, "", "non-negative"),
            frequency=(frequency, "Hz", "positive"),
            youngs_modulus=(self.youngs_modulus, "Pa", ""),
        )
        with np.errstate(
            all="ignore"
        ):  # what is out of range, the material will refuse
            return self.replace(viscosity=E * tangent / (2 * math.pi * f))


class Segment(Declared):
    """A piece of rod of one material: uniform, or tapered.

    Parameters
    ----------
    length : float or array
        m.
    area : float, array, Samples or function
        Cross-section, m^2. `Samples` make the segment tapered; so does a function of the distance
        from its left end, m, which is sampled at 1025 places from end to end.
    material : Material
    diameter : float or array
        Of a solid round section, m, in place of the area.
    polar_moment : float, array or "circular", optional
        Polar second moment I_p of the cross-section about the axis, m^4, for lateral inertia.
        ``"circular"`` is that of a solid round section, I_p = A^2/(2 pi), along a taper too. A
        diameter says the same, and takes no other.
    lateral_inertia : "rayleigh-love" or "mindlin-herrmann", optional
        Theory of the motion sideways; None: this motion has no inertia. See
        `rodimpact.model.lateral_inertia`. It needs a diameter or a polar moment, and a material
        with a `poisson_ratio`.

    Raises
    ------
    InvalidModel
        Naming every field that is not what it should be.

    Examples
    --------
    >>> steel = Material("steel", youngs_modulus=200e9, density=7850)
    >>> wedge = Segment(0.5, Samples([1e-4, 3e-4]), steel)
    >>> wedge.tapered, round(wedge.mass, 6)
    (True, 0.785)
    >>> wedge.area_between([0.0, 0.25, 0.5]).round(9).tolist()
    [0.00015, 0.00025]
    """

    _instead: ClassVar[dict[str, tuple[str, ...]]] = {
        "diameter": ("area",),
        "area": ("diameter",),
    }
    length: Numeric = quantity("m", "positive")
    area: Area = quantity("m^2", "positive", default=None, along="length")
    material: Taken[Material, Material | None] = NOTHING
    _: KW_ONLY
    diameter: NumericOrNone = quantity("m", "positive", default=None)
    polar_moment: Moment = quantity("m^4", "positive", default=None, word=CIRCULAR)
    lateral_inertia: str | None = None

    def _check(self, problems: Problems) -> None:
        held = self.__dict__
        L, material, area = held["length"], held["material"], held["area"]
        if self.diameter is not None:
            if area is not None:
                problems.append(("diameter", "give either area or diameter, not both"))
            area = 1.0 if problems else math.pi * self.diameter * self.diameter / 4
        if area is None:
            problems.append(
                ("area", "is missing; give it, or the diameter of a round rod")
            )
        elif isinstance(area, Steps):
            message = "jumps inside a segment; give Rod(area=Steps(...)), or a segment for each"
            problems.append(("area", f"{message} of its values"))
        else:
            known = None if problems else L
            area = profiles.along_rod(
                problems, "area", area, self.fields["area"], known
            )
        self._set(area=area)
        if self.lateral_inertia is not None or self.polar_moment is not None:
            self._check_inertia(problems)
        of_kind("material", material, Material, "materials.steel")
        frozen.raise_noted(problems)
        if isinstance(area, Samples):
            for bound in profiles.extremes(area):
                Segment(L, bound, material)
            return
        if self._varies:
            frozen.family_shape(self._numbers())
        c = material.wave_speed
        with np.errstate(all="ignore"):
            Z, T = material.density * area * c, L / c
            good = frozen.in_range(Z) & frozen.in_range(T) & frozen.in_range(Z * T)
        if good is not True:
            message = (
                "length {0!r} and area {1!r} of this material make an impedance, a transit time or "
                f"a mass outside {frozen.SMALLEST:g} to {frozen.LARGEST:g}; use consistent units"
            )
            demand(
                good, "area" if self.diameter is None else "diameter", message, L, area
            )

    def _check_inertia(self, problems: Problems) -> None:
        """Note what is wrong with the theory of the motion sideways, and what it lacks."""
        theory, moment, material = (
            self.lateral_inertia,
            self.polar_moment,
            self.material,
        )
        said_round = self.diameter is not None
        if not isinstance(moment, str | None) and (said_round or self.tapered):
            message = (
                f'must be "{CIRCULAR}" along a taper and with a diameter, or left out'
            )
            frozen.note(problems, "polar_moment", message, moment)
        if theory is None:
            message = f'has no effect by itself; give lateral_inertia="{RAYLEIGH_LOVE}" too, or '
            problems.append(("polar_moment", f"{message}leave polar_moment out"))
        elif moment is None and not said_round:
            message = (
                "needs the diameter of a round rod, or a polar_moment; give one of them"
            )
            problems.append(("lateral_inertia", message))
        elif not isinstance(theory, str) or theory not in THEORIES:
            message = (
                f"unknown theory {shown(theory)}; {frozen.nearest(theory, THEORIES)}"
            )
            problems.append(("lateral_inertia", message))
        elif isinstance(material, Material):
            nu, path = material.poisson_ratio, "material.poisson_ratio"
            if nu is None:
                message = f"is missing in {shown(material.name)}; lateral inertia needs it: give "
                problems.append(
                    (path, f"{message}the material one, or leave lateral_inertia out")
                )
            elif theory == MINDLIN_HERRMANN:
                message = f'must be below 0.5 for "{theory}", got {{0!r}}'
                frozen.require(problems, nu < 0.5, path, message, nu)
        if said_round:
            self._set(polar_moment=None)  # the diameter says it

    def _parameters(self) -> dict[str, Any]:
        given = super()._parameters()
        if self.diameter is not None:
            del given["area"]
        return given

    @property
    def solid_round(self) -> bool:
        """Whether the section is said to be a solid disc."""
        return self.diameter is not None or isinstance(self.polar_moment, str)

    @property
    def tapered(self) -> bool:
        """Whether the area varies along the segment."""
        return isinstance(self.area, Samples)

    @property
    def ideal(self) -> bool:
        """Whether waves keep their shape: no taper, no viscosity, no lateral inertia."""
        damped = np.any(self.material.viscosity)
        return not (self.tapered or self.lateral_inertia is not None or damped)

    @property
    def wave_speed(self) -> Number:
        """Bar speed c, m/s."""
        return self.material.wave_speed

    @property
    def impedance(self) -> Number:
        """Z = rho A c, kg/s.

        Raises
        ------
        ValueError
            If the segment is tapered: the impedance varies along it.
        """
        if isinstance(self.area, Samples):
            raise ValueError(
                "the impedance varies along a tapered segment; take those of rod.in_steps(n)"
            )
        return self.material.density * self.area * self.material.wave_speed

    @property
    def transit_time(self) -> Number:
        """T = L/c, s."""
        return self.length / self.material.wave_speed

    @property
    def mass(self) -> Number:
        """Integral of rho A dx, kg; exact for straight lines between samples."""
        if isinstance(self.area, Samples):
            return self.material.density * self._mean_areas(1)[0] * self.length
        return self.impedance * self.transit_time

    def area_between(self, edges: ArrayLike) -> Floats:
        """Mean areas between places; exact for straight lines between samples.

        Parameters
        ----------
        edges : [n + 1] array
            Increasing places, m from the left end of the segment.

        Returns
        -------
        [n] array
            m^2.

        Raises
        ------
        ValueError
            If these are not two places or more.
        """
        places = array("edges", edges, "m")
        if places.ndim != 1 or places.size < 2:
            raise ValueError(
                f"edges: must be two places or more in a row, got {shown(edges)}"
            )
        return profiles.averages(self.area, places, float(self.length))

    def polar_moments(self, areas: ArrayLike) -> Floats:
        """Polar second moments of the segment where its cross-section has these areas.

        Parameters
        ----------
        areas : array
            m^2.

        Returns
        -------
        array
            m^4, of the same shape; 0 without lateral inertia.
        """
        A = array("areas", areas, "m^2")
        if self.lateral_inertia is None:
            return np.zeros(A.shape)
        return (
            A**2 / (2 * math.pi)
            if self.solid_round
            else np.full(A.shape, self.polar_moment)
        )

    def mirrored(self) -> Segment:
        """Return the segment seen in a mirror."""
        if not self.tapered:
            return self
        return self.replace(area=profiles.flipped(self.area, self.length))

    def in_steps(self, n: int) -> list[Segment]:
        """Uniform segments of equal lengths, each of the volume of its piece of the taper.

        A uniform segment stays as it is.
        """
        if not self.tapered:
            return [self]
        return [
            self.replace(length=self.length / n, area=area)
            for area in self._mean_areas(n)
        ]

    def _mean_areas(self, n: int) -> list[float]:
        """Mean areas of `n` pieces of equal length, whatever that is, m^2."""
        edges = np.linspace(0.0, 1.0, n + 1)
        return profiles.averages(self.area, edges, 1.0).tolist()  # type: ignore[no-any-return]


class Rod(Frozen, kind="rod"):
    """An elastic rod: uniform, stepped or tapered.

    Give `length`, `area` or `diameter`, and `material`; or `segments`.

    Parameters
    ----------
    length : float or array
        m.
    area : float, array, Steps, Samples or function
        Cross-section, m^2. `Steps` make a stepped rod, with a segment for each value; `Samples`, or
        a function of the distance from the left end, m, a tapered one.
    material : Material
    diameter : float or array
        Of a solid round section, m, in place of the area.
    polar_moment : float, array or "circular", optional
        m^4, for lateral inertia, as in `Segment`.
    lateral_inertia : "rayleigh-love" or "mindlin-herrmann", optional
        As in `Segment`.
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

    Examples
    --------
    >>> from rodimpact.materials import brass, steel
    >>> round(Rod(0.4, area=1e-4, material=steel).mass, 6)
    0.314
    >>> stepped = Rod(0.4, area=Steps([1e-4, 2e-4], at=[0.1]), material=steel)
    >>> [segment.area for segment in stepped.segments]
    [0.0001, 0.0002]
    >>> two = Rod(segments=[Segment(0.1, 1e-4, steel), Segment(0.2, 1e-4, brass)])
    >>> round(two.length, 12)
    0.3
    """

    _instead: ClassVar[dict[str, tuple[str, ...]]] = {
        **Segment._instead,
        "segments": tuple(frozen.defaults_of(Segment)),
    }
    segments: tuple[Segment, ...]
    velocity: Profile = quantity("m/s", default=0.0, along="length")
    strain: Profile = quantity(default=0.0, along="length")

    def __init__(
        self,
        length: ArrayLike | None = None,
        *,
        area: ProfileLike | None = None,
        diameter: ArrayLike | None = None,
        material: Material | None = None,
        polar_moment: ArrayLike | str | None = None,
        lateral_inertia: str | None = None,
        segments: Sequence[Segment] | None = None,
        velocity: ProfileLike = 0.0,
        strain: ProfileLike = 0.0,
    ) -> None:
        problems: Problems = []
        pieces: tuple[Segment, ...] = ()
        shape: dict[str, Any] = {
            "length": length,
            "area": area,
            "diameter": diameter,
            "material": material,
            "polar_moment": polar_moment,
            "lateral_inertia": lateral_inertia,
        }
        try:
            if segments is not None:
                pieces = _joined(segments, shape)
            elif isinstance(area, Steps):
                pieces = _between_jumps(area, shape)
            else:
                pieces = (Segment(**shape),)
        except frozen.InvalidModel as error:
            problems += error.problems
        if len(pieces) > 1:
            frozen.family_shape(
                (f"segments.{i}.length", s.length) for i, s in enumerate(pieces)
            )
        total = None if problems else sum(s.length for s in pieces)
        v = profiles.along_rod(
            problems, "velocity", velocity, self.fields["velocity"], total
        )
        e = profiles.along_rod(problems, "strain", strain, self.fields["strain"], total)
        frozen.raise_noted(problems)
        self._set(segments=pieces, velocity=v, strain=e)

    def _parameters(self) -> dict[str, Any]:
        if len(self.segments) > 1:
            return super()._parameters()
        shape = self.segments[0]._parameters()
        return {**shape, "velocity": self.velocity, "strain": self.strain}

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

    @property
    def tapered(self) -> bool:
        """Whether the area of any segment varies along it."""
        return any(s.tapered for s in self.segments)

    def in_steps(self, n: int) -> Rod:
        """Return the rod with uniform pieces in place of every taper.

        Parameters
        ----------
        n : int
            Pieces of each tapered segment: of equal lengths, and each of the volume, and so of the
            mass, of its piece of the taper. Uniform segments stay as they are.

        Returns
        -------
        Rod
            Stepped, with the same velocity and strain.

        Raises
        ------
        InvalidModel
            If `n` is not a positive whole number, or above 100,000.

        Examples
        --------
        >>> steel = Material("steel", youngs_modulus=200e9, density=7850)
        >>> cone = Rod(1.0, area=lambda x: 1e-4 * (1 + x) ** 2, material=steel)
        >>> steps = cone.in_steps(200)
        >>> len(steps.segments), abs(steps.mass / cone.mass - 1) < 1e-14
        (200, True)
        """
        count = whole("n", n, 1, MOST_STEPS)
        pieces = [
            piece for segment in self.segments for piece in segment.in_steps(count)
        ]
        return self.replace(segments=pieces)


def _joined(segments: Any, shape: dict[str, Any]) -> tuple[Segment, ...]:
    """Segments as given; InvalidModel also where the shape is told in another way, too."""
    if any(v is not None for v in shape.values()):
        message = (
            "give either segments or length, area, material and polar_moment, not both"
        )
        raise frozen.refusal("segments", message)
    if not isinstance(segments, list | tuple) or not segments:
        message = f"must be a list of at least one Segment, got {shown(segments)}"
        raise frozen.refusal("segments", message)
    frozen.raise_noted(
        [
            (f"segments.{i}", f"must be a Segment, got {shown(segment)}")
            for i, segment in enumerate(segments)
            if not isinstance(segment, Segment)
        ]
    )
    return tuple(segments)


def _between_jumps(area: Steps, shape: dict[str, Any]) -> tuple[Segment, ...]:
    """Segments of a rod whose area jumps; InvalidModel with the mistakes of all."""
    problems: Problems = []
    pieces: list[Segment] = []
    L = Segment.fields["length"].checked(problems, "length", shape["length"])
    profiles.along_rod(
        problems, "area", area, Segment.fields["area"], None if problems else L
    )
    frozen.raise_noted(problems)
    ends = pairwise((0.0, *area.at, L))
    for i, (A, (start, end)) in enumerate(zip(area.values, ends, strict=True)):
        try:
            pieces.append(Segment(**{**shape, "length": end - start, "area": A}))
        except frozen.InvalidModel as error:
            problems += [
                (path.replace("area", f"area.values.{i}"), message)
                for path, message in error.problems
            ]
    frozen.raise_noted(problems)
    return tuple(pieces)


class RigidMass(Declared, kind="mass"):
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

    Examples
    --------
    >>> RigidMass(2.0, velocity=-1.0)
    RigidMass(mass=2.0, velocity=-1.0)
    """

    mass: Numeric = quantity("kg", "positive")
    _: KW_ONLY
    velocity: Numeric = quantity("m/s", default=0.0)


class Wall(Declared, kind="wall"):
    """An immovable body, or one that keeps its velocity whatever hits it.

    Parameters
    ----------
    velocity : float or array
        m/s.

    Examples
    --------
    A rod at rest is hit by a wall that comes at 1 m/s, and leaves at twice that:

    >>> import rodimpact as ri
    >>> rod = ri.Rod(0.4, area=1e-4, material=ri.materials.steel)
    >>> ri.solve(ri.System([ri.Wall(velocity=1.0), rod])).outcome.velocities_after
    (1.0, 2.0)
    """

    velocity: Numeric = quantity("m/s", default=0.0)


Body: TypeAlias = Rod | RigidMass | Wall
BODIES: dict[str, type[Body]] = {body.kind: body for body in get_args(Body)}
