"""Contact laws: what acts between two neighbours of a row.

A contact pushes and never pulls, but for `Bonded` and `Joint`. Compliant laws give the force F, N,
from the indentation d, by which the bodies overlap, m, and its rate d', m/s. Any number may be an
array, which makes a family; SI units.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import reduce
from itertools import pairwise
from typing import Any, ClassVar, Self, TypeAlias, get_args

import numpy as np
from numpy.typing import ArrayLike

from . import frozen
from .arguments import array, broadcast_arguments, demand
from .bodies import Material
from .frozen import (
    Declared,
    Field,
    Number,
    Numeric,
    NumericOrNone,
    Problems,
    note,
    quantity,
)

FACE = Field("m", "positive or infinite", default=np.inf)
"""The radius of a face, infinite for a flat one."""
MOST = 16  # points of a table
KNOTS = MOST + 2  # places for forces at which a contact goes on with another hardening
UNREACHED = 2.0**1000  # N; in the places that are not used
ROUND_OFF = 1e-12  # relative, of slopes
SOON = 1e-6  # of the first force of a table


class _Law(Declared):
    """A contact law, described by its name and its numbers."""

    opens: ClassVar[bool] = True
    acts_as: ClassVar[str]
    """Branch of the kernels that has its force: the name of a `methods.laws.Law`."""
    fills_link: ClassVar[tuple[str, ...]] = ()
    """Its attributes that are numbers of a `methods.link.Link`, by the same names."""


class _Compliant(_Law):
    """A law whose elastic part is k d^p, k its `stiffness` and p its `exponent`."""

    def stored(self, indentation: ArrayLike) -> Any:
        """Energy stored at an indentation d >= 0, m: k d^(p+1)/(p+1), J; ValueError at others."""
        law: Any = self
        d, k, p = broadcast_arguments(
            indentation=(indentation, "m", "non-negative"),
            stiffness=(law.stiffness, "", ""),
            exponent=(law.exponent, "", ""),
        )
        with np.errstate(over="ignore", invalid="ignore"):
            energy: Any = k * d ** (p + 1) / (p + 1)
        return energy[()]


class _Linear(_Compliant):
    """A law whose elastic part is a linear spring."""

    exponent = 1.0


class Plastic(_Linear):
    """A spring that yields: its faces move for good, and d counts from where they are then."""

    acts_as = "yield"
    fills_link = ("stiffness", "yield_force", "hardening_share", "knots", "shares")

    @property
    def hardening_share(self) -> Number:
        """Slope of the force while it yields, over the stiffness."""
        law: Any = self
        share: Number = law.hardening / law.stiffness
        return share

    @property
    def knots(self) -> list[Number]:
        """Forces at which the slope changes again, N, in `KNOTS` places."""
        return [UNREACHED for _ in range(KNOTS)]

    @property
    def shares(self) -> list[Number]:
        """Slopes from these forces on, over the stiffness, in `KNOTS` places."""
        return [0.0 for _ in range(KNOTS)]


class Rigid(_Law, law="rigid"):
    """Unilateral contact without compliance: gap >= 0, force >= 0, force times gap = 0.

    Where a rod takes part its waves decide what follows. Two rigid bodies have no waves: between
    them a coefficient of restitution must be given.

    Parameters
    ----------
    restitution : float or array, optional
        Relative velocity after an impact over that before it, 0 to 1; between two masses or a mass
        and a wall, and only there.

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
    """Two neighbours joined for good: they share velocity and force, in tension too.

    Examples
    --------
    Two pieces joined for good are one rod:

    >>> import rodimpact as ri
    >>> half = ri.Rod(0.5, area=1e-4, material=ri.materials.steel, velocity=1.0)
    >>> row = ri.System([half, half, ri.Wall()], contacts=[ri.Bonded(), ri.Rigid()])
    >>> [round(v, 12) for v in ri.solve(row).outcome.velocities_after]
    [-1.0, -1.0, 0.0]
    """

    opens: ClassVar[bool] = False
    acts_as = "bond"


class Joint(_Linear, law="joint"):
    """Two neighbours joined for good by a spring and a dashpot side by side: glue, a bolt.

    It pulls as well as it pushes: F = -(k s + c s'), s the stretch and s' its rate. The gap of the
    contact is the stretch, below 0 where it is compressed.

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
        if not problems:
            joins = np.add(self.stiffness, self.damping) > 0
            message = "must be positive where the damping is 0, got {0!r}"
            frozen.require(problems, joins, "stiffness", message, self.stiffness)

    def stored(self, indentation: ArrayLike) -> Any:
        """Energy stored at a stretch or an indentation, m, of either sign: k s^2/2, J."""
        return super().stored(np.abs(array("indentation", indentation, "m")))


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
    >>> round(float(Spring(stiffness=1e8).stored(1e-5)), 12)     # J, pressed in by 10 um
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

    acts_as = "spring"
    fills_link = ("stiffness", "damping")
    stiffness: Numeric = quantity("N/m", "positive")
    damping: Numeric = quantity("N s/m", "non-negative")


class Hertz(_Compliant, law="hertz"):
    """Elastic contact of rounded faces: F = k d^(3/2).

    Parameters
    ----------
    stiffness : float or array
        k, N/m^1.5; `Hertz.from_radii` finds it from the faces.

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
        """Find the stiffness from the radii and the materials of two spherical faces.

        k = (4/3) E* sqrt(R*), 1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2, 1/R* = 1/R1 + 1/R2: K. L.
        Johnson, Contact Mechanics, Cambridge University Press 1985, section 4.2.

        Parameters
        ----------
        left_radius, right_radius : float or array
            R1 and R2, m; ``math.inf`` for a flat face, but not for both.
        left_material, right_material : Material or None
            With a `poisson_ratio`; None for a rigid face, but not for both.

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
        meeting: dict[str, Number] = {}
        yielding = []
        faces: Any = (
            ("left", left_radius, left_material),
            ("right", right_radius, right_material),
        )
        for side, radius, material in faces:
            R, path = f"{side}_radius", f"{side}_material"
            meeting[R] = FACE.checked(problems, R, radius)
            if isinstance(material, Material) and material.poisson_ratio is not None:
                E, nu = material.youngs_modulus, material.poisson_ratio
                meeting |= {f"{path}.youngs_modulus": E, f"{path}.poisson_ratio": nu}
                yielding.append((E, nu))
            elif material is not None:
                message = (
                    "must be a Material with a poisson_ratio, or None for a rigid face"
                )
                note(problems, path, message, material)
        if left_material is right_material is None:
            message = (
                "is None, and so is the left one; one of the faces must be elastic"
            )
            problems.append(("right_material", message))
        frozen.raise_noted(problems)
        frozen.family_shape(meeting.items())
        curvature = 1 / meeting["left_radius"] + 1 / meeting["right_radius"]
        message = (
            "is infinite, and so is the left one; two flat faces make no Hertz contact"
        )
        demand(curvature > 0, "right_radius", message)
        with np.errstate(all="ignore"):  # what is out of range, the law will refuse
            compliance: Number = sum(1 / (E / (1 - nu**2)) for E, nu in yielding)
            return cls(np.divide(4 / 3, compliance * curvature**0.5))


class HuntCrossley(_Compliant, law="hunt-crossley"):
    """Hertz contact with losses: F = k d^(3/2) max(0, 1 + chi d').

    K. H. Hunt and F. R. E. Crossley, Coefficient of restitution interpreted as damping in
    vibroimpact, J. Appl. Mech. 42 (1975) 440-445.

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

    The exponent p is near 1 for faces that fit together, 3/2 for round ones and 2 for pointed ones.

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

    F = k d up to the yield force. Beyond it the slope of F over d is `hardening`. Unloading and
    loading again follow the stiffness k, up to the peak force so far. The yielding is permanent: d
    and the gap of the contact count from the new place of the faces.

    Parameters
    ----------
    stiffness : float or array
        k, N/m.
    yield_force : float or array
        Force at which it first yields, N.
    hardening : float or array, optional
        Stiffness while it yields, N/m, less than k.

    Raises
    ------
    InvalidModel
        If a number is not positive, or the hardening negative or not less than the stiffness.

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
        if not problems:
            k, less = self.stiffness, np.less(self.hardening, self.stiffness)
            message = "must be less than the stiffness {0!r}, got {1!r}"
            frozen.require(problems, less, "hardening", message, k, self.hardening)

    def hardened(self, force: Any) -> Yielding:
        """The law after a peak force, N."""
        return self.replace(yield_force=max(self.yield_force, force))


class Tabulated(Plastic, law="tabulated"):
    """A specimen or contact by table: force over compression on loading, a stiffness on unloading.

    On loading F follows straight lines from 0 through the points of the table, and beyond the last
    point the last of these lines. What unloads follows the unloading stiffness, and what loads
    again follows it back up to the peak force so far, from where it goes on along the table. The
    faces have moved for good then, as those of `Yielding` do, which is a table of one point.

    Parameters
    ----------
    compression : sequence of numbers
        By how much the faces have come nearer on loading, m, increasing; at most 16 points.
    force : sequence of numbers
        At each compression, N, increasing.
    unloading : float or array, optional
        Stiffness on unloading, N/m, at least that of the steepest line of the table; by default
        just that.

    Raises
    ------
    InvalidModel
        If the points are not as many forces as compressions, do not increase, or a line is steeper
        than the unloading.

    Examples
    --------
    A foam: stiff at first, then a long plateau, then stiff again when its cells are closed.

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
        if problems:
            return
        counts = len(self.compression), len(self.force)
        if counts[0] != counts[1] or not 1 <= counts[0] <= MOST + 1:
            message = (
                f"must be 1 to {MOST} numbers, as many as forces, got {counts[0]} for"
            )
            raise frozen.refusal("compression", f"{message} {counts[1]}")
        frozen.increasing(problems, "compression", self.compression)
        frozen.increasing(problems, "force", self.force)
        if not problems and self.unloading is not None:
            steepest, k = reduce(np.maximum, self.slopes), np.asarray(self.unloading)
            message = "must be at least that of the steepest line, {0!r}, got {1!r}"
            enough = k >= steepest * (1 - ROUND_OFF)
            frozen.require(
                problems, enough, "unloading", message, steepest, self.unloading
            )

    @property
    def slopes(self) -> list[Number]:
        """Stiffness on loading, N/m, along the line before each point."""
        points = [(0.0, 0.0), *zip(self.compression, self.force, strict=True)]
        return [(F - f) / (x - d) for (d, f), (x, F) in pairwise(points)]

    @property
    def stiffness(self) -> Number:
        """That of the unloading, N/m."""
        return (
            reduce(np.maximum, self.slopes)
            if self.unloading is None
            else self.unloading
        )

    @property
    def yield_force(self) -> Number:
        """Force from which on the table is followed, N: almost from the first."""
        first: Number = self.force[0]
        return SOON * first

    @property
    def hardening(self) -> Number:
        """Stiffness along the first line, N/m."""
        return self.slopes[0]

    @property
    def knots(self) -> list[Number]:
        """Forces at which lines of the table begin, N, in `KNOTS` places."""
        knots = super().knots
        for j in range(len(self.slopes) - 1):
            knots[j] = self.force[j]
        return knots

    @property
    def shares(self) -> list[Number]:
        """Slopes along these lines, over the unloading stiffness, in `KNOTS` places."""
        shares = super().shares
        for j, slope in enumerate(self.slopes[1:]):
            shares[j] = slope / self.stiffness
        return shares

    def hardened(self, force: Any) -> Tabulated:
        """The law after a peak force, N, for compressions from where the faces are then."""
        k, last = self.stiffness, self.slopes[-1]
        reached: Any
        points = list(zip(self.compression, self.force, strict=True))
        if force >= self.force[-1]:  # the last line goes on
            reached = self.compression[-1] + (force - self.force[-1]) / last
            points.append((reached + force / last, 2 * force))
        else:
            reached = np.interp(force, (0.0, *self.force), (0.0, *self.compression))
        if force <= 0 or force >= k * reached * (1 - ROUND_OFF):  # nothing has yielded
            return self
        rest = [(x - reached + force / k, F) for x, F in points if force < F]
        compression, forces = zip((force / k, force), *rest, strict=True)
        return Tabulated(compression, forces, k)


class Law(_Law, law="own"):
    """A law of one's own: a Python function gives the force.

    The method "characteristics" takes it. In plain Python each call of the function takes its time;
    a function that numba has compiled (``numba.njit``) runs compiled where that pays. No file keeps
    a function.

    Parameters
    ----------
    force : function
        F(d, d'), N, of the indentation d >= 0, m, and its rate d', m/s. It is smooth, 0 at d = 0
        and rest, and does not fall with d or d'. Where it is negative, the contact does not push.

    Raises
    ------
    InvalidModel
        If `force` is no function, or gives no finite number, or a force without an indentation.

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
    damping: ClassVar[float] = 1.0  # it may depend on the rate: as if damped
    force: Callable[[float, float], float]

    def _check(self, problems: Problems) -> None:
        force: Any = self.force
        if not callable(force):
            note(problems, "force", "must be a function of d and d'", force)
            return
        for d, rate in ((0.0, 0.0), (1e-6, 0.0), (1e-6, 1e-3)):
            there = f"at d = {d:g} m, d' = {rate:g} m/s"
            try:
                F = float(force(d, rate))
            except Exception as error:  # whatever the user's function raises
                raise frozen.refusal("force", f"fails {there}: {error!r}") from None
            if not np.isfinite(F) or (d == 0 and F != 0):
                wanted = "a finite number" if d else "0"
                problems.append(("force", f"must be {wanted} {there}, got {F!r}"))

    def stored(self, indentation: ArrayLike) -> Any:
        """Energy at an indentation d >= 0, m: the integral of F(x, 0) from 0 to d, J."""
        from scipy.integrate import quad

        d = array("indentation", indentation, "m", "non-negative")
        return np.vectorize(
            lambda x: quad(self.force, 0.0, x, (0.0,))[0], otypes=[float]
        )(d)[()]

    def to_dict(self) -> dict[str, Any]:
        """Return a description: the same for the same function, but no file can make it again."""
        own: Any = getattr(self.force, "py_func", self.force)
        code, cells = (
            getattr(own, "__code__", None),
            getattr(own, "__closure__", None) or (),
        )
        said = [
            getattr(own, "__qualname__", repr(own)),
            *(repr(c.cell_contents) for c in cells),
        ]
        said += (
            [code.co_code.hex(), repr(code.co_consts), repr(code.co_names)]
            if code
            else []
        )
        return self._tag | {"force": " ".join(said)}


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
    | Tabulated
    | Law
)
CONTACT_LAWS: dict[str, type[ContactLaw]] = {
    law.law: law for law in get_args(ContactLaw) if law is not Law
}
RIGID = Rigid()
