"""The stages of a collision in words: what happens when, and what is where in between.

Everything is read off the solution. Moments are the corners of its regions of constant state: there
a wave front is at an end of a rod, or two fronts cross. Between two moments the pieces of a rod
keep their order, velocity and stress, and only their boundaries, the fronts, move.
"""

from __future__ import annotations

from collections import defaultdict
from typing import NamedTuple

from ..model import Rod
from ..results.regions import regions_of
from ..results.solution import Solution
from ..storage.tables import clean
from ..units import format_si

LEGEND = "<| is a wave front that runs to the left, |> one that runs to the right."


class Stage(NamedTuple):
    """A moment, and what follows until the next one.

    Attributes
    ----------
    time : float
        s.
    events : tuple of str
        What happens at that time.
    middle : float
        Time halfway to the next moment, s.
    pieces : tuple of str
        For each rod, the pieces from left to right with the fronts between them.
    """

    time: float
    events: tuple[str, ...]
    middle: float
    pieces: tuple[str, ...]


def stages(solution: Solution, names: tuple[str, str]) -> list[Stage]:
    """Read the stages of the collision of two bodies, until the fronts after the parting.

    Parameters
    ----------
    solution : Solution
        Of uniform rods or walls that meet once.
    names : (str, str)
        What to call the bodies.

    Returns
    -------
    list of Stage
    """
    episode = solution.contacts[0].episodes[0]
    events: dict[float, list[str]] = defaultdict(list)
    events[episode.start] += [f"the {names[0]} and the {names[1]} meet"]
    for time, sentences in _fronts(solution, names).items():
        if episode.start < time < solution.t_end:
            events[time] += sentences
    events[episode.force_end] += ["the contact force ends"]
    events[episode.opening] += ["the gap opens"]
    times = sorted(t for t in events if t <= episode.opening)
    later = min((t for t in events if t > episode.opening), default=solution.t_end)
    return [
        Stage(t, tuple(events[t]), (t + after) / 2, _pieces(solution, (t + after) / 2))
        for t, after in zip(times, [*times[1:], later], strict=True)
    ]


def tell(story: list[Stage], names: tuple[str, str], rods: list[int]) -> str:
    """Write stages as lines of text; `rods` are the bodies whose pieces they describe."""
    width = max(len(names[i]) for i in rods)
    lines = []
    for stage in story:
        lines.append(f"{format_si(stage.time, 's'):>12}  {'; '.join(stage.events)}")
        for i, pieces in zip(rods, stage.pieces, strict=True):
            lines.append(f"{'':14}    {names[i]:{width}}  {pieces}")
    return "\n".join(lines)


def _fronts(solution: Solution, names: tuple[str, str]) -> dict[float, list[str]]:
    """When fronts are at the ends of the rods, and when they cross."""
    free: dict[float, list[str]] = defaultdict(list)
    sentences: dict[float, list[str]] = defaultdict(list)
    regions = regions_of(solution)
    bodies = regions.body_of_vertices().tolist()
    corners = dict.fromkeys(zip(regions.t.tolist(), bodies, regions.x.tolist(), strict=True))
    for time, body, x in corners:
        rod = solution.system.bodies[body]
        assert isinstance(rod, Rod)
        if x == (0.0 if body else rod.length):
            message = "the wave is back at the contact"
        elif x in (0.0, rod.length):
            free[time].append(f"of the {names[body]}")
            continue
        else:
            place = format_si(x, "m", 3)
            message = f"two fronts cross in the {names[body]}, {place} from its left end"
        if message not in sentences[time]:
            sentences[time].append(message)
    for time, whose in free.items():
        ends = "ends" if len(whose) > 1 else "end"
        turn = f"the wave turns back at the free {ends} {' and '.join(whose)}"
        sentences[time].insert(0, turn)
    return sentences


def _pieces(solution: Solution, time: float) -> tuple[str, ...]:
    """For each rod its pieces, with the fronts between them."""
    v0 = max(map(abs, solution.outcome.velocities_before))
    told = []
    tick = int(solution.fields.to_ticks(time))
    for body, rod in enumerate(solution.system.bodies):
        if not isinstance(rod, Rod):
            continue
        material = rod.segments[0].material
        impact = float(material.density) * float(material.wave_speed) * v0
        state = solution.fields.profile(body, tick)
        stress = state.strain * float(material.youngs_modulus)
        text = ""
        for i, (v, s) in enumerate(zip(state.velocity, stress, strict=True)):
            if i:  # v + sigma/(rho c) is the same on both sides of a front that runs right
                right = (v - state.velocity[i - 1]) * (s - stress[i - 1]) < 0
                text += "  |>  " if right else "  <|  "
            s = clean(float(s), impact)
            kind = "" if s == 0 else " tension" if s > 0 else " compression"
            text += f"{clean(float(v), v0):.3g} m/s, " + (
                f"{format_si(abs(s), 'Pa', 3)}{kind}" if s else "no stress"
            )
        told.append(text)
    return tuple(told)
