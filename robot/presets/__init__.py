"""Shipped arms and scenarios, one YAML file each."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from importlib import resources
from typing import Any


@functools.cache
def read_preset(name: str) -> Mapping[str, Any]:
    """Return the contents of ``NAME.yaml``, read once; the name is one of a caller's own list."""
    import yaml  # here, because starting must not wait for it

    return yaml.safe_load(resources.files(__name__).joinpath(f"{name}.yaml").read_text(encoding="utf-8"))
