"""Environment of all tests: the one of script/environment, also where pytest is called directly."""

import logging
import os

for name, value in {
    "OMP_NUM_THREADS": "1",
    "NUMBA_NUM_THREADS": str(min(2, os.cpu_count() or 1)),
    "OMPI_ALLOW_RUN_AS_ROOT": "1",
    "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
    "MPLBACKEND": "Agg",
}.items():
    os.environ.setdefault(name, value)

# dolfinx 0.5 reports each compiled form through the root logger
logging.getLogger().setLevel(logging.WARNING)
logging.getLogger("FFCx").setLevel(logging.WARNING)
