"""What all tests share: reproducible hypothesis runs, matplotlib without a display."""

from __future__ import annotations

import os

from hypothesis import HealthCheck, settings

# The first call of a kernel compiles it: a deadline would measure the compiler. Without `derandomize` two runs of
# one commit could differ.
settings.register_profile(
    "workbench", deadline=None, derandomize=True, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "workbench"))

os.environ["MPLBACKEND"] = "Agg"
