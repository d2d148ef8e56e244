"""The part of nodes that keeps what was made with them."""

from __future__ import annotations

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any, Iterator

    from rclpy.client import Client
    from rclpy.guard_condition import GuardCondition
    from rclpy.publisher import Publisher
    from rclpy.service import Service
    from rclpy.subscription import Subscription
    from rclpy.timer import Rate, Timer


class NodeEntities:
    """Publishers, subscriptions, clients, services, timers, guard conditions and actions."""

    def _init_entities_(self) -> None:
        self._publishers: list[Publisher] = []
        self._subscriptions: list[Subscription] = []
        self._clients: list[Client] = []
        self._services: list[Service] = []
        self._timers: list[Timer] = []
        self._guards: list[GuardCondition] = []
        self._waitables_: list[Any] = []

    def _wake_executor(self) -> None:
        raise NotImplementedError

    @property
    def publishers(self) -> Iterator[Publisher]:
        """Its publishers."""
        yield from self._publishers

    @property
    def subscriptions(self) -> Iterator[Subscription]:
        """Its subscriptions."""
        yield from self._subscriptions

    @property
    def clients(self) -> Iterator[Client]:
        """Its clients."""
        yield from self._clients

    @property
    def services(self) -> Iterator[Service]:
        """Its services."""
        yield from self._services

    @property
    def timers(self) -> Iterator[Timer]:
        """Its timers."""
        yield from self._timers

    @property
    def guards(self) -> Iterator[GuardCondition]:
        """Its guard conditions."""
        yield from self._guards

    @property
    def waitables(self) -> Iterator[Any]:
        """Its actions."""
        yield from self._waitables_

    def _destroy_(self, entities: list[Any], entity: Any) -> bool:
        if entity not in entities:
            return False
        entities.remove(entity)
        entity.destroy()
        self._wake_executor()
        return True

    def destroy_publisher(self, publisher: Publisher) -> bool:
        """Destroys it; False if it is none of this node."""
        return self._destroy_(self._publishers, publisher)

    def destroy_subscription(self, subscription: Subscription) -> bool:
        """Destroys it; False if it is none of this node."""
        return self._destroy_(self._subscriptions, subscription)

    def destroy_client(self, client: Client) -> bool:
        """Destroys it; False if it is none of this node."""
        return self._destroy_(self._clients, client)

    def destroy_service(self, service: Service) -> bool:
        """Destroys it; False if it is none of this node."""
        return self._destroy_(self._services, service)

    def destroy_timer(self, timer: Timer) -> bool:
        """Destroys it; False if it is none of this node."""
        return self._destroy_(self._timers, timer)

    def destroy_guard_condition(self, guard: GuardCondition) -> bool:
        """Destroys it; False if it is none of this node."""
        return self._destroy_(self._guards, guard)

    def destroy_rate(self, rate: Rate) -> bool:
        """Destroys it; False if it is none of this node."""
        found = self.destroy_timer(rate._timer)
        rate.destroy()
        return found
