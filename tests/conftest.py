"""What all tests share: reproducible hypothesis runs, matplotlib without a display, journals out of the way."""

from __future__ import annotations

import os

import pytest
from hypothesis import HealthCheck, settings

# The first call of a kernel compiles it: a deadline would measure the compiler. Without `derandomize` two runs of
# one commit could differ.
settings.register_profile(
    "workbench", deadline=None, derandomize=True, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "workbench"))

os.environ["MPLBACKEND"] = "Agg"
os.environ["OPENBLAS_NUM_THREADS"] = "1"  # as the workbench does, whichever test begins


@pytest.fixture(autouse=True, scope="session")
def journals_of_their_own(tmp_path_factory: pytest.TempPathFactory) -> None:
    """Keep the workbenches of the tests from what is left of the user's own."""
    os.environ["XDG_STATE_HOME"] = str(tmp_path_factory.mktemp("state"))
