"""The method "characteristics".

Waves are polynomial pieces, contacts are small equations. In a uniform rod the wave
equation has d'Alembert's solution: a wave that leaves one end arrives at the other a
transit time later. A wave is a list of polynomials in time, its pieces. Only the nodes
are left to be solved: the chains of links and masses between two rods, each an ordinary
differential equation that two waves drive.

Where to begin: `records`, then `series`, polynomials on a piece, and `lines`, waves as
lists of pieces. A step of a node is `nodes`, collocation over a piece with Newton's
method, then `event_location`, where the piece ends early (`event_errors`: how wrong
that is), `events`, what changes between pieces, and `march`, the loop over all nodes;
`finality` proves that it is over. The values of a row become records in `clock_setup`,
`profile_pieces`, `initial_lines` and `layout`. `driver` runs the kernels; `totals`,
`signals`, `reading` (for the page) and `accuracy` read their results; `method` is what
the registry of methods calls.
"""
