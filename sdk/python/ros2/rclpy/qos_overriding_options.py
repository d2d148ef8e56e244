"""Profiles that parameters override: accepted and not used, unless a parameter really overrides one."""

from __future__ import annotations

from rclpy.qos import QoSPolicyKind

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any, Callable, Iterable


class InvalidQosOverridesError(Exception):
    """A profile that the callback refuses."""


class QosCallbackResult:
    """What such a callback returns."""

    def __init__(self) -> None:
        self.successful = False
        self.reason = ""


class QoSOverridingOptions:
    """Which policies parameters may override."""

    def __init__(
        self,
        policy_kinds: Iterable[QoSPolicyKind],
        *,
        callback: Callable[[Any], Any] | None = None,
        entity_id: str | None = None,
    ) -> None:
        self.policy_kinds = list(policy_kinds)
        self.callback = callback
        self.entity_id = entity_id

    @classmethod
    def with_default_policies(cls, *, callback: Any = None, entity_id: str | None = None) -> QoSOverridingOptions:
        """History, depth and reliability."""
        kinds = (QoSPolicyKind.HISTORY, QoSPolicyKind.DEPTH, QoSPolicyKind.RELIABILITY)
        return cls(kinds, callback=callback, entity_id=entity_id)
