"""A word before a run gets long."""

from rodimpact.methods import duration
from rodimpact.methods.duration import Forecast


def test_a_long_run_is_announced_before_ten_seconds_and_anew_when_it_gets_far_longer(monkeypatch):
    now, said = [100.0], []
    monkeypatch.setattr(duration.time, "monotonic", lambda: now[0])
    forecast = Forecast(said.append, "a larger rtol")
    forecast.expect(5.0, "10 steps")
    now[0] = 103.0
    forecast.expect(4.0, "20 steps")
    assert not said
    forecast.expect(6.0, "30 steps")
    assert said == [
        "this run takes some 9 s, perhaps more (30 steps); a larger rtol takes less"
    ]
    now[0] = 109.0
    forecast.expect(20.0, "40 steps")
    assert len(said) == 1
    forecast.expect(3600.0, "50 steps")
    assert said[1:] == [
        "this run takes some 60 min, perhaps more (50 steps); a larger rtol takes less"
    ]


def test_nobody_who_listens_is_no_fault():
    Forecast(None, "").expect(1e9, "")
