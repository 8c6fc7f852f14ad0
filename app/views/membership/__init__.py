"""Design › Membership."""

from app.views.membership.chart import MembershipView

__all__ = ["MembershipView"]
