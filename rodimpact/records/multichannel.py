"""Several signals over the same times: one table, one Dataset.

>>> from rodimpact.records.signal import Signal
>>> import pathlib, tempfile
>>> incident = Signal([0.0, 1.0], dt=1e-6, unit="V")
>>> bars = {"incident": incident, "specimen": Signal([0, 9], dt=1e-6)}
>>> with tempfile.TemporaryDirectory() as folder:
...     write_signals(f"{folder}/shot.csv", bars)
...     print(pathlib.Path(folder, "shot.csv").read_text())
time [s],incident [V],specimen [1]
0.0,0.0,0.0
1e-06,1.0,9.0
<BLANKLINE>
"""

from collections.abc import Mapping
from typing import Any

import numpy as np

from ..hints import explain_arguments
from ..model.arguments import check_kind
from ..model.frozen import InvalidModel, Problems, invalid_argument
from ..model.quantities import Floats
from ..storage.extras import optional
from ..storage.tables import heading, misnamed, write_table
from ..storage.writing import PathLike
from ..units import shown
from ..version import __version__
from .signal import Signal


@explain_arguments
def write_signals(
    path: PathLike, signals: Mapping[str, Signal], *, force: bool = False
) -> None:
    """Write signals as a table: times, and a column for each signal, with units.

    Parameters
    ----------
    path : str or path
        Path of the CSV file; `read_signals` reads the same signals from it.
    signals : mapping of str to Signal
        Signals by column name, as `read_signals` returns them; all with the same times.
    force : bool
        Whether to replace an existing file.

    Raises
    ------
    InvalidModel
        If there is no signal, times differ, or a name cannot be a head of the table.
    FileExistsError
        If the file exists and `force` is false.

    Examples
    --------
    >>> import pathlib, tempfile, rodimpact as ri
    >>> force = ri.Signal([0.0, 2.0, 0.0], dt=0.5, unit="N", name="force")
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = pathlib.Path(folder, "record.csv")
    ...     ri.write_signals(path, {"force": force})
    ...     path.read_text().splitlines()
    ['time [s],force [N]', '0.0,0.0', '0.5,2.0', '1.0,0.0']
    """
    times = _times_of(signals)
    problems: Problems = []
    headers = [heading("time", "s")]
    columns = [times]
    for name, signal in signals.items():
        fault = misnamed(name)
        if fault:
            problems.append(("signals", fault))
        else:
            headers.append(heading(name, signal.unit))
            columns.append(signal.values)
    if problems:
        raise InvalidModel(problems)
    write_table(path, headers, [columns], force=force)  # all rows in one block


@explain_arguments
def signals_to_xarray(signals: Mapping[str, Signal]) -> Any:
    """Return signals as an xarray Dataset over ``time``, with units (extra ``xarray``).

    The Dataset has an attribute ``version``, the version of rodimpact.

    Parameters
    ----------
    signals : mapping of str to Signal
        Signals by variable name; all with the same times.

    Raises
    ------
    InvalidModel
        If there is no signal, or times differ.

    Examples
    --------
    >>> import rodimpact as ri
    >>> force = ri.Signal([0.0, 2.0, 0.0], dt=0.5, unit="N")
    >>> data = ri.signals_to_xarray({"force": force})
    >>> data["force"].attrs["units"], data["time"].values.tolist()
    ('N', [0.0, 0.5, 1.0])
    """
    _times_of(signals)  # refuses signals with different times
    xarray = optional("xarray", "xarray")
    variables = {}
    for name, signal in signals.items():
        variables[name] = signal.to_xarray()
    return xarray.Dataset(variables, attrs={"version": __version__})


@explain_arguments
def signals_from_xarray(data: Any) -> dict[str, Signal]:
    """Make a signal from each variable of a Dataset.

    The variables and their time coordinates must have an attribute ``units``.

    Parameters
    ----------
    data : Dataset
        Variables over one dimension, the time.

    Returns
    -------
    dict of str to Signal
        Signals in SI units, by variable name.

    Raises
    ------
    ValueError
        If `data` is not a Dataset, and in the cases of `Signal.from_xarray`.

    Examples
    --------
    >>> import rodimpact as ri
    >>> force = ri.Signal([0.0, 2.0, 0.0], dt=0.5, unit="N")
    >>> back = ri.signals_from_xarray(ri.signals_to_xarray({"force": force}))
    >>> back["force"].values.tolist(), back["force"].unit
    ([0.0, 2.0, 0.0], 'N')
    """
    if not hasattr(data, "data_vars"):
        raise invalid_argument("data", f"must be an xarray Dataset, got {shown(data)}")
    signals = {}
    for name, variable in data.data_vars.items():
        signals[str(name)] = Signal.from_xarray(variable)
    return signals


def _times_of(signals: Any) -> Floats:
    """The common times of all signals, s.

    InvalidModel if the argument is not a mapping of signals by name, if it is empty, or
    if the times of the signals differ.
    """
    if not isinstance(signals, Mapping) or not signals:
        message = (
            "must be signals by name, such as {'incident': Signal([0.0, 1.0], dt=1e-6)}"
        )
        raise invalid_argument("signals", f"{message}, got {shown(signals)}")
    for name, signal in signals.items():
        check_kind(f"signals.{name}", signal, Signal, "Signal([0.0, 1.0], dt=1e-6)")
    first_name, *other_names = signals
    times: Floats = signals[first_name].times
    for name in other_names:
        if not np.array_equal(signals[name].times, times):
            raise invalid_argument(
                "signals",
                f"{shown(name)} and {shown(first_name)} have different times; use "
                ".resampled(times=...) with the times of one of them",
            )
    return times
