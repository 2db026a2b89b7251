"""The method "finite-difference": states on a staggered grid.

Begin with `method.run_grid`. The files in the order in which to read them:

- records: `records` (arrays of the kernels), `mesh` (nodes and cells of a row)
- physics: `grid_kernel` (a time step), `contact_kernel` (links on a time step),
  `elimination_kernel` (equations of damping and lateral inertia)
- time: `scheme` (constants of the equations), `start` (state at t = 0), `run` (steps,
  states)
- driver: `method` (mesh and end of a run), `refinement` (finer meshes and stated
  errors), `smoothness` (their order), `proof` (no contact follows)
- results: `measures` and `forces` (of contacts and ends), `signals` (the `Run` of all
  methods); the fields are in `results.grid_fields`
"""
