"""The method "fronts": every wave front is followed from one end of a rod to the other.

It is exact, except for round-off and for the rounding of transit times that have no
common measure. Read `records` first, then the event loop in `contact`, `event_queue`
and `events`, then `energy`, `finality` and `members`, which run members to their end.
The values of a row become records in `family_layout` and `initial_state`. `batch` and
`driver` run the kernels; `run`, `totals`, `signals`, `accuracy` and `status` read their
results. The registry of methods calls `method` and `families`.
"""
