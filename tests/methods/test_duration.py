"""A word before a run gets long."""

import pytest

from rodimpact.methods import duration
from rodimpact.methods.duration import Forecast, how_long


def test_a_long_run_is_announced_before_five_seconds_and_anew_when_it_gets_far_longer(
    monkeypatch,
):
    now, said = [100.0], []
    monkeypatch.setattr(duration.time, "monotonic", lambda: now[0])
    forecast = Forecast(said.append, "a larger rtol")
    forecast.expect(3.9, "10 steps")
    now[0] = 103.0
    forecast.expect(0.9, "20 steps")
    assert not said
    forecast.expect(6.0, "30 steps")
    assert said == [
        "this run takes some 9 s, perhaps more (30 steps); a larger rtol takes less"
    ]
    now[0] = 109.0
    forecast.expect(20.0, "40 steps")
    assert len(said) == 1
    forecast.expect(3700.0, "50 steps")
    assert said[1:] == [
        "this run takes some 1 h 1 min, perhaps more (50 steps); a larger rtol takes less"
    ]


def test_nobody_who_listens_is_no_fault():
    Forecast(None, "").expect(1e9, "")


@pytest.mark.parametrize(
    ("seconds", "said"),
    [
        (0.2, "0 s"),
        (59.4, "59 s"),
        (59.6, "1 min 0 s"),
        (3725, "1 h 2 min"),
        (1e6, "277 h 46 min"),
    ],
)
def test_times_left(seconds, said):
    assert how_long(seconds) == said
