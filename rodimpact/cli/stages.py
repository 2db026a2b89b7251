"""The stages of a collision in words: events, and the state of the rods in between.

Everything is read off the solution. Moments are the corners of its regions of constant
state: there a wave front is at an end of a rod, or two fronts cross. Between two
moments the pieces of a rod keep their order, velocity and stress, and only their
boundaries, the fronts, move.
"""

from typing import Any, NamedTuple

from ..results.regions import regions_of
from ..results.solution import Solution
from ..storage.tables import without_round_off
from ..units import format_si

LEGEND = "<| is a wave front that runs to the left, |> one that runs to the right."


class Event(NamedTuple):
    """An event of a collision."""

    time: float  # s
    sentence: str


def stage_lines(solution: Solution, names: tuple[str, str]) -> str:
    """The stages of a collision of two bodies, up to the fronts after opening.

    Each stage is a moment, its events, and for each rod its pieces halfway to the next
    moment, from left to right with the fronts between them.

    Parameters
    ----------
    solution : Solution
        A collision of uniform rods or walls that meet once.
    names : (str, str)
        Names of the bodies.
    """
    sentences_at = _sentences_by_time(solution, names)
    opening = solution.contacts[0].episodes[0].opening
    times = sorted(time for time in sentences_at if time <= opening)
    later_times = [time for time in sentences_at if time > opening]
    end = min(later_times, default=solution.t_end)
    rods = {}
    for i, body in enumerate(solution.system.bodies):
        if body.kind == "rod":
            rods[i] = names[i]
    width = max(map(len, rods.values()))
    lines = []
    for time, next_time in zip(times, [*times[1:], end], strict=True):
        sentences = f"\n{'':14}".join(sentences_at[time])
        lines.append(f"{format_si(time, 's'):>12}  {sentences}")
        for i, name in rods.items():
            pieces = _pieces(solution, i, (time + next_time) / 2)
            lines.append(f"{'':18}{name:{width}}  {pieces}")
    return "\n".join(lines)


def _sentences_by_time(
    solution: Solution, names: tuple[str, str]
) -> dict[float, list[str]]:
    """Sentences on all events, each once, by their time, s.

    They are the first touch, fronts up to the end of the run, the end of the force and
    the opening of the gap.
    """
    episode = solution.contacts[0].episodes[0]
    events = [Event(episode.start, f"the {names[0]} and the {names[1]} meet")]
    for event in _front_events(solution, names):
        if episode.start < event.time < solution.t_end:
            events.append(event)
    events.append(Event(episode.force_end, "the contact force ends"))
    events.append(Event(episode.opening, "the gap opens"))
    sentences_at: dict[float, list[str]] = {}
    for event in dict.fromkeys(events):  # each once
        sentences_at.setdefault(event.time, []).append(event.sentence)
    return sentences_at


def _front_events(solution: Solution, names: tuple[str, str]) -> list[Event]:
    """Events of fronts in a collision of two bodies: one at an end, or two that cross.

    They are the corners of the regions of constant state. An event at a corner that
    several regions share occurs several times in the list.
    """
    regions = regions_of(solution)
    times = regions.t.tolist()
    bodies = regions.body_of_vertices().tolist()
    positions = regions.x.tolist()
    events = []
    for time, i, x in zip(times, bodies, positions, strict=True):
        rod: Any = solution.system.bodies[i]
        contact_end = rod.length  # the first body touches with its right end
        if i > 0:
            contact_end = 0.0
        if x == contact_end:
            sentence = "the wave is back at the contact"
        elif x in (0.0, rod.length):
            sentence = f"the wave turns back at the free end of the {names[i]}"
        else:
            distance = f"{format_si(x, 'm', digits=3)} from its left end"
            sentence = f"two fronts cross in the {names[i]}, {distance}"
        events.append(Event(time, sentence))
    return events


def _pieces(solution: Solution, body: int, time: float) -> str:
    """Velocity and stress of a rod's pieces at a time, s, with fronts between them.

    Numbers are 0 if they are round-off compared with those of the impact, v, rho c v.
    """
    impact_velocity = max(map(abs, solution.outcome.velocities_before))
    rod: Any = solution.system.bodies[body]
    material = rod.segments[0].material
    impedance = float(material.density) * float(material.wave_speed)
    impact_stress = impedance * impact_velocity
    tick = int(solution.fields.to_ticks(time))
    state = solution.fields.profile(body, tick)
    velocities = state.velocity
    stresses = state.strain * float(material.youngs_modulus)
    text = ""
    for k in range(len(velocities)):
        v = velocities[k]
        stress = stresses[k]
        if k > 0:
            # v + stress/(rho c) is equal on both sides of a front that runs right, so
            # the changes of v and of the stress have opposite signs.
            v_change = v - velocities[k - 1]
            stress_change = stress - stresses[k - 1]
            is_rightward = v_change * stress_change < 0
            text += "  |>  " if is_rightward else "  <|  "
        shown_velocity = f"{without_round_off(float(v), scale=impact_velocity):.3g} m/s"
        text += f"{shown_velocity}, {_stress_text(float(stress), impact_stress)}"
    return text


def _stress_text(stress: float, scale: float) -> str:
    """A stress as a text: tension, compression, or none beside its scale.

    Round-off beside `scale`, Pa, is no stress.
    """
    stress = without_round_off(stress, scale)
    if stress == 0:
        return "no stress"
    kind = "compression"
    if stress > 0:
        kind = "tension"
    return f"{format_si(abs(stress), 'Pa', digits=3)} {kind}"
