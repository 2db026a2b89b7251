"""Numbers from elsewhere that rodimpact must reproduce: one file a case.

Begin with README.md, which lists the cases, then `table`, which says what a case is.
`doyen` is a short case that shows how they are written. `figures` draws the pictures of
the manual, `performance` measures the speed.

What must be refused is tried at random in `tests/fuzz` and
`tests/storage/test_fuzz.py`, some seconds of it by default. An hour of it:

    export RODIMPACT_FUZZ=100 RODIMPACT_FUZZ_SEED=7
    pytest -m "" tests/fuzz tests/storage/test_fuzz.py
"""
