"""Channels of TDMS files of LabVIEW, with times from the properties of the channels."""

from __future__ import annotations

from typing import Any, BinaryIO, NamedTuple

import numpy as np

from ..model.quantities import Floats
from ..storage.extras import optional
from ..storage.reading import FileFormatError
from ..units import one_line, shown
from .heads import spelt

ENDING = ".tdms"
TIME = "time"
"""Name of the column of times, which is made from the properties of the channels."""


class ChannelTable(NamedTuple):
    """Columns of a TDMS file, with the same attributes as a `Table`."""

    names: list[str]
    units: list[str]
    columns: list[Floats]

    def place_of(self, row: int) -> str:
        """Name of the sample of a row, such as "sample 1" for the row 0."""
        return f"sample {row + 1}"


class _Clock(NamedTuple):
    """Time of the first sample, and the time step, s."""

    start: float
    step: float


def read_tdms(file: BinaryIO) -> ChannelTable:
    """Channels of numbers in a TDMS file, after a column of times.

    The times follow from the properties ``wf_start_offset`` and ``wf_increment``, s.
    Without a time step the column of times is left out, as are channels without
    numbers. Needs the extra ``tdms``.

    Raises
    ------
    FileFormatError
        If the file is not a TDMS file, has no channel of numbers, or its channels have
        different start times or time steps.
    """
    nptdms = optional("nptdms", "tdms")
    file.seek(0)
    try:
        groups = nptdms.TdmsFile.read(file).groups()
    except Exception as error:  # the package has errors of its own, and those of NumPy
        raise FileFormatError(
            f"is no TDMS file that npTDMS reads ({one_line(str(error))}); export it as "
            "text"
        ) from None
    channels = []
    for group in groups:
        for channel in group.channels():
            if len(channel) and np.issubdtype(channel.dtype, np.number):
                channels.append(channel)
    if not channels:
        raise FileFormatError("has no channel with numbers")
    names = _names_of(channels)
    units = []
    columns = []
    for channel in channels:
        units.append(spelt(str(channel.properties.get("unit_string", ""))))
        columns.append(np.array(channel[:], dtype=float))
    table = ChannelTable(names, units, columns)
    clock = _common_clock(names, channels)
    if clock is None:
        return table
    count = max(map(len, columns))
    times: Floats = clock.start + clock.step * np.arange(count, dtype=float)
    return ChannelTable([TIME, *names], ["s", *units], [times, *columns])


def _names_of(channels: list[Any]) -> list[str]:
    """Names of channels; ``group/name`` if several channels have the same name."""
    names = [str(channel.name) for channel in channels]
    full_names = []
    for name, channel in zip(names, channels, strict=True):
        if names.count(name) > 1:
            name = f"{channel.group_name}/{name}"
        full_names.append(name)
    return full_names


def _common_clock(names: list[str], channels: list[Any]) -> _Clock | None:
    """Start time and time step of all channels; None if they have no time step.

    Both are properties of a channel, and 0 if the property is missing. FileFormatError
    if the channels differ in either.
    """
    clocks = []
    for channel in channels:
        step = float(channel.properties.get("wf_increment", 0.0))
        start = float(channel.properties.get("wf_start_offset", 0.0))
        clocks.append(_Clock(start, step))
    for name, clock in zip(names, clocks, strict=True):
        if clock != clocks[0]:
            raise FileFormatError(
                f"channel {shown(name)} has the time step {clock.step:g} s from "
                f"{clock.start:g} s on, {shown(names[0])} has {clocks[0].step:g} s "
                f"from {clocks[0].start:g} s; save "
                "channels with different clocks in different files"
            )
    if clocks[0].step == 0:
        return None
    return clocks[0]
