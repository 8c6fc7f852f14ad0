"""Design › Inference."""

from app.views.inference.explain import ExplainView
from app.views.inference.operators import InferenceView

__all__ = ["ExplainView", "InferenceView"]
