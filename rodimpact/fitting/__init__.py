"""Fits of systems to measured records: best parameters and their uncertainty.

Where to begin: `fit`, the public function. `measured` is a record with its measuring
chain, `images` its strain over many passages, `parameters` the numbers that vary,
`objective` the differences between prediction and record, `searching` the least-squares
search, `uncertainty` the covariance of the numbers, `additions` the cross-validation of
further numbers; `summary`, `notes` and `result` make the result.
"""
