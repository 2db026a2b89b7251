"""Records of strain gauges over time: the strain, its two waves, and its pulses."""

from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Rectangle, StepPatch

from ..methods.signals import Floats
from ..model.arguments import check_kind
from ..results.gauges import Gauge
from .labels import legend_above
from .panels import Draft, Picture, axes_or_new, draw_zero, finish, format_axes
from .sampling import steps_until, thinned
from .scales import Scale, joined_by_and, time_scale, x_scale
from .style import colours, styled

MICROSTRAIN = Scale(1e6, "strain", "microstrain")
MAX_BOLD_STEPS = 200  # steps of a record up to which its line is bold
PULSE_RTOL = 0.01  # part of the largest strain of a wave: less is no pulse


class _Pulse(NamedTuple):
    """First interval of time in which a wave exceeds `PULSE_RTOL`."""

    start: float  # s
    stop: float  # s
    is_tension: bool  # whether the sum of its strains is positive


@styled
def gauge(
    record: Gauge, ax: Axes | None = None, transmitted: Gauge | None = None
) -> Picture:
    """Draw the record of a strain gauge, its two waves, and its pulses.

    The first wave at the gauge is the incident pulse. The first later wave in the
    opposite direction is the reflected pulse. The first wave at a second gauge, beyond
    the specimen, is the transmitted pulse. The incident pulse lasts while its wave
    exceeds a hundredth of the largest strain of a wave at the gauge. The windows of the
    other pulses begin at their arrival and are as long. Each window is shaded on the
    side of its sign. A bar that vibrates at t = 0 has no such pulses.

    Strain is given in microstrain.

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
    Picture
        With the steps `strain`, `rightward`, `leftward`, and `transmitted` or None; the
        rectangles `windows` of the pulses by name.

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
    check_kind("record", record, Gauge, "solution.gauge(1, 0.5)")
    records = [record]
    if transmitted is not None:
        check_kind("transmitted", transmitted, Gauge, "solution.gauge(1, 0.5)")
        records.append(transmitted)
    ax = axes_or_new(ax, width=5.6, height=3.0)
    time = time_scale(record.end)  # ValueError if the duration is 0

    # What is measured.
    pulses = _pulses(records)

    # What is drawn.
    series = colours().series
    width = 2.5  # of the faint line of the strain, under the lines of the waves
    if record.times.size <= MAX_BOLD_STEPS:
        width = 5.0
    strain = _draw_steps(
        ax,
        record,
        record.strain,
        time,
        label="strain",
        color=colours().faint,
        linewidth=width,
        zorder=1,
    )
    rightward = _draw_steps(
        ax,
        record,
        record.rightward,
        time,
        label="wave running right",
        color=series[0],
    )
    leftward = _draw_steps(
        ax,
        record,
        record.leftward,
        time,
        label="wave running left",
        color=series[1],
        linestyle="--",
    )
    beyond = None
    if transmitted is not None:
        beyond = _draw_steps(
            ax,
            transmitted,
            transmitted.strain,
            time,
            label="transmitted strain",
            color=series[3],
            linestyle="-.",
        )
    draw_zero(ax)
    format_axes(
        ax,
        xlim=(0, record.end * time.factor),
        ylim=ax.get_ylim(),  # now fixed: the windows will fill the height
        xlabel=time.label,
        ylabel=MICROSTRAIN.label,
    )
    windows = _shade(ax, pulses, record.end, time)

    positions = []
    for each in records:
        positions.append(f"{each.name} at {x_scale(each.x).write(each.x)}")
    named = (strain, rightward, leftward, beyond, *windows.values())
    title = f"gauge on {joined_by_and(positions)}"
    # The legend is drawn twice: now so that the layout leaves room for it, and in
    # `write_words` once the width is final.
    legend_above(ax, named, title=title)
    picture = Picture(
        ax=ax,
        strain=strain,
        rightward=rightward,
        leftward=leftward,
        transmitted=beyond,
        windows=windows,
    )

    def write_words() -> None:
        """Fit the legend to the final width."""
        legend_above(ax, named, title=title)

    return finish(Draft(picture, write_words))


def _draw_steps(
    ax: Axes, record: Gauge, values: Floats, time: Scale, **style: Any
) -> StepPatch:
    """Draw strains [time] of a record as steps; of a long record only the extreme ones.

    `style` are matplotlib's settings of the line.
    """
    style.setdefault("linewidth", 1.4)
    # A piece with more than two coefficients is curved between its times.
    is_smooth = record.record.coefficient_count > 2
    curve = thinned(steps_until(record.end, record.times, values, is_smooth))
    return ax.stairs(
        curve.values * MICROSTRAIN.factor,
        curve.edges * time.factor,
        baseline=None,
        **style,
    )


def _pulses(records: list[Gauge]) -> dict[str, _Pulse]:
    """Pulses "incident" and "reflected" of the first record, by name.

    A second record adds the pulse "transmitted". These windows begin when the pulse
    arrives, and all are as long as the incident pulse. {} is returned if a pulse other
    than the incident one begins at t = 0: the bar then vibrates from the start.
    """
    incident, reflected = _first_pulses(records[0])
    others = {"reflected": reflected}
    if len(records) > 1:
        transmitted, _ = _first_pulses(records[1])
        others["transmitted"] = transmitted
    vibrates_at_first = any(pulse.start == 0 for pulse in others.values())
    if vibrates_at_first:
        return {}
    pulses = {"incident": incident}
    for name, pulse in others.items():
        stop = pulse.start + incident.stop - incident.start
        pulses[name] = pulse._replace(stop=stop)
    return pulses


def _first_pulses(record: Gauge) -> list[_Pulse]:
    """First pulses of the two waves of a record, one each, the earlier one first.

    A pulse lasts while its wave exceeds `PULSE_RTOL` of the largest strain of both
    waves. A wave that never exceeds it has a pulse of no duration at the end.
    """
    times = np.append(record.times, record.end)
    waves = (record.rightward, record.leftward)
    least = PULSE_RTOL * np.abs(waves).max()
    pulses = []
    for wave in waves:
        # `argmax` finds the first True, `argmin` the first False. The values appended
        # stand for the end of the record.
        is_strong = np.abs(wave) > least
        first = int(np.append(is_strong, True).argmax())
        after = first + int(np.append(is_strong[first:], False).argmin())
        is_tension = bool(wave[first:after].sum() > 0)
        pulses.append(_Pulse(float(times[first]), float(times[after]), is_tension))
    return sorted(pulses)  # by `start`


def _shade(
    ax: Axes, pulses: dict[str, _Pulse], end: float, time: Scale
) -> dict[str, Rectangle]:
    """Shade the windows of pulses on the Axes; return the rectangles by name.

    A window of tension reaches from 0 upward, one of compression downward. Windows are
    cut at `end`, s; a pulse that begins there or later has none.
    """
    series = colours().series
    shades = {"incident": series[0], "reflected": series[1], "transmitted": series[3]}
    low, high = ax.get_ylim()
    windows: dict[str, Rectangle] = {}
    for name, pulse in pulses.items():
        if pulse.start >= end:
            continue
        duration = min(pulse.stop, end) - pulse.start
        window = Rectangle(
            (pulse.start * time.factor, 0.0),
            width=duration * time.factor,
            height=high if pulse.is_tension else low,
            color=shades[name],
            alpha=0.18,
            linewidth=0,
            zorder=0,
            label=name,
        )
        ax.add_patch(window)
        windows[name] = window
    return windows
