"""Tables of records, spoilt at random: signals come of them, or one sentence with the
place.
"""

import warnings

import pytest
from fuzz.generators import SEEDS, TIMES, called, one_of, spoilt_bytes
from numpy.random import default_rng

import rodimpact as ri

EXAMPLES = 60 * TIMES  # of each seed
TABLES = [
    "shot 12\ntime_s,incident_V,transmitted_V\n"
    + "".join(f"{i}e-7,{i * i % 7 - 3},{i % 5}.5\n" for i in range(12)),
    "t (ms);bar (mV)\r\n" + "".join(f"0,00{i};-{i},5\r\n" for i in range(9)),
    "Time\tA\n(us)\t(mV)\n\n" + "".join(f"{i}.0\t{i}.25\n" for i in range(9)),
]
OPTIONS = [{}, {}, {"rate": 1e6}, {"time_unit": "us"}, {"units": "V"}, {"decimal": ","}]


@pytest.mark.parametrize("seed", SEEDS)
def test_spoilt_tables_are_read_or_refused(tmp_path, seed):
    """Randomly spoilt tables of records are read with random options: the result is a
    dict of signals or FileFormatError, and both occur.
    """
    rng = default_rng(seed)
    path = tmp_path / "shot.txt"
    kinds = set()
    for _ in range(EXAMPLES):
        path.write_bytes(spoilt_bytes(rng, one_of(rng, TABLES)))
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", ri.ClippedSignal)
            result = called(ri.read_signals, path, **one_of(rng, OPTIONS))
        kinds.add(type(result))
        if isinstance(result, dict):
            for signal in result.values():
                assert isinstance(signal, ri.Signal)
    # Both happened, and no other error.
    assert kinds == {dict, ri.FileFormatError}
