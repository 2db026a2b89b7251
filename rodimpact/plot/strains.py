"""Record of a strain gauge and the pulses in it: exact steps, not samples.

Of very many steps the least and the largest in each of a thousand intervals are drawn.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Rectangle, StepPatch

from ..methods.signals import Floats
from ..model.arguments import of_kind
from ..results.gauges import Gauge
from .sampling import steps_until, telling
from .scales import Scale, engineering, listed, place_scale, time_scale
from .style import axes, colours, dress, legend_above, picture, styled

BOLD_UP_TO = 200  # steps of a record of strain
MICROSTRAIN = (1e-8, 0.1)  # largest strains for which it is the unit to use
MICROSECONDS = (1e-6, 0.05)  # the same for times, s
FAINTEST = 0.01  # of the largest strain that a wave carries: less is no pulse


@picture
class GaugeRecord(NamedTuple):
    """Artists of a strain gauge's record; `windows` are shaded, by name."""

    ax: Axes
    strain: StepPatch
    rightward: StepPatch
    leftward: StepPatch
    transmitted: StepPatch | None
    windows: dict[str, Rectangle]


@styled
def gauge(
    record: Gauge, ax: Axes | None = None, transmitted: Gauge | None = None
) -> GaugeRecord:
    """Draw the record of a strain gauge, its two waves, and its pulses.

    The first wave at the gauge is the incident pulse. The first later wave in the opposite
    direction is the reflected pulse. The first wave at a second gauge, beyond the specimen, is the
    transmitted pulse. The incident pulse lasts while its wave exceeds a hundredth of the largest
    strain of a wave at the gauge. The windows of the other pulses begin at their arrival and are as
    long. Each window is shaded on the side of its sign. A bar that vibrates at t = 0 has no such
    pulses.

    Strain is given in microstrain and time in microseconds, or in another power of ten if that
    would be out of proportion.

    Parameters
    ----------
    record : Gauge
        From `Solution.gauge`.
    ax : Axes, optional
        By default the Axes of a new figure.
    transmitted : Gauge, optional
        Record of a gauge on the bar beyond the specimen, of the same solution.

    Returns
    -------
    GaugeRecord

    Raises
    ------
    ValueError
        If the duration of the record is 0.

    Examples
    --------
    The pulse of a striker is twice as long as the striker:

    >>> import rodimpact as ri
    >>> steel = ri.materials.steel
    >>> bars = [ri.Rod(0.2, area=1e-4, material=steel, velocity=10.0),
    ...         ri.Rod(1.0, area=1e-4, material=steel)]
    >>> picture = ri.plot.gauge(ri.solve(ri.System(bars)).gauge(1, 0.5))
    >>> window = picture.windows["incident"]
    >>> print(f"{window.get_width():.2f} {2e6 * bars[0].transit_time:.2f}")
    79.25 79.25
    """
    records = [record] if transmitted is None else [record, transmitted]
    for each in records:
        of_kind("record", each, Gauge, "solution.gauge(1, 0.5)")
    ax = axes(ax, 5.6, 3.0)
    usual = MICROSECONDS[0] <= record.end < MICROSECONDS[1]
    time = Scale(1e6, "time t", "µs") if usual else time_scale(record.end)
    largest = max(float(np.abs(r.strain).max()) for r in records)
    usual = largest == 0 or MICROSTRAIN[0] <= largest < MICROSTRAIN[1]
    scale = Scale(1e6, "strain", "microstrain") if usual else engineering("strain", largest, "")

    def steps(of: Gauge, values: Floats, name: str, **how: Any) -> StepPatch:
        edges, values = steps_until(of.end, of.times, values, smooth=of.record.size > 2)
        kept = telling(values)  # waves of a grid are drawn state by state
        edges = np.append(edges[kept], of.end) * time.factor
        return ax.stairs(values[kept] * scale.factor, edges, baseline=None, label=name,
                         **{"linewidth": 1.4, **how})

    faint, series = colours().faint, colours().series
    shades = {"incident": series[0], "reflected": series[1], "transmitted": series[3]}
    width = 5.0 if record.times.size <= BOLD_UP_TO else 2.5
    strain = steps(record, record.strain, "strain", color=faint, linewidth=width, zorder=1)
    rightward = steps(record, record.rightward, "wave running right", color=series[0])
    leftward = steps(record, record.leftward, "wave running left", color=series[1], linestyle="--")
    beyond = None if transmitted is None else steps(
        transmitted, transmitted.strain, "transmitted strain", color=series[3], linestyle="-.")
    ax.axhline(0.0, color=faint, linewidth=0.6, zorder=0)
    low, high = ax.get_ylim()
    ax.set(xlim=(0, record.end * time.factor), ylim=(low, high), xlabel=time.label,
           ylabel=scale.label)
    windows = {
        pulse.name: Rectangle(
            (pulse.start * time.factor, 0.0), (pulse.stop - pulse.start) * time.factor,
            high if pulse.tension else low, color=shades[pulse.name], alpha=0.18, linewidth=0,
            zorder=0, label=pulse.name)
        for pulse in _pulses(record, transmitted)
    }
    for window in windows.values():
        ax.add_patch(window)
    lines = (strain, rightward, leftward, beyond, *windows.values())
    places = listed([f"{r.name} at {place_scale(r.x).write(r.x)}" for r in records])
    legend_above(ax, [line for line in lines if line is not None], title=f"gauge on {places}")
    dress(ax)
    return GaugeRecord(ax, strain, rightward, leftward, beyond, windows)


class _Pulse(NamedTuple):
    """When a wave passes a gauge, s, and whether it stretches the bar."""

    start: float
    stop: float
    tension: bool
    name: str


def _pulses(record: Gauge, transmitted: Gauge | None) -> list[_Pulse]:
    """The pulses in one record, or two."""
    passing = [_pulse(record, wave, "incident") for wave in (record.rightward, record.leftward)]
    incident, reflected = sorted(passing, key=lambda pulse: pulse.start)
    others = [reflected._replace(name="reflected")]
    if transmitted is not None:
        waves = transmitted.rightward, transmitted.leftward
        others.append(min(_pulse(transmitted, wave, "transmitted") for wave in waves))
    if any(pulse.start == 0 for pulse in others):
        return []
    last = incident.stop - incident.start
    pulses = [incident, *(p._replace(stop=min(p.start + last, record.end)) for p in others)]
    return [pulse for pulse in pulses if pulse.start < record.end]


def _pulse(record: Gauge, wave: Floats, name: str) -> _Pulse:
    """The first time a wave is more than faint; it begins at the end if it never is."""
    largest = max(np.abs(record.rightward).max(), np.abs(record.leftward).max())
    strong = np.abs(wave) > FAINTEST * largest
    if not strong.any():
        return _Pulse(record.end, record.end, False, name)
    first = int(strong.argmax())
    length = int(np.append(strong[first:], False).argmin())
    here, times = wave[first : first + length], np.append(record.times, record.end)
    return _Pulse(float(times[first]), float(times[first + length]),
                  bool(here[np.abs(here).argmax()] > 0), name)
