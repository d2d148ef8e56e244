"""Publishers. All of a topic in a program have one connection."""

from __future__ import annotations

import threading

from genpy import SerializationError
from hrdsl.exchange import the_exchange
from rospy import core, topic
from rospy.exceptions import ROSException, ROSSerializationException
from rospy.graph import graph
from rospy.msg import AnyMsg, args_kwds_to_message

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from hrdsl.exchange import Port


class SubscribeListener:
    """Is told of subscribers that come and go."""

    def peer_subscribe(self, topic_name: str, topic_publish: Any, peer_publish: Any) -> None:
        """There is one more; it can be sent a message that all get (`topic_publish`), or, so far as that can be told apart here,
        it alone."""

    def peer_unsubscribe(self, topic_name: str, num_peers: int) -> None:
        """There is one less."""


class Publisher(topic.Topic):
    """Sends messages to a topic."""

    impl: _PublisherImpl | None

    def __init__(
        self,
        name: str,
        data_class: Any,
        subscriber_listener: SubscribeListener | None = None,
        tcp_nodelay: bool = False,
        latch: bool = False,
        headers: dict[str, str] | None = None,
        queue_size: int | None = None,
    ) -> None:
        super().__init__(name, data_class)
        impl = topic.publishers.get(self.resolved_name) or _PublisherImpl(self.resolved_name, data_class, topic.publishers)
        impl.ref_count += 1
        self.impl = impl
        if latch:
            impl.enable_latch()
        if subscriber_listener:
            impl.add_subscriber_listener(subscriber_listener)
        if queue_size is None:
            import warnings

            warnings.warn(
                "The publisher should be created with an explicit keyword argument 'queue_size'. "
                "Please see http://wiki.ros.org/rospy/Overview/Publishers%20and%20Subscribers for more information.",
                SyntaxWarning,
                stacklevel=2,
            )

    def publish(self, *args: Any, **kwds: Any) -> None:
        """Sends a message: given as one, or by the values of its fields."""
        impl = self.impl
        if impl is None:
            raise ROSException("publish() to an unregistered() handle")
        message = args[0] if len(args) == 1 and not kwds else None
        if message.__class__ is float and impl.float_line is not None and message - message == 0.0:
            impl.tell(impl.float_line % message, impl.port)
            return
        if not core._client_ready:
            raise ROSException("ROS node has not been initialized yet. Please call init_node() first")
        if message.__class__ is not self.data_class:
            message = self._message(args, kwds)
        try:
            impl.publish(message)
        except SerializationError as error:
            raise ROSSerializationException(str(error)) from None

    def _message(self, args: tuple[Any, ...], kwds: dict[str, Any]) -> Any:
        message = args_kwds_to_message(self.data_class, args, kwds)
        return self.data_class().deserialize(message._buff) if message.__class__ is AnyMsg else message


class _PublisherImpl(topic.TopicImpl):
    kind, others = "publisher", "subscriber"

    def __init__(self, name: str, data_class: Any, table: dict[str, Any]) -> None:
        self.is_latch = False
        self.seq = 0
        self._listeners: list[SubscribeListener] = []
        self._is_watched = False
        self._has_header = data_class._has_header
        if data_class is AnyMsg:
            raise NotImplementedError("a publisher of AnyMsg on %s: name the type that it publishes" % name)
        self._json = data_class._json
        self.tell: Any = None  # once it is open
        self.float_line: bytes | None = None  # of a message that is a finite number, such as a set-point: the request, but for that
        super().__init__(name, data_class, table)

    def connect(self) -> None:
        super().connect()
        if self._listeners and self.port is not None:
            self._watch()

    def open(self) -> Port:
        port = the_exchange().open("publisher", self.resolved_name, self.type, latched=self.is_latch)
        if self.data_class._float_text is not None:
            self.tell = the_exchange().link.tell
            self.float_line = port.line(self.data_class._float_text)
        return port

    def close(self) -> None:
        self.float_line = None
        super().close()

    def enable_latch(self) -> None:
        """Those who come later get the last message, too."""
        if not self.is_latch:
            self.is_latch = True
            if self.port is not None:
                self.port.close()
                self.port = self.open()

    def publish(self, message: Any) -> None:
        port = self.port
        if port is None:
            if core._shutdown_flag:
                return
            raise ROSException("publish() to a closed topic")
        if self._has_header:
            self.seq += 1
            header = message.header
            header.seq = self.seq
            if header.frame_id is None:
                header.frame_id = "0"
        json = self._json if message.__class__ is self.data_class else getattr(message, "_json", self._json)
        port.publish(json(message).encode("ascii"))

    def add_subscriber_listener(self, listener: SubscribeListener) -> None:
        self._listeners.append(listener)
        if self.port is not None:
            self._watch()

    def _watch(self) -> None:
        if self._is_watched:
            return
        self._is_watched = True
        threading.Thread(target=self._tell_listeners, name="listeners of %s" % self.resolved_name, daemon=True).start()

    def _tell_listeners(self) -> None:
        try:
            self._tell_of_peers()
        except Exception as error:
            core.failed("publisher of %s (%s): its listener" % (self.resolved_name, self.type), error)
            raise

    def _tell_of_peers(self) -> None:
        known: list[str] = []
        the_exchange().scheduler.yield_()  # so that the program has the publisher in hand when it is told
        while not self.closed:
            now = graph.wait(lambda: self._peers(known), None)
            for _ in [peer for peer in now if peer not in known]:
                for listener in self._listeners:
                    listener.peer_subscribe(self.resolved_name, self.publish, self.publish)
            for peer in [peer for peer in known if peer not in now]:
                known = [other for other in known if other != peer]
                for listener in self._listeners:
                    listener.peer_unsubscribe(self.resolved_name, len(now))
            known = now

    def _peers(self, known: list[str]) -> Any:
        """The subscribers, if they are others than before; a list that is true even without any."""
        now = graph.programs("subscriber", self.resolved_name)
        return _Always(now) if now != known else None


class _Always(list):  # type: ignore[type-arg]
    def __bool__(self) -> bool:
        return True
