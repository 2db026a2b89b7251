"""Numbers from elsewhere that rodimpact must reproduce: one file a case.

What must be refused is tried at random in `tests/fuzz` and `tests/storage/test_fuzz.py`, some
seconds of it by default. An hour of it:

    RODIMPACT_FUZZ=100 RODIMPACT_FUZZ_SEED=7 pytest -m "" tests/fuzz tests/storage/test_fuzz.py
"""
