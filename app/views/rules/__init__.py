"""Design › Rules."""

from app.views.rules.table import RulesView

__all__ = ["RulesView"]
