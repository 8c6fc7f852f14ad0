"""The browser workbench and its command line."""

import os

# numpy's and scipy's linear algebra would use every core for matrices of a few columns, and wait for those on which
# the simulation runs: a fit then takes 25 times as long.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
