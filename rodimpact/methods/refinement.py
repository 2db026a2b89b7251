"""Names of what a run on a time step is measured by."""

MEASURES = ("impulse", "largest force", "time of 99.9 % of the impulse")
