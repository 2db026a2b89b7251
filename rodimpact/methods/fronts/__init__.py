"""The method "fronts": every wave front is followed from one end of a rod to the other.

It is exact to round-off, and to the rounding of transit times that have no common
measure. Where to begin: `records`; the event loop in `contact`, `event_queue` and
`events`; `energy`, `finality` and `members`, which run members to their end. The values
of a row become records in `family_layout` and `initial_state`. `batch` and `driver` run
the kernels, `run`, `totals`, `signals`, `accuracy` and `status` read their results, and
`method` and `families` are what the registry of methods calls.
"""
