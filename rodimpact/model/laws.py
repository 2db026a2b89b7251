"""Contact laws: the forces between two neighbours of a row.

A contact pushes and never pulls; only `Bonded` and `Joint` pull, too. A compliant law
gives the force F, N, from the overlap d of the bodies, m, and its rate d', m/s. Any
number may be an array, which makes a family; SI units.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import reduce
from typing import Any, ClassVar, NamedTuple, Self, TypeAlias, get_args

import numpy as np
from numpy.typing import ArrayLike

from ..progress import is_function
from . import frozen
from .arguments import UNCHECKED, array, broadcast_arguments, demand, scalar
from .bodies import Material
from .frozen import (
    FrozenDataclass,
    Number,
    Numeric,
    NumericOrNone,
    Problems,
    QuantityField,
    add_problem,
    quantity,
)

FACE_RADIUS = QuantityField("m", "positive or infinite", default=np.inf)
"""Radius of a face, infinite for a flat one."""
MAX_TABLE_POINTS = 16
"""Points of a table that a user may give; a hardened law may have one more."""
KNOTS = MAX_TABLE_POINTS + 2
"""Number of forces in a link at which the slope of its force may change."""
UNREACHED = 2.0**1000
"""Value of the unused ones of these forces, N: no force reaches it."""
SLOPE_RTOL = 1e-12
"""Slopes of a table that differ by less than this fraction count as equal."""
LEAST_YIELD_FORCE = 2.0**-100
"""Yield force, N, of a law that yields from the start of loading."""
FIRST_YIELD_FRACTION = 1e-6
"""Yield force of a table, as a fraction of the force at its first point."""
TRIAL_STATES = ((0.0, 0.0), (1e-6, 0.0), (1e-6, 1e-3))
"""Overlaps, m, and rates, m/s, at which the function of a `Law` is tried."""


class _Law(FrozenDataclass):
    """A contact law, described by its name and its numbers."""

    opens: ClassVar[bool] = True
    """Whether the contact is unilateral: it can open, and never pulls."""
    begins_from_zero: ClassVar[bool] = False
    """Whether its force begins from 0 as the contact closes, so that no wave jumps."""
    acts_as: ClassVar[str]
    """Branch of the kernels that computes its force: name of a `methods.link.Law`."""
    fills_link: ClassVar[tuple[str, ...]] = ()
    """Attributes of the law that are also fields of a `methods.link.Link`."""


class _Compliant(_Law):
    """A law whose elastic part is k d^p, k its `stiffness` and p its `exponent`."""

    begins_from_zero = True

    def stored(self, indentation: ArrayLike) -> Any:
        """Elastic energy at an overlap, k d^(p+1)/(p+1); inf if that overflows.

        Parameters
        ----------
        indentation : float or array
            Overlap d, 0 or more, m.

        Returns
        -------
        float or array
            J, of the broadcast shape of the overlap and the numbers of the law.

        Raises
        ------
        ValueError
            If an overlap is negative.

        Examples
        --------
        >>> import rodimpact as ri
        >>> ri.Hertz(stiffness=1e10).stored([0.0, 1e-4]).round(12).tolist()
        [0.0, 0.4]
        """
        law: Any = self  # of a subclass, which has a stiffness and an exponent
        d, k, p = broadcast_arguments(
            indentation=(indentation, "m", "non-negative"),
            stiffness=(law.stiffness, "", UNCHECKED),
            exponent=(law.exponent, "", UNCHECKED),
        )
        with np.errstate(over="ignore", invalid="ignore"):
            energy: Any = k * d ** (p + 1) / (p + 1)
        return energy[()]  # a number in place of an array of shape ()


class _Linear(_Compliant):
    """A law whose elastic part is a linear spring."""

    exponent = 1.0


class Plastic(_Linear):
    """A spring that yields: d is measured from the permanently deformed faces."""

    acts_as = "yield"
    fills_link: ClassVar[tuple[str, ...]] = (
        "stiffness",
        "yield_force",
        "hardening_share",
        "knots",
        "shares",
    )

    @property
    def hardening_share(self) -> Number:
        """Slope of the force while it yields, over the stiffness."""
        law: Any = self  # of a subclass, which has both numbers
        share: Number = law.hardening / law.stiffness
        return share

    @property
    def knots(self) -> list[Number]:
        """Forces at which the slope changes after first yield, N; `KNOTS` numbers.

        Here there are none: all are `UNREACHED`.
        """
        return [UNREACHED] * KNOTS

    @property
    def shares(self) -> list[Number]:
        """Slopes above each of the forces `knots`, over the stiffness; `KNOTS` numbers.

        Here there are none: all are 0.
        """
        return [0.0] * KNOTS


class Rigid(_Law, law="rigid"):
    """Unilateral contact without compliance: gap >= 0, force >= 0, force times gap = 0.

    For rods the contact force follows from the waves. Two rigid bodies have no waves,
    so the contact between them needs a coefficient of restitution.

    Parameters
    ----------
    restitution : float or array, optional
        Relative velocity after an impact divided by the relative velocity before it,
        from 0 to 1. It is required for contacts between two masses, or between a mass
        and a wall, and not allowed for contacts of rods.

    Raises
    ------
    InvalidModel
        If it is not a number from 0 to 1.

    Examples
    --------
    A mass bounces off another with half the speed; between rods no number is needed.

    >>> Rigid(restitution=0.5)
    Rigid(restitution=0.5)
    >>> Rigid()
    Rigid()
    """

    acts_as = "rigid"
    restitution: NumericOrNone = quantity(
        "", "[0, 1]", "coefficient of restitution", default=None
    )


class Bonded(_Law, law="bonded"):
    """A permanent bond of two neighbours, which share velocity and force.

    Examples
    --------
    Two bonded pieces behave as one rod:

    >>> import rodimpact as ri
    >>> half = ri.Rod(0.5, area=1e-4, material=ri.materials.steel, velocity=1.0)
    >>> row = ri.System([half, half, ri.Wall()], contacts=[ri.Bonded(), ri.Rigid()])
    >>> [round(v, 12) for v in ri.solve(row).outcome.velocities_after]
    [-1.0, -1.0, 0.0]
    """

    opens: ClassVar[bool] = False
    acts_as = "bond"


class Joint(_Linear, law="joint"):
    """A permanent joint by a spring and a dashpot, such as glue or a bolt.

    The spring and the dashpot are in parallel. The joint can push and pull: F = -(k s +
    c s'), with the stretch s and its rate s'. The stretch is negative in compression,
    and is the gap of the contact.

    Parameters
    ----------
    stiffness : float or array
        k, N/m; 0 for a dashpot alone.
    damping : float or array, optional
        c, N s/m.
    stretch : float or array, optional
        s at t = 0, m.

    Raises
    ------
    InvalidModel
        If the stiffness or the damping is negative, or both are 0.

    Examples
    --------
    >>> glue = Joint(stiffness=2e8, damping=100.0)
    >>> round(float(glue.stored(1e-5)), 12)     # J, stretched by 10 um
    0.01
    """

    opens: ClassVar[bool] = False
    acts_as = "joint"
    fills_link = ("stiffness", "damping", "stretch")
    stiffness: Numeric = quantity("N/m", "non-negative")
    damping: Numeric = quantity("N s/m", "non-negative", default=0.0)
    stretch: Numeric = quantity("m", default=0.0)

    def _check(self, problems: Problems) -> None:
        """Add a problem if stiffness and damping are both 0, in any member of a family.

        Nothing is checked if there are other problems.
        """
        if problems:
            return
        has_force = np.add(self.stiffness, self.damping) > 0
        message = "must be positive where the damping is 0, got {0!r}"
        frozen.require(problems, has_force, "stiffness", message, self.stiffness)

    def stored(self, indentation: ArrayLike) -> Any:
        """Elastic energy at a stretch or an overlap, k s^2/2.

        Parameters
        ----------
        indentation : float or array
            Stretch s or overlap, of either sign, m.

        Returns
        -------
        float or array
            J, of the broadcast shape of the stretch and the numbers of the joint.

        Raises
        ------
        ValueError
            If a stretch is no number.

        Examples
        --------
        >>> Joint(stiffness=2e8).stored([-1e-5, 1e-5]).round(12).tolist()
        [0.01, 0.01]
        """
        stretch = array("indentation", indentation, "m")
        return super().stored(np.abs(stretch))


class Spring(_Linear, law="spring"):
    """A linear spring between the bodies: F = k d.

    Parameters
    ----------
    stiffness : float or array
        k, N/m.

    Raises
    ------
    InvalidModel
        If it is not a positive number.

    Examples
    --------
    >>> round(float(Spring(stiffness=1e8).stored(1e-5)), 12)  # J, pressed in by 10 um
    0.005
    """

    acts_as = "spring"
    fills_link = ("stiffness",)
    stiffness: Numeric = quantity("N/m", "positive")


class SpringDashpot(_Linear, law="spring-dashpot"):
    """A linear spring and a dashpot side by side: F = max(0, k d + c d').

    Parameters
    ----------
    stiffness : float or array
        k, N/m.
    damping : float or array
        c, N s/m.

    Raises
    ------
    InvalidModel
        If the stiffness is not positive or the damping negative.

    Examples
    --------
    >>> SpringDashpot(stiffness=1e8, damping=2e3)
    SpringDashpot(stiffness=100000000.0, damping=2000.0)
    """

    begins_from_zero = False  # the dashpot presses at once
    acts_as = "spring"
    fills_link = ("stiffness", "damping")
    stiffness: Numeric = quantity("N/m", "positive")
    damping: Numeric = quantity("N s/m", "non-negative")


class Hertz(_Compliant, law="hertz"):
    """Elastic contact of rounded faces: F = k d^(3/2).

    Parameters
    ----------
    stiffness : float or array
        k, N/m^1.5; `Hertz.from_radii` computes it from the faces.

    Raises
    ------
    InvalidModel
        If it is not a positive number.

    Examples
    --------
    >>> round(float(Hertz(stiffness=1e10).stored(1e-4)), 12)     # J: k d^(5/2)/(5/2)
    0.4
    """

    acts_as = "power"
    fills_link = ("stiffness", "exponent")
    exponent = 1.5
    stiffness: Numeric = quantity("N/m^1.5", "positive")

    @classmethod
    def from_radii(
        cls,
        left_radius: ArrayLike,
        right_radius: ArrayLike,
        left_material: Material | None,
        right_material: Material | None,
    ) -> Self:
        """Hertz contact of two spherical faces, from their radii and materials.

        k = (4/3) E* sqrt(R*), 1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2, 1/R* = 1/R1 +
        1/R2: K. L. Johnson, Contact Mechanics, Cambridge University Press 1985, section
        4.2.

        Parameters
        ----------
        left_radius, right_radius : float or array
            R1 and R2, m; ``math.inf`` for a flat face, but not for both.
        left_material, right_material : Material or None
            Materials with a `poisson_ratio`; None for a rigid face, but not for both.

        Returns
        -------
        Hertz

        Raises
        ------
        InvalidModel
            Naming every argument that is not what it should be.

        Examples
        --------
        >>> from rodimpact.materials import steel
        >>> f"{Hertz.from_radii(0.01, 0.01, steel, steel).stiffness:.4e}"
        '1.0294e+10'
        >>> import math
        >>> f"{Hertz.from_radii(0.01, math.inf, steel, steel).stiffness:.4e}"
        '1.4558e+10'
        """
        problems: Problems = []
        faces = [
            _checked_face(problems, "left", left_radius, left_material),
            _checked_face(problems, "right", right_radius, right_material),
        ]
        if left_material is None and right_material is None:
            message = (
                "is None, and so is the left one; one of the faces must be elastic"
            )
            problems.append(("right_material", message))
        frozen.raise_if_problems(problems)
        numbers: dict[str, Number] = {}
        for face in faces:
            numbers |= face.numbers
        frozen.family_shape(numbers.items())  # raises if arrays make no family
        curvature = 1 / faces[0].radius + 1 / faces[1].radius  # 1/R*
        message = (
            "is infinite, and so is the left one; two flat faces make no Hertz contact"
        )
        demand(curvature > 0, "right_radius", message)
        with np.errstate(all="ignore"):  # the law refuses what is out of range
            compliance: Number = faces[0].compliance + faces[1].compliance  # 1/E*
            # (4/3) E* sqrt(R*), with E* = 1/compliance and R* = 1/curvature
            stiffness = np.divide(4 / 3, compliance * curvature**0.5)
            return cls(stiffness)


class _Face(NamedTuple):
    """One of the two faces of a Hertz contact."""

    radius: Number  # m, infinite for a flat face
    compliance: Number  # (1 - nu^2)/E, 1/Pa; 0 for a rigid face
    numbers: dict[str, Number]  # all numbers of the face by their paths


def _checked_face(problems: Problems, side: str, radius: Any, material: Any) -> _Face:
    """Face of a Hertz contact, from radius and material of one side.

    `side` is "left" or "right". The compliance is (1 - nu^2)/E, or 0 for a rigid face,
    whose material is None. Mistakes are added to `problems`, also a material without a
    Poisson ratio; the radius or the compliance is then meaningless.
    """
    radius_path = f"{side}_radius"
    material_path = f"{side}_material"
    R = FACE_RADIUS.checked(problems, radius_path, radius)
    numbers: dict[str, Number] = {radius_path: R}
    compliance: Number = 0.0
    if isinstance(material, Material) and material.poisson_ratio is not None:
        E = material.youngs_modulus
        nu = material.poisson_ratio
        numbers[f"{material_path}.youngs_modulus"] = E
        numbers[f"{material_path}.poisson_ratio"] = nu
        with np.errstate(all="ignore"):
            compliance = 1 / (E / (1 - nu**2))  # inverse of the plane strain modulus
    elif material is not None:
        message = "must be a Material with a poisson_ratio, or None for a rigid face"
        refused = material
        if isinstance(material, Material):
            refused = material.name
        add_problem(problems, material_path, message, refused)
    return _Face(R, compliance, numbers)


class HuntCrossley(_Compliant, law="hunt-crossley"):
    """Hertz contact with losses: F = k d^(3/2) max(0, 1 + chi d').

    K. H. Hunt and F. R. E. Crossley, Coefficient of restitution interpreted as damping
    in vibroimpact, J. Appl. Mech. 42 (1975) 440-445.

    Parameters
    ----------
    stiffness : float or array
        k, N/m^1.5.
    damping : float or array
        chi, s/m.

    Raises
    ------
    InvalidModel
        If the stiffness is not positive or the damping negative.

    Examples
    --------
    >>> HuntCrossley(stiffness=1e10, damping=0.3).exponent
    1.5
    """

    acts_as = "power"
    fills_link = ("stiffness", "exponent", "damping")
    exponent = 1.5
    stiffness: Numeric = quantity("N/m^1.5", "positive")
    damping: Numeric = quantity("s/m", "non-negative")


class PowerLaw(_Compliant, law="power"):
    """Elastic contact whose force is a power of the indentation: F = k d^p.

    The exponent p is near 1 for faces that fit together, 3/2 for round faces and 2 for
    pointed faces.

    Parameters
    ----------
    stiffness : float or array
        k, N/m^p, a bare number.
    exponent : float or array
        p, at least 1.

    Raises
    ------
    InvalidModel
        If the stiffness is not positive or the exponent below 1.

    Examples
    --------
    >>> pointed = PowerLaw(stiffness=3e12, exponent=2.0)
    >>> round(float(pointed.stored(1e-4)), 12)        # J: k d^3/3
    1.0
    """

    acts_as = "power"
    fills_link = ("stiffness", "exponent")
    stiffness: Numeric = quantity("N/m^p", "positive")
    exponent: Numeric = quantity("", "[1, inf)")


class Yielding(Plastic, law="yielding"):
    """A spring that yields: specimens, pulse shapers and soft ends.

    F = k d up to the yield force. Above the yield force the slope of F over d is
    `hardening`. Unloading and reloading follow the stiffness k, up to the previous peak
    force. The yielding is permanent: afterwards d and the gap of the contact are
    measured from the deformed faces.

    Parameters
    ----------
    stiffness : float or array
        k, N/m.
    yield_force : float or array
        Force at which the spring first yields, N.
    hardening : float or array, optional
        Stiffness while the spring yields, N/m, less than k; default 0.

    Raises
    ------
    InvalidModel
        If a number is not positive, or the hardening negative or not less than the
        stiffness.

    Examples
    --------
    A rod that hits a wall through a soft layer gives energy away:

    >>> import rodimpact as ri
    >>> rod = ri.Rod(0.4, area=1e-4, material=ri.materials.steel, velocity=1.0)
    >>> layer = ri.Yielding(stiffness=1e9, yield_force=1e3)
    >>> outcome = ri.solve(ri.System([rod, ri.Wall()], contacts=[layer])).outcome
    >>> round(outcome.peak_force, 3), outcome.dissipated > 0
    (1000.0, True)
    """

    stiffness: Numeric = quantity("N/m", "positive")
    yield_force: Numeric = quantity("N", "positive")
    hardening: Numeric = quantity("N/m", "non-negative", default=0.0)

    def _check(self, problems: Problems) -> None:
        """Add a problem if the hardening is not less than the stiffness.

        This must hold in every member of a family. Nothing is checked if there are
        other problems.
        """
        if problems:
            return
        k = self.stiffness
        is_softer = np.less(self.hardening, k)
        message = "must be less than the stiffness {0!r}, got {1!r}"
        frozen.require(problems, is_softer, "hardening", message, k, self.hardening)

    def hardened(self, force: Any) -> Yielding:
        """Law of the spring after a peak force.

        Parameters
        ----------
        force : float
            Peak force so far, N.

        Returns
        -------
        Yielding
            It yields at the peak force, if this is above the yield force.

        Examples
        --------
        >>> layer = Yielding(stiffness=1e9, yield_force=1e3, hardening=1e8)
        >>> layer.hardened(2e3).yield_force
        2000.0
        """
        force = scalar("force", force, "N")
        return self.replace(yield_force=max(self.yield_force, force))


class Tabulated(Plastic, law="tabulated"):
    """A specimen or contact whose force on loading is given by a table.

    On loading F follows straight lines from 0 through the points of the table, and
    continues the last line beyond the last point. Unloading follows the unloading
    stiffness. Reloading follows this stiffness up to the previous peak force, and then
    the table. The deformation is permanent, as for `Yielding`, which is a table with
    one point.

    Parameters
    ----------
    compression : sequence of numbers
        Approach of the faces on loading, m, increasing; at most 16 points.
    force : sequence of numbers
        Force at each compression, N, increasing.
    unloading : float or array, optional
        Stiffness on unloading, N/m, at least the slope of the steepest line of the
        table, which is the default.

    Raises
    ------
    InvalidModel
        If there are not as many forces as compressions, they do not increase, or a line
        is steeper than the unloading.

    Examples
    --------
    A foam: stiff at first, then a long plateau, then stiff again when its cells are
    closed.

    >>> import rodimpact as ri
    >>> foam = ri.Tabulated([1e-4, 1e-3, 1.2e-3], [1e3, 1.2e3, 6e3], unloading=5e7)
    >>> rod = ri.Rod(0.4, area=1e-4, material=ri.materials.steel, velocity=3.0)
    >>> outcome = ri.solve(ri.System([rod, ri.Wall()], contacts=[foam])).outcome
    >>> 1.2e3 < outcome.peak_force < 6e3, outcome.dissipated > 0
    (True, True)
    """

    compression: Sequence[Any] = quantity("m", "positive", many=True)
    force: Sequence[Any] = quantity("N", "positive", many=True)
    unloading: NumericOrNone = quantity("N/m", "positive", default=None)

    def _check(self, problems: Problems) -> None:
        """Refuse tables of unequal length, not increasing, or too soft in unloading.

        InvalidModel if the lengths differ, are 0 or too large. Problems are added if
        compressions or forces do not increase. If they do, one is added if the
        unloading stiffness is less than the slope of a line. Nothing is checked if
        there are other problems.
        """
        if problems:
            return
        n_compressions = len(self.compression)
        n_forces = len(self.force)
        # `hardened` adds a point to a full table.
        fits = 1 <= n_compressions <= MAX_TABLE_POINTS + 1
        if n_compressions != n_forces or not fits:
            message = (
                f"must be 1 to {MAX_TABLE_POINTS} numbers, as many as forces, got "
                f"{n_compressions} for {n_forces}"
            )
            raise frozen.invalid_argument("compression", message)
        frozen.require_increasing(problems, "compression", self.compression)
        frozen.require_increasing(problems, "force", self.force)
        if not problems and self.unloading is not None:
            steepest = self._steepest_slope()
            k = np.asarray(self.unloading)
            is_steep_enough = k >= steepest * (1 - SLOPE_RTOL)
            message = "must be at least that of the steepest line, {0!r}, got {1!r}"
            values = (steepest, self.unloading)
            frozen.require(problems, is_steep_enough, "unloading", message, *values)

    @property
    def slopes(self) -> list[Number]:
        """Stiffness on loading along the line that ends at each point, N/m.

        The first line begins at (0, 0).
        """
        slopes = []
        d_before: Number = 0.0
        F_before: Number = 0.0
        for d, F in zip(self.compression, self.force, strict=True):
            slopes.append((F - F_before) / (d - d_before))
            d_before = d
            F_before = F
        return slopes

    def _steepest_slope(self) -> Number:
        """Slope of the steepest line, N/m, of each member of a family."""
        return reduce(np.maximum, self.slopes)

    @property
    def stiffness(self) -> Number:
        """Stiffness on unloading, N/m, by default the slope of the steepest line."""
        if self.unloading is None:
            return self._steepest_slope()
        return self.unloading

    @property
    def yield_force(self) -> Number:
        """Force above which the table is followed, N: almost 0."""
        first_force: Number = self.force[0]
        return FIRST_YIELD_FRACTION * first_force

    @property
    def hardening(self) -> Number:
        """Stiffness along the first line of the table, N/m."""
        return self.slopes[0]

    @property
    def knots(self) -> list[Number]:
        """Forces at which the second and later lines of the table begin, N.

        The list has `KNOTS` numbers. Those that are not used are `UNREACHED`, a force
        that is never reached.
        """
        knots = super().knots  # all unused
        for j in range(len(self.slopes) - 1):
            knots[j] = self.force[j]  # the force at point j, where line j + 1 begins
        return knots

    @property
    def shares(self) -> list[Number]:
        """Slopes of the second and later lines, over the stiffness on unloading.

        The list has `KNOTS` numbers, like the list of the `knots` at which these lines
        begin. Numbers that are not used are 0.
        """
        shares = super().shares  # all unused
        for j, slope in enumerate(self.slopes[1:]):
            shares[j] = slope / self.stiffness
        return shares

    def hardened(self, force: Any) -> Tabulated:
        """Law after a peak force; the law itself if the force leaves no deformation.

        Parameters
        ----------
        force : float
            Peak force so far, N.

        Returns
        -------
        Tabulated
            Compressions are measured from the deformed faces. The first line rises with
            the unloading stiffness to the peak; the rest of the old table follows.

        Examples
        --------
        Unloaded from 1.5 kN, the faces have moved by 1 mm for good:

        >>> foam = Tabulated([1e-3, 3e-3], [1e3, 2e3], unloading=1.5e6)
        >>> foam.hardened(1.5e3).compression
        (0.001, 0.002)
        """
        force = scalar("force", force, "N")
        k = self.stiffness
        last_slope = self.slopes[-1]
        compressions = list(self.compression)
        forces = list(self.force)
        peak_compression: Any
        if force >= self.force[-1]:
            # The last line continues, so the new table needs one more point on it. Any
            # force beyond the peak will do: the force of this point is twice the peak.
            excess = (force - self.force[-1]) / last_slope
            peak_compression = self.compression[-1] + excess
            compressions.append(peak_compression + force / last_slope)
            forces.append(2 * force)
        else:
            # Interpolate the compression over the force; the first line begins at 0.
            all_forces = (0.0, *forces)
            peak_compression = np.interp(force, all_forces, (0.0, *compressions))
        # A peak on the elastic line F = k d leaves no permanent deformation.
        is_elastic = force <= 0 or force >= k * peak_compression * (1 - SLOPE_RTOL)
        if is_elastic:
            return self
        # Unloading follows k, so the faces have moved by peak_compression - force/k.
        # The new table is one line up to the peak, then the points of the old table
        # beyond the peak, with compressions measured from the new position.
        elastic_compression = force / k
        new_compressions = [elastic_compression]
        new_forces = [force]
        for d, F in zip(compressions, forces, strict=True):
            if force < F:
                new_compressions.append(d - peak_compression + elastic_compression)
                new_forces.append(F)
        return Tabulated(new_compressions, new_forces, k)


class SmithToe(Plastic, law="smith-toe"):
    """Soil below the toe of a pile: F = max(0, S (1 + J d')).

    The static resistance is S = k d with k = R_u/q, up to the ultimate resistance R_u,
    at which the soil yields. Unloading follows the stiffness k. The yielding is
    permanent, as for `Yielding`. The damping increases the force while the toe moves
    down, and decreases the force while it moves up. E. A. L. Smith, Pile-driving
    analysis by the wave equation, J. Soil Mech. Found. Div. ASCE 86 (1960) 35-61.
    `Soil` is the same along the shaft.

    Parameters
    ----------
    resistance : float or array
        Ultimate static resistance R_u, N.
    quake : float or array
        Displacement q at which the soil yields, m.
    damping : float or array, optional
        J, s/m.

    Raises
    ------
    InvalidModel
        If a number is not positive, or the damping negative.

    Examples
    --------
    >>> import rodimpact as ri
    >>> toe = ri.SmithToe(resistance=400e3, quake=2.5e-3, damping=0.5)
    >>> ram = ri.RigidMass(4500.0, velocity=3.5)
    >>> pile = ri.Rod(15.0, area=0.0094, material=ri.materials.steel)
    >>> row = ri.System([ram, pile, ri.Wall()], contacts=[ri.Spring(5e8), toe])
    >>> blow = ri.solve(row, until=0.1)
    >>> 0.02 < blow.contacts[1].permanent_set() < 0.066
    True
    """

    fills_link = (*Plastic.fills_link, "damping")
    resistance: Numeric = quantity("N", "positive")
    quake: Numeric = quantity("m", "positive")
    damping: Numeric = quantity("s/m", "non-negative", default=0.0)
    hardening: ClassVar[float] = 0.0

    @property
    def stiffness(self) -> Number:
        """Elastic stiffness R_u/q, N/m."""
        return self.resistance / self.quake

    @property
    def yield_force(self) -> Number:
        """Static force at which the soil yields, N: its resistance."""
        return self.resistance

    def hardened(self, force: Any) -> SmithToe:
        """Law after a peak force: the same, as soil does not harden.

        Parameters
        ----------
        force : float
            Peak force so far, N.

        Returns
        -------
        SmithToe

        Examples
        --------
        >>> toe = SmithToe(resistance=400e3, quake=2.5e-3)
        >>> toe.hardened(300e3) == toe
        True
        """
        scalar("force", force, "N")
        return self


class Cushion(Plastic, law="cushion"):
    """A cushion with a coefficient of restitution: it returns a part of its energy.

    On loading F follows the stiffness k, and on unloading the stiffness k/e^2. So a
    body that hits a cushion on a wall rebounds with the fraction e of its velocity.
    Reloading follows k/e^2 up to the previous peak force.

    Parameters
    ----------
    loading : float or array
        k, N/m.
    restitution : float or array
        e, above 0 and at most 1.

    Raises
    ------
    InvalidModel
        If the stiffness is not positive, or the restitution no number above 0 up to 1.

    Examples
    --------
    >>> import rodimpact as ri
    >>> cushion = ri.Cushion(5e8, restitution=0.8)
    >>> ram = ri.RigidMass(4500.0, velocity=1.0)
    >>> outcome = ri.solve(ri.System([ram, ri.Wall()], contacts=[cushion])).outcome
    >>> round(outcome.restitution, 6)
    0.8
    """

    loading: Numeric = quantity("N/m", "positive")
    restitution: Numeric = quantity("", "(0, 1]", "coefficient of restitution")
    yield_force: ClassVar[float] = LEAST_YIELD_FORCE

    @property
    def stiffness(self) -> Number:
        """Stiffness on unloading, k/e^2, N/m."""
        return self.loading / (self.restitution * self.restitution)

    @property
    def hardening(self) -> Number:
        """Stiffness on loading, N/m."""
        return self.loading

    def hardened(self, force: Any) -> Yielding | Cushion:
        """Law after a peak force; the cushion itself if the force changes nothing.

        Parameters
        ----------
        force : float
            Peak force so far, N.

        Returns
        -------
        Yielding or Cushion
            Elastic up to the peak force. The cushion itself if the force is not above
            0, or if the restitution is 1 in every member of a family.

        Examples
        --------
        >>> Cushion(1e8, restitution=0.5).hardened(2e3).stiffness
        400000000.0
        """
        force = scalar("force", force, "N")
        if force <= 0 or np.all(np.equal(self.restitution, 1)):
            return self
        # Below the peak force it is elastic; above, it follows the loading line again.
        return Yielding(self.stiffness, force, self.hardening)


class Law(_Law, law="own"):
    """A contact law of your own: a Python function gives the force.

    The method "characteristics" solves such laws. If the function is decorated with
    ``numba.njit``, the solver runs compiled if this is faster. Processes and clusters
    need a named function of a module: a lambda cannot be sent to them. A function
    cannot be saved in a file.

    Parameters
    ----------
    force : function
        F(d, d'), N, from the overlap d >= 0, m, and its rate d', m/s. F is smooth, 0
        for d = d' = 0, and falls neither with d nor with d'. If F is negative, the
        contact does not push.

    Raises
    ------
    InvalidModel
        If `force` is no function, gives no finite number, or a force without an
        overlap.

    Examples
    --------
    A spring that hardens:

    >>> import rodimpact as ri
    >>> law = ri.Law(lambda d, rate: 1e8 * d + 1e18 * d**3)
    >>> rod = ri.Rod(0.4, area=1e-4, material=ri.materials.steel, velocity=1.0)
    >>> outcome = ri.solve(ri.System([rod, ri.Wall()], contacts=[law])).outcome
    >>> 0.9 < outcome.restitution <= 1.0
    True
    """

    acts_as = "own"
    fills_link = ("damping",)
    damping: ClassVar[float] = 1.0  # not 0: the force may depend on the rate
    force: Callable[[float, float], float]

    def _check(self, problems: Problems) -> None:
        """Refuse a force that is no function, or has invalid values.

        The function is called at `TRIAL_STATES`, in which first d and then d'
        increases. The force must be finite, 0 at d = 0, and must not decrease.
        InvalidModel if the function fails; other mistakes are added to `problems`.
        """
        force: Any = self.force
        if not is_function(force):
            add_problem(problems, "force", "must be a function of d and d'", force)
            return
        previous = 0.0  # force at the state before
        for d, rate in TRIAL_STATES:
            state = f"at d = {d:g} m, d' = {rate:g} m/s"
            try:
                F = float(force(d, rate))
            except Exception as error:  # whatever the user's function raises
                raise frozen.invalid_argument(
                    "force", f"fails {state}: {error!r}"
                ) from None
            if d == 0 and F != 0:
                problems.append(("force", f"must be 0 {state}, got {F!r}"))
            elif not np.isfinite(F):
                message = f"must be a finite number {state}, got {F!r}"
                problems.append(("force", message))
            elif previous > F:
                message = (
                    "must not fall with d or d' (the overlap and its rate), got "
                    f"{F!r} {state} after {previous!r}"
                )
                problems.append(("force", message))
            previous = F

    def stored(self, indentation: ArrayLike) -> Any:
        """Elastic energy at an overlap, the integral of F(x, 0) from 0 to d.

        Parameters
        ----------
        indentation : float or array
            Overlap d, 0 or more, m.

        Returns
        -------
        float or array
            J, of the shape of the overlap.

        Raises
        ------
        ValueError
            If an overlap is negative.

        Examples
        --------
        >>> law = Law(lambda d, rate: 1e8 * d)
        >>> law.stored([0.0, 1e-4]).round(12).tolist()
        [0.0, 0.5]
        """
        from scipy.integrate import quad

        def energy_at(d: float) -> float:
            """Integral of the force from 0 to d at the rate 0, J."""
            energy: float
            energy, _ = quad(self.force, 0.0, d, args=(0.0,))
            return energy

        overlaps = array("indentation", indentation, "m", "non-negative")
        energies = np.vectorize(energy_at, otypes=[float])(overlaps)
        return energies[()]  # a number in place of an array of shape ()

    def to_dict(self) -> dict[str, Any]:
        """Return a description that equal functions share; no file can restore the law.

        Returns
        -------
        dict
            The entry that names the law, and under "force" a text with the function's
            name, the values that it closes over, and its code. For an object without
            code the text is its repr.
        """
        # A function that Numba has compiled holds the Python function as `py_func`.
        function: Any = getattr(self.force, "py_func", self.force)
        code = getattr(function, "__code__", None)
        cells = getattr(function, "__closure__", None)
        parts = [getattr(function, "__qualname__", repr(function))]
        for cell in cells or ():  # `cells` is None if the function closes over nothing
            parts.append(repr(cell.cell_contents))
        if code is not None:
            parts.append(code.co_code.hex())
            parts.append(repr(code.co_consts))
            parts.append(repr(code.co_names))
        return self._tag | {"force": " ".join(parts)}


ContactLaw: TypeAlias = (
    Rigid
    | Bonded
    | Joint
    | Spring
    | SpringDashpot
    | Hertz
    | HuntCrossley
    | PowerLaw
    | Yielding
    | SmithToe
    | Cushion
    | Tabulated
    | Law
)
CONTACT_LAWS: dict[str, type[ContactLaw]] = {
    law.law: law for law in get_args(ContactLaw) if law is not Law
}
"""Laws that a case file may name, by the word for the law in the file."""
RIGID = Rigid()
