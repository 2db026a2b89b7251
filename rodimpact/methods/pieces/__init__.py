"""The method "characteristics".

In a uniform rod the wave equation has d'Alembert's solution: a wave that leaves one end
arrives at the other end a transit time later. A wave is a list of polynomials in time,
its pieces. Equations are solved only at the nodes: a node is the chain of links and
masses between two rods, a small system of ordinary differential equations that two
incoming waves drive.

Where to begin: `records`, then `series`, polynomials on a piece, and `lines`, waves as
lists of pieces. A step of a node solves one piece. `nodes` does this by collocation and
Newton's method; `event_location` finds the first event in the piece, `event_errors`
bounds the error of its time, and `events` changes the state at the event. `march` is
the loop over all nodes, and `finality` proves that the collision is over. The values of
a row become records in `clock_setup`, `profile_pieces`, `initial_lines` and `layout`.
`driver` runs the kernels; `totals`, `signals`, `reading` (for the web page) and
`accuracy` read their results; the registry of methods calls `method`.
"""
