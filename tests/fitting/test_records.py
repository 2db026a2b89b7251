"""The fit of a measured pulse, and standard errors against what halves of the record say."""

import numpy as np
import pytest
from validation_cases import validation_module

import rodimpact as ri

BLOCK = 1e-5  # s


@pytest.mark.exhaustive
def test_standard_errors_are_those_of_halves_of_the_record():
    """Six halves scatter by sqrt(2) standard errors; all searches end at one place."""
    pulses = validation_module("measured_pulses")
    shot = pulses.TITANIUM
    vary = {pulses.LENGTH: shot.length, **pulses.ENDS, pulses.SPEED: (4200.0, 5400.0)}
    system = pulses.row_of(shot, shot.bar.wave_speed, ri.Hertz(1e10), None, 2.5e-4)
    record = pulses.record(shot)[0].window(*shot.windows[0])
    level = record.pulse().plateau

    def fitted(kept):
        part = ri.Signal(record.values[kept], record.times[kept], unit="V")
        measured = ri.Measured(  # half a pulse does not tell when it comes, as a trigger does
            part, (1, 0.02), 0.361, shot.bar.radius, shift=(-9e-5, -7e-5), level=level)
        return ri.fit(system, measured, vary, 2.5e-4, interval=4e-7)

    n = len(record)
    i, blocks = np.arange(n), ((record.times - record.start) / BLOCK).astype(int)
    chosen = np.random.default_rng(1).permutation(blocks[-1] + 1)[: (blocks[-1] + 1) // 2]
    halves = [i < n // 2, i >= n // 2, (i >= n // 4) & (i < 3 * n // 4), blocks % 2 == 0,
              blocks % 2 == 1, np.isin(blocks, chosen)]
    whole = fitted(i >= 0)
    found = [fitted(kept).values for kept in halves]
    for name, error in whole.standard_errors.items():
        scatter = np.std([values[name] for values in found], ddof=1)
        own = 1 / np.sqrt(2 * (len(found) - 1))  # relative error of a scatter of six itself
        assert error >= (1 - own) * scatter / np.sqrt(2), name
        assert error <= 5 * scatter, name
    for end in whole.descents:
        for name, value in end.values.items():
            assert abs(value - whole.values[name]) < 0.01 * whole.standard_errors[name]
    assert whole.misfits[0] < 0.02
