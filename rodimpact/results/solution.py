"""Solution of a collision: all fields as functions of position and time."""

from __future__ import annotations

import os
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..hints import NamedItems, TupleOfParts, explain_missing
from ..methods.outcome import Totals
from ..methods.registry import Options
from ..methods.run import Run, Waves
from ..methods.signals import Floats, Side, each_once
from ..model import Polynomials, Rod, Samples, Soil, Steps, System
from ..model.arguments import (
    UNCHECKED,
    Array,
    array,
    check_kind,
    demand,
    integer,
    scalar,
)
from ..model.frozen import invalid_argument
from ..model.numbering import body_names
from ..storage.case_writing import write_case
from .contacts import ContactHistory
from .energy import EnergyLedger, bonded_groups, ledger, totals_of
from .extreme_stress import ExtremeStress
from .field_error import CoarserSolution, FieldError, field_error
from .fields import END_RTOL, Fields
from .gauges import Gauge
from .grid_fields import GridFields
from .labels import dataset
from .notebook import Shown
from .outcome import Outcome, outcome_of
from .ring_down import RingDown, ring_down
from .saved import case_of
from .soil_profile import SoilProfile, soil_profile
from .state_profiles import state_profiles
from .wave_fields import WaveFields

_ALLOW_UNDERFLOW = np.errstate(under="ignore")
"""Ignores underflow: squares of very small velocities and strains may become 0."""

PROFILES_IN_TIME = (Steps, Samples, Polynomials)
"""Types of the value of an end that varies in time."""
FIELDS_OF_ALL_BODIES = ("velocity", "displacement", "position")
FIELDS_OF_RODS = ("strain", "stress", "axial_force")


@explain_missing("outcome", "contacts", "system")
class Solution(Shown):
    """Solution of one collision, as functions of position and time.

    `rodimpact.solve` returns it. Positions are in m from the left end of a body. Times
    are in s, from 0 to `t_end`.

    Attributes
    ----------
    system : System
    outcome : Outcome
    contacts : tuple of ContactHistory
        One for each neighbouring pair of bodies, including walls.
    final : bool
        Whether it is proved that no contact can press again.
    t_final : float
        Time at which the last contact ended, s: its gap opened, or its force ended and
        the bodies rest against each other. 0 if nothing collides, inf if a contact
        presses forever. nan without a proof that no contact follows, or if the run ends
        at `until` before the gap opens.
    t_proved : float
        Time at which the run proved that no contact can follow, s; nan without proof.
        With `until` the proof is tried only at the end.
    stopped_by : str
        ``"final"``, ``"until"``, ``"max_events"`` or ``"clock"``. Without `until` this
        is ``"final"`` for every run that is proved final, even if the limit on events
        ended the round trip after the proof.
    status : str
        A sentence with this reason and the remedy.
    t_end : float
        s.
    until : float or None
        The given end of the run, s.
    transit_error : float
        Largest relative change of a transit time by its rounding to the clock.
        `accuracy` includes its effect on the outcome.
    events : int
        Number of events. Fronts: arrivals at ends. Characteristics: steps of contacts
        and ends. Grid: time steps times the number of contacts and ends.
    accuracy : dict of str to float
        Stated relative error of velocities, impulses, peak forces, durations and times.
        Empty if the method is exact, or if cells or the step were given. On a grid the
        velocities are those after the collision, or of each body at the given end
        (`until`). The error of the impulse of a bond or a joint is relative to its
        largest impulse during the run. On a grid two errors may exceed rtol: the error
        of the duration, which depends on weak forces, and the error of the peak force,
        which overshoots beside jumps. inf means that a finer grid always finds a larger
        force.
    fields : Fields
    method : str
    options : Options
        Given options; `method` is the method that ran.

    Examples
    --------
    >>> import rodimpact as ri
    >>> rod = ri.Rod(0.4, area=1e-4, material=ri.materials.steel, velocity=1.0)
    >>> solution = ri.solve(ri.System([rod, ri.Wall()]))
    >>> solution.velocity(body=0, x=[0.1, 0.3], t=100e-6).tolist()
    [-1.0, 0.0]
    >>> solution.final, solution.method
    (True, 'fronts')
    """

    def __init__(self, run: Run, options: Options) -> None:
        """Store the arguments, and copy the times and the status of the run.

        Fields, contacts and outcome are computed on demand. A run without `until` that
        is proved final counts as stopped by "final", whatever stopped it.
        """
        self.options = options
        self.run = run
        self.system = run.system
        self.method = run.method
        self.until = run.until
        self.stopped_by = run.stopped_by
        # The limit on events may have ended the round trip that follows the proof. The
        # outcome is known by then.
        if run.final and run.until is None:
            self.stopped_by = "final"
        self.events = run.events
        self.t_end = run.t_end
        self.t_final = run.t_final
        self.t_proved = run.t_proved
        self.final = run.final
        self.accuracy = NamedItems(run.accuracy)
        self.transit_error = run.clock.transit_error

    @cached_property
    def fields(self) -> Fields:
        """State of every point of the row at every time.

        `WaveFields` if the method computed waves, `GridFields` if it computed states on
        a grid.
        """
        signals = self.run.signals
        if isinstance(signals.motion, Waves):
            return WaveFields(self.run.clock, self.run.end, signals)
        return GridFields(self.run.clock, self.run.end, signals)

    @cached_property
    def outcome(self) -> Outcome:
        """Result of the collision."""
        return outcome_of(self.run, self._totals)

    @property
    def status(self) -> str:
        """Why the run ended, in a sentence, with the remedy."""
        return self.outcome.status

    @cached_property
    @_ALLOW_UNDERFLOW
    def _totals(self) -> Totals:
        """Totals that the method computed, else totals computed from the fields."""
        if self.run.totals:
            return self.run.totals
        return totals_of(self.run, self.fields, self.contacts)

    @cached_property
    def contacts(self) -> tuple[ContactHistory, ...]:
        """History of each contact from left to right, contacts at walls included."""
        histories = []
        for i in range(len(self.run.contacts)):
            histories.append(ContactHistory(i, self.fields, self.run))
        return TupleOfParts(histories)

    # Fields ---------------------------------------------------------------------------

    @_ALLOW_UNDERFLOW
    def velocity(
        self, body: int, x: ArrayLike, t: ArrayLike, side: Side = "right"
    ) -> Floats:
        """Velocity of the material.

        Parameters
        ----------
        body : int
            Counted from the left, walls included.
        x : array_like
            m from the left end of the body; 0 in a mass or a wall.
        t : array_like
            s; broadcasts with x.
        side : "right" or "left"
            Value at a jump: just after the jump ("right") or just before it ("left").

        Returns
        -------
        array
            m/s.

        Raises
        ------
        ValueError
            For a place or time outside the solution.
        """
        return self.fields.velocity(self._index(body), x, t, side)

    @_ALLOW_UNDERFLOW
    def strain(
        self, body: int, x: ArrayLike, t: ArrayLike, side: Side = "right"
    ) -> Floats:
        """Strain, positive in tension; arguments as in `velocity`."""
        return self.fields.strain(self._index(body), x, t, side)

    @_ALLOW_UNDERFLOW
    def stress(
        self, body: int, x: ArrayLike, t: ArrayLike, side: Side = "right"
    ) -> Floats:
        """Stress E eps + eta d(eps)/dt in Pa, positive in tension.

        The arguments are those of `velocity`. ValueError for a body that is no rod, and
        for a place or time outside the solution.
        """
        strain = self.strain(body, x, t, side)
        stress = strain * self._property_along(body, x, "youngs_modulus")
        viscosity = self._property_along(body, x, "viscosity")
        if viscosity.any():
            # Only grids have viscous rods. Their strain rates have no jumps in time, so
            # that no side is needed.
            stress = stress + self.fields.strain_rate(body, x, t) * viscosity
        return stress

    @_ALLOW_UNDERFLOW
    def axial_force(
        self, body: int, x: ArrayLike, t: ArrayLike, side: Side = "right"
    ) -> Floats:
        """Stress times area in N, positive in tension; arguments as in `velocity`.

        ValueError for a body that is no rod, and for a place or time outside the
        solution.
        """
        stress = self.stress(body, x, t, side)
        return stress * self._property_along(body, x, "area")

    @_ALLOW_UNDERFLOW
    def extreme_stress(self, body: int) -> ExtremeStress:
        """Largest tension and compression in a rod, at any place and time of the run.

        The waves of the methods "fronts" and "characteristics" are constants and
        polynomials of time, whose extremes are found exactly. On a grid the extremes
        are those of the stored states, see `snapshots`, and of the forces at the ends
        in all time steps.

        Parameters
        ----------
        body : int
            A rod, counted from the left, walls included.

        Returns
        -------
        ExtremeStress
            ``tension`` and ``compression``, each with ``stress`` in Pa, positive in
            tension, the place ``x`` in m from the left end of the rod, and the time
            ``t`` in s.

        Raises
        ------
        ValueError
            If the body is not a rod.

        Examples
        --------
        A triangular pulse, which begins with its front of 100 MPa, comes back from the
        free end of a bar as tension. Where half of the pulse is reflected, its front
        meets no compression:

        >>> import rodimpact as ri
        >>> steel = ri.materials.steel
        >>> c = steel.wave_speed
        >>> strain = 100e6 / steel.youngs_modulus
        >>> pulse = ri.Samples([-strain, 0.0], step=0.2 / c)               # 0.2 m long
        >>> rod = ri.Rod(1.0, area=1e-4, material=steel)
        >>> bar = ri.System([rod], ends=(ri.Incoming(pulse), ri.Free()))
        >>> tension = ri.solve(bar, until=1.5 / c).extreme_stress(0).tension
        >>> round(tension.stress / 1e6, 6), round(tension.x, 6), round(tension.t * c, 6)
        (100.0, 0.9, 1.1)
        """
        index = self._index(body)
        self.fields.locate(index, 0.0)  # any point: raises for a body that is no rod
        return self.fields.extreme_stress(index)

    @_ALLOW_UNDERFLOW
    def field_error(self, t: ArrayLike) -> FieldError:
        """Stated errors of velocity, stress and displacement anywhere at times t in s.

        If a grid was refined, its fields are compared with those of coarser meshes. The
        first call solves the collision again on these meshes. In the first steps after
        a jump the error is as large as the jump. The fields of other methods are as
        accurate as their waves, see `accuracy`.

        Returns
        -------
        FieldError
            ``velocity`` in m/s, ``stress`` in Pa and ``displacement`` in m, each like
            t.

        Raises
        ------
        ValueError
            If the fields were not found on several meshes, or a time lies outside the
            solution.

        Examples
        --------
        >>> import rodimpact as ri
        >>> steel = ri.materials.steel.damped(loss_factor=0.02, frequency=1e3)
        >>> rod = ri.Rod(0.5, area=1e-4, material=steel, velocity=1.0)
        >>> row = ri.System([rod, ri.Wall()], gaps=[1e-5])
        >>> solution = ri.solve(row, until=4e-4)
        >>> bool(solution.field_error(3e-4).velocity < 0.02)
        True
        """
        self.fields.to_ticks(t)  # raises for times outside the solution
        message = (
            "is stated where a grid has searched for its mesh; solve with method="
            '"finite-difference", without cells and dt'
        )
        demand(len(self.run.coarser) > 0, "field_error", message)
        return field_error(self, self._coarser, array("t", t, "s"))

    @cached_property
    def _coarser(self) -> list[CoarserSolution]:
        """Solutions of the same collision on coarser meshes; none without a search.

        The collision is run again on each mesh, since the search keeps no fields.
        """
        solutions = []
        for mesh in self.run.coarser:
            solution = Solution(mesh.make_run(), self.options)
            solutions.append(CoarserSolution(mesh, solution))
        return solutions

    @_ALLOW_UNDERFLOW
    def displacement(self, body: int, x: ArrayLike, t: ArrayLike) -> Floats:
        """Displacement in m; arguments as in `velocity`.

        The reference is the unstrained body whose left end is at its position at t = 0.
        """
        return self.fields.displacement(self._index(body), x, t)

    def position(self, body: int, x: ArrayLike, t: ArrayLike) -> Floats:
        """Position in the laboratory frame, m.

        The left end of the row starts at 0. The arguments are those of `velocity`. The
        position is the position of the left end of the body at t = 0, plus x, plus the
        displacement. ValueError for x and t outside the solution.
        """
        left_end = self.fields.positions[self._index(body)]
        distance: float | Floats = 0.0  # the only x of a mass or a wall
        if isinstance(self.system.bodies[body], Rod):
            distance = array("x", x, "m")
        return left_end + distance + self.displacement(body, x, t)

    @_ALLOW_UNDERFLOW
    def soil(self, body: int, t: float) -> SoilProfile:
        """Soil along the shaft of a rod at time t in s: its forces and its plastic set.

        Parameters
        ----------
        body : int
            A rod with soil along its shaft, counted from the left, walls included.
        t : float
            s.

        Returns
        -------
        SoilProfile
            At the nodes of the mesh: ``x``, ``resistance``, ``mobilised``,
            ``displacement`` and ``plastic_set``.

        Raises
        ------
        ValueError
            If no soil holds the body along its shaft, or the time lies outside the
            solution.
        """
        index = self._index(body)
        time = scalar("t", t, "s", sign=UNCHECKED)
        tick = int(self.fields.to_ticks(time))  # raises for times outside the solution
        shaft = getattr(self.system.bodies[index], "shaft", None)
        demand(
            isinstance(shaft, Soil), "body", f"has no soil along its shaft, got {index}"
        )
        return soil_profile(self.fields, index, tick)

    @_ALLOW_UNDERFLOW
    def mean_velocity(self, body: int, t: ArrayLike) -> Floats:
        """Velocity of a body's centre of mass at times t in s, m/s, of their shape.

        For a rod this is its momentum divided by its mass.
        """
        index = self._index(body)
        if not isinstance(self.system.bodies[index], Rod):
            return self.velocity(body, 0.0, t)  # at its only point
        # The mass by the rounded transit time, with which momentum is computed too
        mass = self.fields.clock.mass(index)
        return self.fields.momentum(index, t) / mass

    @_ALLOW_UNDERFLOW
    def gauge(self, body: int, x: float) -> Gauge:
        """Record of a strain gauge at x, m from the left end of a body.

        Each entry has a time, and the strain, the velocity and the strains of both
        waves just after it. Between these times both waves at x are nearly straight
        lines. The strains of the waves are relative to the velocity at t = 0.
        ValueError for a body that is not a rod, and for a position outside the rod.
        """
        x = scalar("x", x, "m", sign=UNCHECKED)
        # With A = v - c eps, the wave running right, and B = v + c eps, the one running
        # left: eps = (B - A)/(2 c) and v = (A + B)/2, in the clock's frame.
        waves = self.fields.point_history(self._index(body), x)
        clock = self.fields.clock
        # Marks are ticks between which straight lines follow a signal closely. The
        # marks of both waves are merged, in order.
        ticks = each_once(waves.rightward.marks, waves.leftward.marks)
        times = ticks * clock.tick
        rightward = waves.rightward.at(ticks)
        leftward = waves.leftward.at(ticks)
        frame_velocity = clock.frame + clock.gravity * times  # m/s
        # With the initial velocity v0: eps = (v0 - A)/(2 c) + (B - v0)/(2 c).
        initial_velocity = (rightward[0] + leftward[0]) / 2
        strain_per_difference = 0.5 / waves.wave_speed
        return Gauge(
            body=body,
            x=x,
            times=times,
            strain=(leftward - rightward) * strain_per_difference,
            velocity=(leftward + rightward) / 2 + frame_velocity,
            rightward=(initial_velocity - rightward) * strain_per_difference,
            leftward=(leftward - initial_velocity) * strain_per_difference,
            end=self.t_end,
            record=waves.difference.times(strain_per_difference),
            tick=clock.tick,
            name=body_names(self.system.kinds)[body],
        )

    def to_xarray(self, x: ArrayLike, t: ArrayLike) -> Any:
        """All fields as an xarray Dataset (extra ``xarray``).

        Parameters
        ----------
        x : array_like
            Positions, m from the left end of each body; [x]. Beyond the right end of a
            body, fields are nan. Walls and masses are at 0, and have no strain.
        t : array_like
            Times, s; [time].

        Returns
        -------
        Dataset
            ``velocity``, ``displacement``, ``position``, ``strain``, ``stress`` and
            ``axial_force`` [body, x, time]; ``mean_velocity`` [body, time]; ``force``
            and ``gap`` [contact, time]; ``energy`` [part, time], the parts those of
            `EnergyLedger`. Every variable has its ``long_name`` and its ``units``.

        Raises
        ------
        ValueError
            For a place in no body, or a time outside the solution.

        Examples
        --------
        >>> import numpy as np, rodimpact as ri
        >>> rod = ri.Rod(0.4, area=1e-4, material=ri.materials.steel, velocity=1.0)
        >>> solution = ri.solve(ri.System([rod, ri.Wall()]), until=1e-4)
        >>> x = np.linspace(0, 0.4, 5)
        >>> data = solution.to_xarray(x=x, t=np.linspace(0, 1e-4, 11))
        >>> data["velocity"].sel(body=0, x=0.4).isel(time=5).item()
        0.0
        >>> data["force"].dims, data["stress"].attrs["units"]
        (('contact', 'time'), 'Pa')
        """
        x = array("x", x, "m").ravel()
        t = array("t", t, "s").ravel()
        inside = self._inside(x)
        data: dict[str, Any] = {}
        for name in FIELDS_OF_ALL_BODIES + FIELDS_OF_RODS:
            field = self._field(name, x, t, inside)
            data[name] = (["body", "x", "time"], field)
        mean_velocities = []
        for i in range(len(self.system.bodies)):
            mean_velocities.append(self.mean_velocity(i, t))
        data["mean_velocity"] = (["body", "time"], np.array(mean_velocities))
        for name in ("force", "gap"):
            data[name] = (["contact", "time"], self._at_contacts(name, t))
        energies = vars(self.energy(t))  # [time] each, by the name of the part
        energy = np.array(list(energies.values()))
        data["energy"] = (["part", "time"], energy)
        laws = []  # words such as "hertz"
        for contact_law in self.system.contacts:
            laws.append(contact_law.law)
        coordinates = {
            "body": (["body"], range(len(self.system.bodies))),
            "kind": (["body"], self.system.kinds),
            "x": (["x"], x),
            "time": (["time"], t),
            "part": (["part"], list(energies)),
            "contact": (["contact"], range(len(self.contacts))),
            "law": (["contact"], laws),
        }
        return dataset(
            self.system, data, coordinates, method=self.method, status=self.status
        )

    def _inside(self, x: Array) -> list[Any]:
        """Whether points x lie in each of the bodies, [body][point].

        Points are in m, and measured from the left end of each body in turn. Only 0
        lies in a wall or a mass. InvalidModel if a point lies in no body.
        """
        longest = 0.0
        inside = []
        for body in self.system.bodies:
            length = float(getattr(body, "length", 0.0))  # 0 in a wall or a mass
            longest = max(longest, length)
            farthest = length * (1 + END_RTOL)
            inside.append((x >= 0) & (x <= farthest))
        # `demand` puts the first value outside in place of {0!r}.
        message = f"must lie in a body, from 0 to {longest:.9g} m, got {{0!r}}"
        demand(np.any(inside, axis=0), "x", message, x)
        return inside

    def _field(self, name: str, x: Floats, t: Floats, inside: list[Any]) -> Floats:
        """Values of the field of that name, [body, x, time], just after times t, s.

        `inside` tells which points x, m, lie in each body, see `_inside`. Values are
        nan at other points, and in walls and masses where only rods have the field.
        """
        bodies = self.system.bodies
        values = np.full((len(bodies), x.size, t.size), np.nan)
        field = getattr(self, name)
        for i, body in enumerate(bodies):
            if isinstance(body, Rod) or name in FIELDS_OF_ALL_BODIES:
                points = x[inside[i], None]  # [point, 1], to broadcast with t
                values[i, inside[i]] = field(i, points, t)
        return values

    def _at_contacts(self, name: str, t: Floats) -> Floats:
        """Values of `ContactHistory.force` or `gap`, by name, [contact, time].

        They are in N or m, just after the times t, s.
        """
        values = np.empty((len(self.contacts), t.size))
        for k, contact in enumerate(self.contacts):
            values[k] = getattr(contact, name)(t)
        return values

    # Energy and state -----------------------------------------------------------------

    @_ALLOW_UNDERFLOW
    def energy(self, t: ArrayLike) -> EnergyLedger:
        """Energy ledger at times t in s; each entry has their shape.

        On a grid the energies are those of the stored state nearest to each time.
        Losses and works are counted from t = 0. ValueError for times outside the
        solution.
        """
        ticks = self.fields.nearest_energy_ticks(self.fields.to_ticks(t))
        # A ledger counts from its first tick, so the tick 0 is put before the others.
        from_zero = np.concatenate(([0], ticks.ravel()))
        states = bonded_groups(self.fields, from_zero)
        from_start = ledger(self.fields, self.contacts, states)
        entries = {}
        # Each entry of the ledger is [time]. The added tick 0 comes first: drop it.
        for name, energies in vars(from_start).items():
            entries[name] = energies[1:].reshape(ticks.shape)
        return EnergyLedger(**entries)

    @_ALLOW_UNDERFLOW
    def ring_down(self) -> RingDown:
        """Decay of the vibration that the collision left, to the end of the solution.

        Solve with `until` well beyond the collision: the energy of the lowest mode of a
        rod falls to 1/e in E/(eta omega^2).

        Returns
        -------
        RingDown
            Vibration energy over time, the time in which it falls to 1/e, and this time
            for the slowest mode.

        Raises
        ------
        ValueError
            If the collision is not proved to be over, something acts on the row from
            outside, the row has no rod, or too few states were kept.

        Examples
        --------
        >>> import rodimpact as ri
        >>> steel = ri.materials.steel.damped(loss_factor=0.02, frequency=1e3)
        >>> left = ri.Rod(0.4, area=1e-4, material=steel, velocity=1.0)
        >>> right = ri.Rod(1.0, area=1e-4, material=steel)
        >>> solution = ri.solve(ri.System([left, right]), until=10e-3, cells=50)
        >>> ringing = solution.ring_down()
        >>> round(ringing.decay_time / ringing.modal_decay_time, 1)
        1.0
        """
        demand(self.final, "ring_down", f"the collision is not over. {self.status}")
        message = "gravity, a driven end, soil or drag acts on and on"
        demand(not self.outcome.driven, "ring_down", message)
        has_rod = len(self.fields.rods) > 0
        demand(has_rod, "ring_down", "the row has no rod that could vibrate")
        start = self.t_final
        lies_in_solution = start < self.t_end  # False if `start` is inf or nan
        if not lies_in_solution:
            start = self.t_proved
        return ring_down(self.fields, start, self.t_end)

    @_ALLOW_UNDERFLOW
    def system_at(self, t: float) -> System:
        """State at time t in s as a new system: continue it, change it, or reverse it.

        Gaps, velocities, strains, the stretch of joints, the hardening of yielding
        contacts and the mobilised share of soil are those just after t. The gap of a
        pressed compliant contact is minus its overlap. The new system starts at t = 0.
        Waves are copied exactly: waves that are constant between jumps become `Steps`,
        other waves become `Polynomials` with the stated error of the velocities. So a
        run that continues from this system is as exact as one longer run. On a grid the
        state is constant in each cell.

        Raises
        ------
        ValueError
            If an end is driven by a function of time, within which the new system would
            begin, or the time lies outside the solution.
        """
        time = scalar("t", t, "s", sign=UNCHECKED)
        tick = int(self.fields.to_ticks(time))  # raises for times outside the solution
        for side, end in zip(("left", "right"), self.system.ends, strict=True):
            value = getattr(end, "value", None)  # only a driven end has one
            if isinstance(value, PROFILES_IN_TIME):
                message = "is driven by a function of time; drive it anew"
                raise invalid_argument(f"ends.{side}", message)
        # The accuracy is relative to the scale of velocities.
        error = self.accuracy.get("velocity", 0.0) * self.fields.clock.scale
        bodies: list[Any] = []
        for i, body in enumerate(self.system.bodies):
            if isinstance(body, Rod):
                state = state_profiles(self.fields, i, tick, error)
                shaft = body.shaft
                if isinstance(shaft, Soil):
                    shaft = shaft.replace(mobilised=self.fields.mobilised(i, tick))
                body = body.replace(
                    velocity=state.velocity, strain=state.strain, shaft=shaft
                )
            else:
                velocity = float(self.velocity(i, 0.0, time))  # at its only point
                body = body.replace(velocity=velocity)
            bodies.append(body)
        gaps = []
        contacts = []
        for contact in self.contacts:
            gap = 0.0  # a joint has none: `law_at` gives its stretch
            if contact.law.opens:
                gap = float(contact.gap(time))
            gaps.append(gap)
            contacts.append(contact.law_at(time))
        return self.system.replace(bodies=bodies, gaps=gaps, contacts=contacts)

    # Files and pictures ---------------------------------------------------------------

    def save(self, path: str | os.PathLike[str], *, force: bool = False) -> None:
        """Write the case and its outcome as a case file, which `rodimpact.load` solves.

        The file contains the system, the given options, and in the table [result] the
        outcome with its stated errors. ``rodimpact run`` also reads this file.
        `to_xarray` and `gauges_to_csv` export fields and histories.

        Parameters
        ----------
        path : str or path
            Ends in ``.toml``.
        force : bool
            Whether to replace an existing file.

        Raises
        ------
        InvalidModel
            If the name does not end in ``.toml``, a contact law is a Python function,
            which no file keeps, or the system has more numbers than a case file may
            have.
        FileExistsError
            If the file is there and `force` is false.
        """
        write_case(path, case_of(self), force=force)

    def __str__(self) -> str:
        from ..storage.report import solution_table

        return solution_table(self)

    def __repr__(self) -> str:
        """Number of bodies, end time and reason of the end, in angle brackets."""
        n = len(self.system.bodies)
        return (
            f"<Solution of {n} bodies to t = {self.t_end:.6g} s, "
            f"stopped by {self.stopped_by}>"
        )

    # Bodies ---------------------------------------------------------------------------

    def _index(self, body: int) -> int:
        """Return the index of a body; InvalidModel unless the row has such a body."""
        return integer("body", body, low=0, high=len(self.system.bodies) - 1)

    def _property_along(self, body: int, x: ArrayLike, name: str) -> Floats:
        """Values of ``"area"``, or of a number of the material, at points x of a rod.

        The points are in m from the left end of the rod; the values have their shape.
        Samples along a segment are interpolated. At a border of two segments the value
        is that of the right one. ValueError as for `Fields.locate`.
        """
        location = self.fields.locate(body, x)
        values = np.empty(location.segment.shape)
        first, _ = self.fields.clock.spans[body]  # segment in the row, counted from 1
        segments = self.fields.rods[body].segments
        for number, segment in enumerate(segments, start=first):
            value: Any = segment.area
            if name != "area":
                value = getattr(segment.material, name)
            if isinstance(value, Samples):
                value = value.values
            # A number becomes one sample: `interp` returns its value at all points.
            samples = np.atleast_1d(value)
            places = np.linspace(0.0, float(segment.length), len(samples))
            here = location.segment == number
            values[here] = np.interp(location.distance[here], places, samples)
        return values


def check_solution(value: Any) -> None:
    """Raise InvalidModel, a ValueError, unless a value is a `Solution`."""
    check_kind("solution", value, Solution, "rodimpact.solve(system)")


def check_has_rod(value: Any) -> None:
    """Raise InvalidModel, a ValueError, unless a value is a `Solution` with a rod.

    Pictures of waves call it; its message speaks of them.
    """
    check_solution(value)
    if "rod" not in value.system.kinds:
        message = (
            "has no rod, and rigid masses have no waves to be drawn; "
            "rodimpact.plot.overview(solution) draws its contacts and its energy"
        )
        raise invalid_argument("solution", message)
