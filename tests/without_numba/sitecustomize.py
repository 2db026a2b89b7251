"""On PYTHONPATH, this makes Python do as if numba were not installed, in children
too.
"""

import sys

sys.modules["numba"] = None
