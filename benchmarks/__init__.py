"""Speed, as ratios to a peer measured in the same run where there is one: `make bench`.

BLAS gets one thread, as in the service.
"""

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
