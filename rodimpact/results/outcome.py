"""Outcome of a collision: velocities before and after, impulses, restitution, energies.

In an outcome, bodies that are joined have one common velocity.
"""

import math
from dataclasses import dataclass
from typing import Any, Generic, TypeVar, cast

from ..hints import TupleOfParts, UndefinedResult, explain_missing
from ..methods.abilities import has_external_drive
from ..methods.groups import unilateral
from ..methods.outcome import Totals
from ..methods.restitution import effective_restitution, no_restitution
from ..methods.run import ContactTally, Run
from ..model.frozen import json_ready
from ..rigid import RigidCollision, collide
from ..storage.extras import optional
from .notebook import as_table

MAX_SILENT_RESIDUAL = 1e-6
"""Largest residual of momentum or energy without a warning in `status`."""

Number = TypeVar("Number")


class UndefinedRestitution(UndefinedResult):
    """The collision has no coefficient of restitution; the message gives the reason.

    Examples
    --------
    >>> import rodimpact as ri
    >>> steel = ri.materials.steel
    >>> apart = [ri.Rod(1.0, area=1e-4, material=steel, velocity=v) for v in (0.0, 1.0)]
    >>> try:
    ...     ri.collide(*apart).restitution
    ... except ri.UndefinedRestitution as error:
    ...     print(error)
    restitution is undefined: nothing collided; the bodies move apart
    """


class OnlyContact(Generic[Number]):
    """Totals of the only contact that can open.

    Each is a number of one collision, or an array of a family.
    """

    contacts: Any  # totals by contact
    unilateral: Any  # indices of the contacts that can open
    _several = "this row has {} contacts that can open, not 1; use outcome.contacts"

    def _only_contact(self) -> Any:
        """Totals of the only contact that can open.

        ValueError where there are several.
        """
        if len(self.unilateral) != 1:
            raise UndefinedResult(self._several.format(len(self.unilateral)))
        return self.contacts[self.unilateral[0]]

    @property
    def impulse(self) -> Number:
        """Impulse of the only contact, N s; ValueError where there are several."""
        return cast("Number", self._only_contact().impulse)

    @property
    def duration(self) -> Number:
        """Force duration of the only contact, s; ValueError where there are several."""
        return cast("Number", self._only_contact().duration)

    @property
    def peak_force(self) -> Number:
        """Peak force of the only contact, N; ValueError where there are several."""
        return cast("Number", self._only_contact().peak_force)


@explain_missing("contacts")
@dataclass(frozen=True)
class Outcome(OnlyContact[float]):
    """Result of a collision, with an entry for each body or contact, including walls.

    Attributes
    ----------
    bodies : tuple of str
        Kind of each body: "rod", "mass" or "wall".
    masses : tuple of float
        kg, with the transit times in use; infinite for a wall.
    velocities_before, velocities_after : tuple of float
        Velocities of the centres of mass, m/s. A rod that is bonded to a wall has the
        velocity of the wall. A rod between two walls of different velocities has its
        own velocity.
    kinetic_before, kinetic_after : float
        Energy of the motion of the centres of mass, J.
    vibration_before, vibration_after : tuple of float
        Vibration energy: kinetic energy relative to the centre of mass, plus strain
        energy, J.
    contacts : tuple of ContactTally
        Impulse, peak force, force duration and episodes of each contact.
    unilateral : tuple of int
        Indices of the contacts that can open.
    wall_work : float
        Work done by moving walls, J.
    momentum_residual, energy_residual : float
        Relative errors of the balances of momentum and energy at the end. The momentum
        is relative to the impulses, plus the momentum of all masses at the largest
        velocity difference. The energy is relative to the works, plus the initial
        energy, plus the energy of all masses at this velocity.
    final : bool
        Whether it is proved that no contact can press again.
    status : str
        Reason why the run ended, and the remedy if it ended too early.
    contact_energy : float
        Energy stored in compliant contacts and joints at the end, J.
    contact_energy_before : float
        Energy stored in stretched joints before, J.
    dissipated, numerical, radiated : float
        Energy lost in contacts, energy lost to the grid (see `EnergyLedger`), and
        energy that has left through absorbing ends, J.
    damped : float
        Energy lost in damped material, J.
    soil_work : float
        Work done on soil along the shafts of rods, J: most of it is lost.
    drag_work : float
        Energy lost to drag along the shafts of rods, J.
    drive_work, gravity_work : float
        Work of driven ends and of gravity, J.
    driven : bool
        Whether not only contacts change the velocities, but also gravity, driven ends,
        or soil or drag along shafts.

    Examples
    --------
    >>> import rodimpact as ri
    >>> steel = ri.materials.steel
    >>> left = ri.Rod(0.4, area=1e-4, material=steel, velocity=1.0)
    >>> right = ri.Rod(1.0, area=1e-4, material=steel)
    >>> outcome = ri.collide(left, right)
    >>> round(outcome.restitution, 12), [round(v, 12) for v in outcome.velocities_after]
    (0.4, [0.0, 0.4])
    >>> round(outcome.vibration_after[1] / outcome.kinetic_before, 12)
    0.6
    """

    bodies: tuple[str, ...]
    masses: tuple[float, ...]
    velocities_before: tuple[float, ...]
    velocities_after: tuple[float, ...]
    kinetic_before: float
    kinetic_after: float
    vibration_before: tuple[float, ...]
    vibration_after: tuple[float, ...]
    contacts: tuple[ContactTally, ...]
    unilateral: tuple[int, ...]
    wall_work: float
    momentum_residual: float
    energy_residual: float
    final: bool
    status: str
    contact_energy: float = 0.0
    contact_energy_before: float = 0.0
    dissipated: float = 0.0
    numerical: float = 0.0
    radiated: float = 0.0
    soil_work: float = 0.0
    drag_work: float = 0.0
    damped: float = 0.0
    drive_work: float = 0.0
    gravity_work: float = 0.0
    driven: bool = False

    @property
    def restitution(self) -> float:
        """Effective coefficient of restitution e of a collision at a single contact.

        e = (V2+ - V1+)/(V1- - V2-), with the velocities V of the centres of mass before
        (-) and after (+) the collision. e is 0 if the speed of separation is only
        round-off.

        Raises
        ------
        UndefinedRestitution
            If the run is not final or is `driven`, nothing met, the bodies did not
            approach each other, or the contacts that can open are not one.
        """
        reason = self.why_no_restitution()
        if reason:
            raise UndefinedRestitution(reason)
        k = self.unilateral[0]  # the contact between the bodies k and k + 1
        before = self.velocities_before[k : k + 2]
        after = self.velocities_after[k : k + 2]
        # Without a reason the collision is final, and the contact has pressed.
        e = effective_restitution(final=True, episodes=1, before=before, after=after)
        return float(e)

    def why_no_restitution(self) -> str:
        """Return why `restitution` is undefined, as a sentence; "" if it is defined.

        For these reasons `restitution` raises an error.
        """
        return no_restitution(
            self.unilateral,
            self.velocities_before,
            self.contacts,
            self.driven,
            self.final,
            self.status,
        )

    def as_rigid(self) -> RigidCollision:
        """Return the rigid-body collision with the same restitution.

        The bodies on each side of the only contact that can open become one rigid body,
        with their mass and their velocity before. These two bodies collide with the
        effective `restitution`. The velocities after and the impulse are those of the
        rods. The energy lost is the energy that the vibration has gained. (If a side is
        bonded to a wall, its oscillation has gained a part.) If e is above 1, energy is
        released.

        Returns
        -------
        rigid.RigidCollision

        Raises
        ------
        UndefinedRestitution
            As `restitution`.

        Examples
        --------
        >>> import rodimpact as ri
        >>> left = ri.Rod(0.4, area=1e-4, material=ri.materials.steel, velocity=1.0)
        >>> right = ri.Rod(1.0, area=1e-4, material=ri.materials.steel)
        >>> outcome = ri.collide(left, right)
        >>> round(outcome.as_rigid().energy_lost / sum(outcome.vibration_after), 12)
        1.0
        """
        e = self.restitution  # raises if it is undefined
        first_on_right = self.unilateral[0] + 1  # body on the right of the contact
        # All other contacts are joined, so each side moves as one body: its velocity is
        # that of the first or the last body of the row.
        left_mass = sum(self.masses[:first_on_right])
        right_mass = sum(self.masses[first_on_right:])
        return collide(
            left_mass,
            self.velocities_before[0],
            right_mass,
            self.velocities_before[-1],
            e,
            allow_energy_release=e > 1,
        )

    def to_dict(self) -> dict[str, Any]:
        """All entries by name, as a new dictionary of values for JSON.

        Tuples become lists, and each contact a dictionary of its totals by name. nan is
        kept as a float.
        """
        entries: dict[str, Any] = {}
        for name, value in vars(self).items():
            entries[name] = json_ready(value)
        # The loop has made each contact a list of totals, without their names.
        contacts = []
        for tally in self.contacts:
            contacts.append(tally._asdict())
        entries["contacts"] = contacts
        return entries

    def to_dataframe(self) -> Any:
        """The outcome as a pandas DataFrame of one row (extra ``dataframe``).

        The columns have the names of `SweepResult.columns`, so ``pandas.concat`` can
        join several outcomes to one table. An undefined restitution is nan.
        ``vibration`` is the vibration energy of all bodies after the collision.
        ``final`` says whether it is proved that no contact can press again.

        Examples
        --------
        >>> import rodimpact as ri
        >>> left = ri.Rod(0.4, area=1e-4, material=ri.materials.steel, velocity=1.0)
        >>> right = ri.Rod(1.0, area=1e-4, material=ri.materials.steel)
        >>> frame = ri.collide(left, right).to_dataframe()
        >>> frame[["restitution", "velocity_after.1"]].round(12).values.tolist()
        [[0.4, 0.4]]
        """
        pandas = optional("pandas", "dataframe")
        row: dict[str, Any] = {"restitution": math.nan}
        if not self.why_no_restitution():
            row["restitution"] = self.restitution
        for i, velocity in enumerate(self.velocities_after):
            row[f"velocity_after.{i}"] = velocity
        for k, tally in enumerate(self.contacts):
            row[f"impulse.{k}"] = tally.impulse
            row[f"peak_force.{k}"] = tally.peak_force
            row[f"duration.{k}"] = tally.duration
            row[f"episodes.{k}"] = tally.episodes
        row["vibration"] = sum(self.vibration_after)
        row["final"] = self.final
        return pandas.DataFrame([row])

    def __str__(self) -> str:
        from ..storage.report import outcome_table

        return outcome_table(self)

    _repr_html_ = as_table


def outcome_of(run: Run, totals: Totals) -> Outcome:
    """The outcome of a run with these totals.

    Its status is that of the run, followed by a warning if the balance of the totals
    does not close. `driven` is True if an end is driven, soil or drag acts along a
    shaft, or there is gravity.
    """
    system = run.system
    warning = _balance_warning(totals.momentum_residual, totals.energy_residual)
    return Outcome(
        bodies=tuple(system.kinds),
        masses=tuple(totals.masses),
        velocities_before=tuple(totals.before.velocities),
        velocities_after=tuple(totals.after.velocities),
        kinetic_before=totals.before.kinetic,
        kinetic_after=totals.after.kinetic,
        vibration_before=tuple(totals.before.vibration),
        vibration_after=tuple(totals.after.vibration),
        contacts=TupleOfParts(run.contacts),  # a tuple with helpful AttributeErrors
        unilateral=tuple(unilateral(system)),  # indices of contacts
        momentum_residual=totals.momentum_residual,
        energy_residual=totals.energy_residual,
        final=run.final,
        status=run.status + warning,
        driven=has_external_drive(system) or bool(system.gravity),
        **totals.works._asdict(),  # works and losses, by the names of the outcome
    )


def _balance_warning(momentum: float, energy: float) -> str:
    """Warning of relative residuals that are large or nan, for the end of a status.

    It is a sentence after a space, or "" if both are `MAX_SILENT_RESIDUAL` at most.
    """
    missing = []
    residuals = {"momentum": abs(momentum), "energy": abs(energy)}
    for name, residual in residuals.items():
        is_small = residual <= MAX_SILENT_RESIDUAL  # False for nan
        if not is_small:
            missing.append(f"{residual:.1g} of the {name}")
    if not missing:
        return ""
    return (
        f" The balance does not close: {' and '.join(missing)} is missing. Take "
        "another method, or numbers that are nearer to each other."
    )
