"""The bodies of a row: rods of elastic material, rigid masses and walls.

Axis x points to the right; velocity is positive to the right, strain positive in
tension; SI units. Any number may be an array, which makes a family.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import KW_ONLY
from decimal import Decimal
from typing import Any, ClassVar, TypeAlias, get_args

import numpy as np
from numpy.typing import ArrayLike

from ..hints import explain_missing, nearest
from ..units import shown
from . import frozen, profiles
from .arguments import array, broadcast_arguments, check_kind, demand, integer
from .frozen import (
    Frozen,
    FrozenDataclass,
    Number,
    Numeric,
    NumericOrNone,
    Problems,
    TypedAttribute,
    quantity,
)
from .lateral_inertia import MINDLIN_HERRMANN, RAYLEIGH_LOVE, THEORIES
from .profiles import Floats, Profile, ProfileLike, Samples, Steps
from .shaft import Shaft, shaft_along_rod

LEFT_OUT: Any = None
"""Default of an argument that the check of its class replaces, or demands."""
Area: TypeAlias = "TypedAttribute[Number | Samples, ProfileLike | None]"
Moment: TypeAlias = "TypedAttribute[Number | str | None, ArrayLike | str | None]"
MAX_STEPS_PER_TAPER = 100_000
"""Number of uniform segments that may stand for a tapered one, at most."""
CIRCULAR = "circular"
"""Polar moment of a solid round section, in words."""
WAVE_SPEED = frozen.QuantityField("m/s", "positive")
"""Bar speed of a material, in place of its modulus."""


class Material(FrozenDataclass):
    """A linear elastic material.

    Parameters
    ----------
    name : str
        Name in tables and case files.
    youngs_modulus : float or array
        E, Pa.
    density : float or array
        rho, kg/m^3.
    wave_speed : float or array
        Bar speed c, m/s, in place of Young's modulus, which is rho c^2.
    poisson_ratio : float or array, optional
        nu, between -1 and 0.5. It is needed for rods with `lateral_inertia`, for exact
        waves in round bars (`rodimpact.waves`), and for `Hertz.from_radii`.
    viscosity : float or array
        Kelvin-Voigt viscosity eta of sigma = E eps + eta d(eps)/dt, Pa s. `damped`
        computes it from a loss factor. Only the method "finite-difference" solves rods
        with a viscosity above 0.

    Raises
    ------
    InvalidModel
        Naming every field that is not what it should be.

    Examples
    --------
    >>> steel = Material("steel", youngs_modulus=200e9, density=7850)
    >>> round(steel.wave_speed)
    5048
    >>> Material("my bar", wave_speed=5100.0, density=7850).youngs_modulus
    204178500000.0
    """

    _alternatives: ClassVar[dict[str, tuple[str, ...]]] = {
        "wave_speed": ("youngs_modulus",),
    }
    name: str
    _: KW_ONLY
    youngs_modulus: Numeric = quantity("Pa", "positive", "Young's modulus")
    density: Numeric = quantity("kg/m^3", "positive")
    poisson_ratio: NumericOrNone = quantity(
        "", "(-1, 0.5]", "Poisson's ratio", default=None
    )
    viscosity: Numeric = quantity("Pa s", "non-negative", default=0.0)

    def __init__(
        self,
        name: str,
        *,
        youngs_modulus: ArrayLike | None = None,
        density: ArrayLike,
        poisson_ratio: ArrayLike | None = None,
        viscosity: ArrayLike = 0.0,
        wave_speed: ArrayLike | None = None,
    ) -> None:
        """Set and check the numbers; a wave speed c gives the modulus E = rho c^2.

        Exactly one of E and c must be given. InvalidModel names the mistakes of all
        arguments. After a mistake in the choice of E and c, E itself is not checked.
        """
        problems: Problems = []
        modulus: Any = youngs_modulus
        if wave_speed is None and youngs_modulus is None:
            message = "is missing; give it, or the wave_speed"
            problems.append(("youngs_modulus", message))  # there is no value to show
        elif youngs_modulus is None:
            modulus = _modulus_of(problems, density, wave_speed)
        elif wave_speed is not None:
            message = (
                "give either youngs_modulus or wave_speed: with the density either "
                "follows from the other"
            )
            frozen.add_problem(problems, "wave_speed", message, wave_speed)
        if problems:
            # The modulus 1 lets the other arguments be checked too, so that one error
            # names all mistakes. A mistake that is found twice is reported once.
            modulus = 1.0
        self._set(
            name=name,
            youngs_modulus=modulus,
            density=density,
            poisson_ratio=poisson_ratio,
            viscosity=viscosity,
        )
        try:
            # The checks: a dataclass with a constructor of its own does not call them.
            self.__post_init__()
        except frozen.InvalidModel as error:
            problems += error.problems
        frozen.raise_if_problems(problems)

    def _check(self, problems: Problems) -> None:
        """Add a problem, before all others, if the name is no text or is empty.

        If there is no problem, E/rho, the square of the wave speed, is checked too: a
        value outside the range of the model is a problem of the modulus.
        """
        if not isinstance(self.name, str) or not self.name:
            # The name comes first in the constructor, so in the message too.
            problems.insert(0, ("name", f"must be a word, got {shown(self.name)}"))
        if problems:
            return
        E = self.youngs_modulus
        rho = self.density
        is_speed_in_range = frozen.in_range(E / rho)
        # {0!r} stands for the modulus, {1!r} for the density.
        message = "gives no finite wave speed with density {1!r}, got {0!r}"
        frozen.require(problems, is_speed_in_range, "youngs_modulus", message, E, rho)

    def to_dict(self) -> dict[str, Any]:  # noqa: D102
        description = super().to_dict()
        # Digests in saved files were computed from descriptions that always had this
        # entry.
        description.setdefault("poisson_ratio", None)
        return description

    @property
    def wave_speed(self) -> Number:
        """Bar speed c = sqrt(E/rho), m/s; an array if E or rho is one."""
        speed_squared = self.youngs_modulus / self.density
        if isinstance(speed_squared, float):
            return math.sqrt(speed_squared)
        return np.sqrt(speed_squared)

    def damped(self, loss_factor: ArrayLike, frequency: ArrayLike) -> Material:
        """Return the material with the viscosity of a given loss factor.

        eta = E tan(delta)/(2 pi f). The loss factor tan(delta) of a Kelvin-Voigt
        material is proportional to the frequency. So a measured loss factor is valid
        only near its frequency.

        Parameters
        ----------
        loss_factor : float or array
            tan(delta), 1; delta is the phase by which the strain lags behind the stress
            in an oscillation.
        frequency : float or array
            Frequency f of this loss factor, Hz.

        Returns
        -------
        Material

        Raises
        ------
        InvalidModel
            If the loss factor is negative, the frequency not positive, or the viscosity
            out of the range of the model.

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
        with np.errstate(all="ignore"):  # the material refuses what is out of range
            viscosity = E * tangent / (2 * math.pi * f)
        return self.replace(viscosity=viscosity)


def _modulus_of(problems: Problems, density: Any, wave_speed: Any) -> Any:
    """Young's modulus rho c^2, Pa; None if density or wave speed is wrong.

    Mistakes are added to `problems`, which must be empty. A modulus outside the range
    of the model also adds a mistake, but is returned. InvalidModel is raised if the
    arguments are arrays that do not broadcast.
    """
    rho = Material.fields["density"].checked(problems, "density", density)
    c = WAVE_SPEED.checked(problems, "wave_speed", wave_speed)
    if problems:
        return None
    # This raises if the two arrays do not broadcast.
    frozen.family_shape([("density", rho), ("wave_speed", c)])
    with np.errstate(all="ignore"):  # an overflow is refused below
        modulus = rho * c * c
    # {0!r} stands for the wave speed, {1!r} for the density: `require` fills in the
    # values of the first member that fails.
    message = "makes no finite Young's modulus with density {1!r}, got {0!r}"
    is_sound = frozen.in_range(modulus)
    frozen.require(problems, is_sound, "wave_speed", message, c, rho)
    return modulus


@explain_missing("material")
class Segment(FrozenDataclass):
    """A piece of rod of one material: uniform, or tapered.

    Parameters
    ----------
    length : float or array
        m.
    area : float, array, Samples or function
        Cross-sectional area, m^2. `Samples` define a tapered segment. A function of the
        distance from the left end, m, is sampled at 1025 points from end to end.
    material : Material
    diameter : float or array
        Diameter of a solid round section, m, in place of the area.
    polar_moment : float, array or "circular", optional
        Polar second moment I_p of the cross-section about the axis, m^4, for lateral
        inertia. ``"circular"`` means a solid round section, I_p = A^2/(2 pi), also
        along a taper. If a diameter is given, the section is round, and no polar moment
        may be given.
    lateral_inertia : "rayleigh-love" or "mindlin-herrmann", optional
        Theory of the lateral motion; None for no lateral inertia. See
        `rodimpact.model.lateral_inertia`. Lateral inertia needs a diameter or a polar
        moment, and a material with a `poisson_ratio`.

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

    _alternatives: ClassVar[dict[str, tuple[str, ...]]] = {
        "diameter": ("area",),
        "area": ("diameter",),
    }
    length: Numeric = quantity("m", "positive")
    area: Area = quantity("m^2", "positive", default=None, along="length")
    material: TypedAttribute[Material, Material | None] = LEFT_OUT
    _: KW_ONLY
    diameter: NumericOrNone = quantity("m", "positive", default=None)
    polar_moment: Moment = quantity("m^4", "positive", default=None, word=CIRCULAR)
    lateral_inertia: str | None = None

    def _check(self, problems: Problems) -> None:
        """Set the area, and refuse numbers that do not go together.

        The area is computed from a diameter, or sampled if it is a function.
        InvalidModel names all mistakes, also a material of another type. If there are
        none, InvalidModel is raised if arrays do not broadcast, or if impedance,
        transit time or mass is extreme. A taper is refused if a uniform segment of its
        smallest or largest area is refused.
        """
        area = self._checked_area(problems)
        self._set(area=area)
        if self.lateral_inertia is not None or self.polar_moment is not None:
            self._check_lateral_inertia(problems)
        check_kind("material", self.material, Material, "materials.steel")
        frozen.raise_if_problems(problems)
        if isinstance(area, Samples):
            # A taper is sound if uniform segments of its extreme areas are.
            for extreme in profiles.extremes(area):
                Segment(self.length, extreme, self.material)
            return
        if self._varies:
            # This raises an error if arrays do not broadcast, or make too many members.
            frozen.family_shape(self._numbers())
        self._check_magnitudes(area)

    def _checked_area(self, problems: Problems) -> Any:
        """Area as given and checked, or pi d^2/4 of the diameter, m^2.

        A function of the distance from the left end becomes `Samples`. A mistake is
        added to `problems`: also an area that is `Steps`, is missing, or is given
        beside a diameter. The returned area is then meaningless.
        """
        area: Any = self.area
        if self.diameter is not None:
            if area is not None:
                problems.append(("diameter", "give either area or diameter, not both"))
            area = 1.0  # after a mistake: a valid number, for the check below
            if not problems:
                area = math.pi * self.diameter * self.diameter / 4
        if area is None:
            message = "is missing; give it, or the diameter of a round rod"
            problems.append(("area", message))
        elif isinstance(area, Steps):
            message = (
                "jumps inside a segment; give Rod(area=Steps(...)), or a segment for "
                "each of its values"
            )
            problems.append(("area", message))
        else:
            length = None  # unknown after a mistake
            if not problems:
                length = self.length
            field = self.fields["area"]
            area = profiles.checked_along_rod(problems, "area", area, field, length)
        return area

    def _check_magnitudes(self, area: Number) -> None:
        """Refuse a uniform segment whose impedance, transit time or mass is extreme.

        InvalidModel if Z = rho A c, T = L/c or the mass Z T is outside the range of the
        model in any member of a family. The error names the area, or the diameter
        from which `area` follows.
        """
        L = self.length
        c = self.material.wave_speed
        with np.errstate(all="ignore"):
            Z = self.material.density * area * c
            T = L / c
            are_sound = frozen.in_range(Z) & frozen.in_range(T) & frozen.in_range(Z * T)
        if are_sound is True:  # of a single segment; of a family it is an array
            return
        message = (
            "length {0!r} and area {1!r} of this material make an impedance, a transit "
            f"time or a mass outside {frozen.SMALLEST:g} to {frozen.LARGEST:g}; use "
            "consistent units"
        )
        name = "area"
        if self.diameter is not None:
            name = "diameter"
        demand(are_sound, name, message, L, area)

    def _check_lateral_inertia(self, problems: Problems) -> None:
        """Add problems of the theory of lateral inertia and of the polar moment.

        It is called if one of the two is given. A theory needs a known name, a Poisson
        ratio, and a diameter or a polar moment. A polar moment needs a theory; it may
        not be a number along a taper or beside a diameter. A diameter implies
        "circular", so with a diameter the polar moment is set to None.
        """
        theory = self.lateral_inertia
        moment = self.polar_moment
        has_diameter = self.diameter is not None
        is_given_number = not isinstance(moment, str | None)  # neither a word nor None
        if is_given_number and (has_diameter or self.tapered):
            message = (
                f'must be "{CIRCULAR}" along a taper and with a diameter, or left out'
            )
            frozen.add_problem(problems, "polar_moment", message, moment)
        if theory is None:  # so a polar moment is given
            message = (
                f'has no effect by itself; give lateral_inertia="{RAYLEIGH_LOVE}" too, '
                "or leave polar_moment out"
            )
            problems.append(("polar_moment", message))
        elif moment is None and not has_diameter:
            message = (
                "needs the diameter of a round rod, or a polar_moment; give one of them"
            )
            problems.append(("lateral_inertia", message))
        elif not isinstance(theory, str) or theory not in THEORIES:
            message = f"unknown theory {shown(theory)}; {nearest(theory, THEORIES)}"
            problems.append(("lateral_inertia", message))
        elif isinstance(self.material, Material):
            self._check_poisson_ratio(problems)
        if has_diameter:
            self._set(polar_moment=None)

    def _check_poisson_ratio(self, problems: Problems) -> None:
        """Add a problem if the material has no Poisson ratio, which the theory needs.

        For Mindlin and Herrmann it must be below 0.5, in every member of a family.
        """
        material = self.material
        path = "material.poisson_ratio"
        if material.poisson_ratio is None:
            message = (
                f"is missing in {shown(material.name)}; lateral inertia needs it: give "
                "the material one, or leave lateral_inertia out"
            )
            problems.append((path, message))
        elif self.lateral_inertia == MINDLIN_HERRMANN:
            is_compressible = material.poisson_ratio < 0.5
            message = f'must be below 0.5 for "{MINDLIN_HERRMANN}", got {{0!r}}'
            frozen.require(
                problems, is_compressible, path, message, material.poisson_ratio
            )

    def _parameters(self) -> dict[str, Any]:
        """Parameters of the constructor, without the area if there is a diameter."""
        parameters = super()._parameters()
        if self.diameter is not None:
            del parameters["area"]
        return parameters

    @property
    def solid_round(self) -> bool:
        """Whether the section is said to be a solid disc."""
        if self.diameter is not None:
            return True
        return isinstance(self.polar_moment, str)  # "circular"

    @property
    def tapered(self) -> bool:
        """Whether the area varies along the segment."""
        return isinstance(self.area, Samples)

    @property
    def ideal(self) -> bool:
        """Whether waves keep their shape: no taper, viscosity or lateral inertia."""
        if self.tapered or self.lateral_inertia is not None:
            return False
        return not np.any(self.material.viscosity)

    @property
    def wave_speed(self) -> Number:
        """Bar speed c of its material, m/s."""
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
                "the impedance varies along a tapered segment; take those of "
                "rod.in_steps(n)"
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
            (mean_area,) = self._mean_areas(1)  # one piece, the whole segment
            return self.material.density * mean_area * self.length
        return self.impedance * self.transit_time  # rho A c L/c

    def area_between(self, edges: ArrayLike) -> Floats:
        """Mean areas between edges; exact for straight lines between samples.

        Parameters
        ----------
        edges : [n + 1] array
            Increasing distances from the left end of the segment, m.

        Returns
        -------
        [n] array
            m^2.

        Raises
        ------
        ValueError
            If there are not two edges or more. Their order is not checked.

        Examples
        --------
        >>> steel = Material("steel", youngs_modulus=200e9, density=7850)
        >>> wedge = Segment(0.5, Samples([1e-4, 3e-4]), steel)
        >>> wedge.area_between([0.0, 0.25, 0.5]).round(9).tolist()
        [0.00015, 0.00025]
        """
        x = array("edges", edges, "m")
        if x.ndim != 1 or x.size < 2:
            raise ValueError(
                f"edges: must be two places or more in a row, got {shown(edges)}"
            )
        return profiles.averages(self.area, x, float(self.length))

    def polar_moments(self, areas: ArrayLike) -> Floats:
        """Polar second moments of the segment where its cross-section has these areas.

        I_p = A^2/(2 pi) for a solid round section, else the given polar moment.

        Parameters
        ----------
        areas : array
            A, m^2.

        Returns
        -------
        array
            I_p, m^4, of the same shape; 0 without lateral inertia.

        Raises
        ------
        ValueError
            If an area is no number.

        Examples
        --------
        >>> steel = Material("s", youngs_modulus=2e11, density=8e3, poisson_ratio=0.29)
        >>> round_rod = Segment(
        ...     1.0, diameter=0.1, material=steel, lateral_inertia="rayleigh-love"
        ... )
        >>> round_rod.polar_moments([round_rod.area]).round(12).tolist()  # pi d^4/32
        [9.817477e-06]
        """
        A = array("areas", areas, "m^2")  # unchecked: an area may be nan
        if self.lateral_inertia is None:
            return np.zeros(A.shape)
        if self.solid_round:
            return A**2 / (2 * math.pi)
        return np.full(A.shape, self.polar_moment)

    def mirrored(self) -> Segment:
        """Return the segment with left and right exchanged: itself if it is uniform.

        Returns
        -------
        Segment

        Examples
        --------
        >>> steel = Material("steel", youngs_modulus=200e9, density=7850)
        >>> wedge = Segment(0.5, Samples([1e-4, 3e-4]), steel)
        >>> wedge.mirrored().area.values.tolist()
        [0.0003, 0.0001]
        """
        if not self.tapered:
            return self
        return self.replace(area=profiles.flipped(self.area, self.length))

    def in_steps(self, n: int) -> list[Segment]:
        """Uniform segments of equal lengths that stand for a taper.

        Parameters
        ----------
        n : int
            Number of segments; a uniform segment is returned alone, as it is.

        Returns
        -------
        list of Segment
            Each has the volume of its piece of the taper.

        Raises
        ------
        InvalidModel
            If `n` is not a positive whole number, or above 100,000.

        Examples
        --------
        >>> steel = Material("steel", youngs_modulus=200e9, density=7850)
        >>> wedge = Segment(0.5, Samples([1e-4, 3e-4]), steel)
        >>> [round(segment.area, 9) for segment in wedge.in_steps(2)]
        [0.00015, 0.00025]
        """
        count = integer("n", n, low=1, high=MAX_STEPS_PER_TAPER)
        if not self.tapered:
            return [self]
        length = self.length / count
        steps = []
        for area in self._mean_areas(count):
            steps.append(self.replace(length=length, area=area))
        return steps

    def _mean_areas(self, n: int) -> list[float]:
        """Mean areas of `n` pieces of equal length, m^2."""
        edges = np.linspace(0.0, 1.0, n + 1)  # fractions of the length
        areas: list[float] = profiles.averages(self.area, edges, 1.0).tolist()
        return areas


@explain_missing("segments")
class Rod(Frozen, kind="rod"):
    """An elastic rod: uniform, stepped or tapered.

    Give `length`, `area` or `diameter`, and `material`; or `segments`.

    Parameters
    ----------
    length : float or array
        m.
    area : float, array, Steps, Samples or function
        Cross-sectional area, m^2. `Steps` define a stepped rod, with a segment for each
        value. `Samples`, or a function of the distance from the left end, m, define a
        tapered rod.
    material : Material
    diameter : float or array
        Diameter of a solid round section, m, in place of the area.
    polar_moment : float, array or "circular", optional
        Polar second moment of the cross-section, m^4, for lateral inertia; see
        `Segment`.
    lateral_inertia : "rayleigh-love" or "mindlin-herrmann", optional
        Theory of the lateral motion; see `Segment`.
    segments : sequence of Segment
        Pieces of a stepped rod, from left to right.
    velocity : float, array, Steps, Samples or function
        Initial velocity, m/s; a function of the distance from the left end, m, is
        sampled at 1025 points from end to end.
    strain : float, array, Steps, Samples or function
        Initial strain, positive in tension; a function is sampled in the same way.
    shaft : Soil or Drag, optional
        Soil or drag that resists the motion along the rod, for the method
        "finite-difference".

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

    _alternatives: ClassVar[dict[str, tuple[str, ...]]] = {
        **Segment._alternatives,
        "segments": tuple(frozen.defaults_of(Segment)),
    }
    segments: tuple[Segment, ...]
    velocity: Profile = quantity("m/s", default=0.0, along="length")
    strain: Profile = quantity(default=0.0, along="length")
    shaft: Shaft | None

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
        shaft: Shaft | None = None,
    ) -> None:
        """Check and set the segments, the velocity, the strain and the shaft.

        Functions of the distance from the left end become `Samples`. Without `segments`
        the shape (length, area and the other arguments of `Segment`) makes one segment,
        or one for each value of an area that is `Steps`. InvalidModel names the
        mistakes of all arguments, or only the lengths of segments if these do not
        broadcast.
        """
        problems: Problems = []
        shape = {
            "length": length,
            "area": area,
            "diameter": diameter,
            "material": material,
            "polar_moment": polar_moment,
            "lateral_inertia": lateral_inertia,
        }
        pieces: tuple[Segment, ...] = ()
        try:
            pieces = _segments(segments, shape)
        except frozen.InvalidModel as error:
            problems += error.problems
        if len(pieces) > 1:
            lengths = []
            for i, segment in enumerate(pieces):
                lengths.append((f"segments.{i}.length", segment.length))
            frozen.family_shape(lengths)  # raises if these lengths make no family
        total: Number | None = None  # faulty segments leave the length unknown
        if not problems:
            total = sum(segment.length for segment in pieces)
        velocity_field = self.fields["velocity"]
        strain_field = self.fields["strain"]
        v = profiles.checked_along_rod(
            problems, "velocity", velocity, velocity_field, total
        )
        epsilon = profiles.checked_along_rod(
            problems, "strain", strain, strain_field, total
        )
        checked_shaft = _checked_shaft(problems, shaft, total)
        frozen.raise_if_problems(problems)
        self._set(segments=pieces, velocity=v, strain=epsilon, shaft=checked_shaft)

    def _parameters(self) -> dict[str, Any]:
        """Parameters of the constructor that make an equal rod, also those at None.

        A rod of one segment takes the parameters of that segment in place of
        `segments`. Velocity, strain and shaft are among them in any case.
        """
        if len(self.segments) > 1:
            return super()._parameters()
        parameters = self.segments[0]._parameters()
        parameters["velocity"] = self.velocity
        parameters["strain"] = self.strain
        parameters["shaft"] = self.shaft
        return parameters

    @property
    def length(self) -> Number:
        """Length of all segments together, m."""
        return sum(segment.length for segment in self.segments)

    @property
    def mass(self) -> Number:
        """Mass of all segments together, kg."""
        return sum(segment.mass for segment in self.segments)

    @property
    def transit_time(self) -> Number:
        """Time that a wave takes from one end to the other, s."""
        return sum(segment.transit_time for segment in self.segments)

    @property
    def tapered(self) -> bool:
        """Whether the area of any segment varies along it."""
        return any(segment.tapered for segment in self.segments)

    def in_steps(self, n: int) -> Rod:
        """Return the rod with uniform pieces in place of every taper.

        Parameters
        ----------
        n : int
            Number of pieces of each tapered segment. The pieces have equal lengths.
            Each piece has the volume, and so the mass, of its part of the taper.
            Uniform segments are not changed.

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
        count = integer("n", n, low=1, high=MAX_STEPS_PER_TAPER)
        pieces = []
        for segment in self.segments:
            pieces.extend(segment.in_steps(count))
        return self.replace(segments=pieces)


def _checked_shaft(
    problems: Problems, shaft: Any, length: Number | None
) -> Shaft | None:
    """Soil or drag along a rod of this length, m, with its profiles checked.

    None if `shaft` is None, or after a mistake, which is added to `problems` with a
    path that begins with "shaft". The length is None if it is unknown.
    """
    if shaft is None:
        return None
    if not isinstance(shaft, Shaft):
        message = "must be a Soil, a Drag or None"
        frozen.add_problem(problems, "shaft", message, shaft)
        return None
    try:
        return shaft_along_rod(shaft, length)
    except frozen.InvalidModel as error:
        for path, message in error.problems:
            problems.append((f"shaft.{path}", message))
        return None


def _segments(segments: Any, shape: dict[str, Any]) -> tuple[Segment, ...]:
    """Segments of a rod: the given ones, or else segments made from its shape.

    `shape` holds the arguments of `Segment` that `Rod` was given, None for the others.
    They make one segment, or one for each value of an area that is `Steps`.
    InvalidModel if both or neither are given, or if there are mistakes in them.
    """
    if segments is not None:
        return _checked_segments(segments, shape)  # refuses a shape beside them
    if isinstance(shape["area"], Steps):
        return _segments_between_jumps(shape)
    return (Segment(**shape),)  # refuses a missing length or area


def _checked_segments(segments: Any, shape: dict[str, Any]) -> tuple[Segment, ...]:
    """The given segments as a tuple, after a check.

    InvalidModel if they are no list or tuple, if there is none, or if an item is no
    `Segment`. `shape` holds the arguments of `Rod` that would make a segment: it is
    also a mistake if one of them is not None.
    """
    if any(value is not None for value in shape.values()):
        message = (
            "give either segments or length, area, material and polar_moment, not both"
        )
        raise frozen.invalid_argument("segments", message)
    if not isinstance(segments, list | tuple) or not segments:
        message = f"must be a list of at least one Segment, got {shown(segments)}"
        raise frozen.invalid_argument("segments", message)
    problems: Problems = []
    for i, segment in enumerate(segments):
        if not isinstance(segment, Segment):
            frozen.add_problem(problems, f"segments.{i}", "must be a Segment", segment)
    frozen.raise_if_problems(problems)
    return tuple(segments)


def _segments_between_jumps(shape: dict[str, Any]) -> tuple[Segment, ...]:
    """Segments between the jumps of an area that is `Steps`.

    `shape` holds the arguments of `Segment`: length and area of the whole rod, and the
    numbers that all segments share. InvalidModel names the mistakes of length and area,
    or, if there are none, those of all segments.
    """
    area = shape["area"]
    problems: Problems = []
    L = Segment.fields["length"].checked(problems, "length", shape["length"])
    known_length = None  # unknown after a mistake
    if not problems:
        known_length = L
    # This call only checks the steps; its result, the same steps, is not needed.
    profiles.checked_along_rod(
        problems, "area", area, Segment.fields["area"], known_length
    )
    frozen.raise_if_problems(problems)
    edges = (0.0, *area.at, L)  # edges of the segments, m from the left end of the rod
    pieces: list[Segment] = []
    for i, A in enumerate(area.values):
        piece = dict(shape)
        piece["length"] = _decimal_distance(edges[i], edges[i + 1])
        piece["area"] = A
        try:
            pieces.append(Segment(**piece))
        except frozen.InvalidModel as error:
            # The area of this segment is a value of the steps.
            for path, message in error.problems:
                problems.append((path.replace("area", f"area.values.{i}"), message))
    frozen.raise_if_problems(problems)
    return tuple(pieces)


def _decimal_distance(start: Number, end: Number) -> Number:
    """Distance end - start, m, computed in decimals, so that 0.4 - 0.1 is 0.3.

    The difference of the floats, 0.30000000000000004, would appear as the length in
    case files and formulas. The result is the float nearest to the difference of the
    decimals. If `start` or `end` is an array, it is computed member by member.
    """
    if not isinstance(start, np.ndarray) and not isinstance(end, np.ndarray):
        # The text of a float is the shortest decimal that stands for it.
        decimal_end = Decimal(repr(float(end)))
        decimal_start = Decimal(repr(float(start)))
        return float(decimal_end - decimal_start)
    starts, ends = np.broadcast_arrays(start, end)
    distances = np.empty(starts.shape)
    for member in np.ndindex(starts.shape):
        start_of_member = float(starts[member])
        end_of_member = float(ends[member])
        distances[member] = _decimal_distance(start_of_member, end_of_member)
    return distances


class RigidMass(FrozenDataclass, kind="mass"):
    """A body that moves as a whole: no wave runs through it.

    Parameters
    ----------
    mass : float or array
        Mass, kg.
    velocity : float or array
        Initial velocity, m/s, positive to the right.

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


class Wall(FrozenDataclass, kind="wall"):
    """An immovable body, or a body whose velocity no collision changes.

    Parameters
    ----------
    velocity : float or array
        Velocity at all times, m/s, positive to the right.

    Raises
    ------
    InvalidModel
        If the velocity is no finite number.

    Examples
    --------
    A wall comes at 1 m/s and hits a rod at rest, which leaves at twice the velocity:

    >>> import rodimpact as ri
    >>> rod = ri.Rod(0.4, area=1e-4, material=ri.materials.steel)
    >>> ri.solve(ri.System([ri.Wall(velocity=1.0), rod])).outcome.velocities_after
    (1.0, 2.0)
    """

    velocity: Numeric = quantity("m/s", default=0.0)


Body: TypeAlias = Rod | RigidMass | Wall
BODIES: dict[str, type[Body]] = {body.kind: body for body in get_args(Body)}
