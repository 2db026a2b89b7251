"""History of each contact: force, gap, and the episodes of touching."""

from __future__ import annotations

from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ..hints import explain_missing
from ..methods.run import Episode, Run
from ..methods.signals import Floats, Pieces, Side, each_once
from ..model import ContactLaw, Joint, Plastic, Rigid
from ..model.arguments import scalar
from ..storage.extras import optional
from .fields import Fields


class Breakpoints(NamedTuple):
    """Force and gap of a contact at some times, [n]."""

    times: Floats  # s
    force: Floats  # N, just after each time
    gap: Floats  # m


@explain_missing()
class ContactHistory:
    """Force and gap of one contact.

    Attributes
    ----------
    index : int
        The contact is between body `index` and body `index + 1`, including walls.
    law : contact law
    impulse : float
        Integral of the force, N s.
    duration : float
        Force duration, s: total time with force.
    peak_force : float
        N.
    episodes : tuple of Episode
    push : Pieces
        Force as a function of time in ticks of the clock, N.

    Examples
    --------
    >>> import rodimpact as ri
    >>> steel = ri.materials.steel
    >>> left = ri.Rod(0.4, area=1e-4, material=steel, velocity=1.0)
    >>> right = ri.Rod(1.0, area=1e-4, material=steel)
    >>> contact = ri.solve(ri.System([left, right])).contacts[0]
    >>> contact.force([1e-4, 2e-4]).round(2).tolist()  # the rods press, then only touch
    [1981.16, 0.0]
    >>> f"{contact.duration:.6g}", len(contact.episodes)
    ('0.000158493', 1)
    """

    def __init__(self, index: int, fields: Fields, run: Run) -> None:
        """Store the totals and the signals of contact `index` of a run.

        The law is the law of the system at t = 0. Signals are functions of ticks;
        `fields` and its clock convert times to ticks.
        """
        tally = run.contacts[index]  # totals of the contact
        signal = run.signals.contacts[index]
        self.index = index
        self.law = run.system.contacts[index]
        self.impulse = tally.impulse
        self.duration = tally.duration
        self.peak_force = tally.peak_force
        self.episodes = tuple(signal.episodes)
        self.push = signal.force
        self._gap = signal.gap  # m
        self._closing = signal.closing  # closing velocity, m/s
        self._fields = fields
        self._tick = fields.clock.tick  # s

    def force(self, t: ArrayLike, side: Side = "right") -> Floats:
        """Contact force, N, positive in compression; `side` decides at jumps.

        The result has the shape of t. On a grid the force is the mean over each time
        step. ValueError for times outside the solution.
        """
        ticks = self._fields.to_ticks_beside(t, side)
        return self.push.at(ticks, side)

    def gap(self, t: ArrayLike) -> Floats:
        """Distance between the two bodies, m, just after times t, s, of their shape.

        The gap of a `Rigid` contact is never negative, and exactly 0 while the bodies
        touch. The gap of a pressed compliant contact is minus the overlap. The gap of a
        joint is its stretch. If the contact has yielded, the gap is the distance of the
        deformed faces. ValueError for times outside the solution.
        """
        ticks = self._fields.to_ticks_beside(t, "right")
        gap = self._gap.at(ticks)
        if isinstance(self.law, Rigid):
            # Rigid faces do not overlap: a negative gap is round-off.
            return np.maximum(gap, 0.0)
        return gap

    def law_at(self, t: float) -> ContactLaw:
        """Contact law with which a run must begin that continues from the time t, s.

        A joint becomes a new joint with its stretch at t. A yielding contact becomes a
        new contact, hardened by the peak force up to t. Other laws do not change, and
        are returned unchanged. ValueError for a time outside the solution.
        """
        t = scalar("t", t, "s")
        tick = self._fields.to_ticks(t)
        if isinstance(self.law, Joint):
            stretch = float(self.gap(t))
            return self.law.replace(stretch=stretch)
        if isinstance(self.law, Plastic):
            # The overlap is minus the gap, so it is largest where the gap is smallest.
            # The gap is evaluated at the starts of its pieces and at t itself.
            earlier_gaps = self._gap.values[self._gap.ticks <= tick]
            smallest_earlier = float(np.min(earlier_gaps, initial=0.0))  # 0: no overlap
            smallest_gap = min(smallest_earlier, float(self.gap(t)))
            largest_overlap = -smallest_gap
            # The gap is measured from the deformed faces, so the overlap is elastic and
            # the force is the stiffness times the overlap.
            force_reached = self.law.stiffness * largest_overlap
            return self.law.hardened(force_reached)
        return self.law

    def breakpoints(self) -> Breakpoints:
        """Times, forces and gaps between which force and gap are nearly straight lines.

        Values are those just after each time. If the force is constant between jumps,
        the times are 0 and its jumps. Otherwise the times include all jumps of force
        and velocities, and further times. Straight lines between these times differ
        from force and gap by at most 5e-5 of their ranges.
        """
        is_constant_between_jumps = self.push.coefficient_count == 1
        if is_constant_between_jumps:
            ticks = self.push.ticks
        else:
            # Marks are ticks between which straight lines follow a signal closely. The
            # marks of both signals are merged, in order.
            ticks = each_once(self.push.marks, self._gap.marks)
        times = ticks * self._tick
        return Breakpoints(times, self.push.at(ticks), self._gap.at(ticks))

    def impulse_until(self, t: ArrayLike) -> Floats:
        """Impulse from 0 to times t in s, N s: the integral of the force."""
        ticks = self._fields.to_ticks(t)
        return self.push.integral(0, ticks) * self._tick

    def work_until(self, t: ArrayLike) -> Floats:
        """Work that the two bodies have done on the contact from 0 to t, J.

        The work is the integral of the force times the closing velocity. A compliant
        contact stores a part of the work; the rest is lost.
        """
        ticks = self._fields.to_ticks(t)
        return self._power.integral(0, ticks) * self._tick

    @cached_property
    def _power(self) -> Pieces:
        """Force times closing velocity, W."""
        return self.push * self._closing

    def permanent_set(self) -> float:
        """Permanent set of the contact at the end of the run, m; 0 or more.

        The gap is the distance of the deformed faces. It exceeds the distance of the
        undeformed faces by the permanent set. The distance of the undeformed faces
        grows by the displacement of the left end of the right body, minus the
        displacement of the right end of the left body. So the set is the growth of the
        gap minus the growth of this distance.
        """
        fields = self._fields
        times = [0.0, fields.end * fields.clock.tick]
        left_body = fields.clock.system.bodies[self.index]
        right_end = getattr(left_body, "length", 0.0)  # 0 in a wall or a rigid mass
        u_left = fields.displacement(self.index, right_end, times)
        # 0.0 is the left end of the right body.
        u_right = fields.displacement(self.index + 1, 0.0, times)
        distance_growth = u_right - u_left  # of the undeformed faces, [start, end]
        at_start, at_end = self.gap(times) - distance_growth
        permanent_set = float(at_end - at_start)
        return max(0.0, permanent_set)  # round-off may make it negative

    def to_dataframe(self) -> Any:
        """The episodes as a pandas DataFrame, one per row (extra ``dataframe``).

        The columns are ``start``, ``force_end`` and ``opening`` of `Episode`, s.

        Examples
        --------
        >>> import rodimpact as ri
        >>> steel = ri.materials.steel
        >>> left = ri.Rod(0.4, area=1e-4, material=steel, velocity=1.0)
        >>> right = ri.Rod(1.0, area=1e-4, material=steel)
        >>> frame = ri.solve(ri.System([left, right])).contacts[0].to_dataframe()
        >>> (frame * 1e6).round(1).values.tolist()      # us
        [[0.0, 158.5, 396.2]]
        """
        pandas = optional("pandas", "dataframe")
        return pandas.DataFrame(self.episodes, columns=list(Episode._fields))

    def __repr__(self) -> str:
        """Index, kind of law, episodes and totals, as one line in angle brackets."""
        law = type(self.law).__name__
        return (
            f"<contact {self.index} ({law}): {len(self.episodes)} episodes, "
            f"impulse {self.impulse:.6g} N s, peak force {self.peak_force:.6g} N, "
            f"force duration {self.duration:.6g} s>"
        )
