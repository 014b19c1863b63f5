"""Tests. BLAS gets one thread, as in the service: more of them wait for each other's turn."""

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
