"""Publishers and subscribers.

As in rospy, all publishers of a topic in a program have one connection, and so have all its subscribers; the callbacks of a topic
are called in a thread of its own, one after the other.
"""

from __future__ import annotations

import threading
import types
import weakref

import genpy
from genpy import Message, SerializationError
from hrdsl.exchange import the_exchange
from hrdsl.mailbox import Mailbox
from rosgraph.names import is_legal_name
from rospy import core
from rospy.exceptions import ROSException, ROSSerializationException
from rospy.graph import graph
from rospy.log import logerr
from rospy.msg import AnyMsg, args_kwds_to_message
from rospy.names import get_caller_id, resolve_name, resolve_name_without_node_name

__all__ = ["Message", "Publisher", "SubscribeListener", "Subscriber"]

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Callable

    from hrdsl.exchange import Arrival, Port

DEFAULT_BUFF_SIZE = 65536

_publishers: dict[str, _PublisherImpl] = {}
_subscribers: dict[str, _SubscriberImpl] = {}


class Topic:
    """What both have in common."""

    impl: Any

    def __init__(self, name: str, data_class: Any) -> None:
        if not name or not isinstance(name, str):
            raise ValueError("topic name is not a non-empty string")
        if data_class is None:
            raise ValueError("topic parameter 'data_class' is not initialized")
        if not isinstance(data_class, type):
            raise ValueError("data_class [%s] is not a class" % data_class)
        if not issubclass(data_class, genpy.Message):
            raise ValueError("data_class [%s] is not a message data class" % data_class.__class__.__name__)
        if not is_legal_name(name):
            import warnings

            text = "'%s' is not a legal ROS graph resource name. This may cause problems with other ROS tools"
            warnings.warn(text % name, stacklevel=3)
        resolve = resolve_name if core.is_initialized() else resolve_name_without_node_name
        self.name: Any = resolve(name)
        self.resolved_name: Any = self.name
        self.data_class: Any = data_class
        self.type: Any = data_class._type
        self.md5sum: Any = data_class._md5sum

    def get_num_connections(self) -> int:
        """How many nodes are at the other end."""
        the_exchange().polled("connections")
        count: int = self.impl.get_num_connections()
        return count

    def unregister(self) -> None:
        """Leaves the topic."""
        impl, self.impl = self.impl, None
        if impl is not None:
            impl.release()
            self.resolved_name = self.type = self.md5sum = self.data_class = None


class _Impl:
    """The connection of a program with a topic, which is made when there is a node."""

    kind = ""
    others = ""

    def __init__(self, name: str, data_class: Any, table: dict[str, Any]) -> None:
        self.resolved_name = self.name = name
        self.data_class = data_class
        self.type = data_class._type
        self.ref_count = 0
        self.closed = False
        self.port: Port | None = None
        self._table = table
        table[name] = self
        core.when_initialized(self.connect)

    def connect(self) -> None:
        """There is a node."""
        if not self.closed and self.port is None:
            self.resolved_name = resolve_name(self.name)
            self.port = self.open()
            graph.forget()

    def open(self) -> Port:
        raise NotImplementedError

    def get_num_connections(self) -> int:
        return 0 if self.port is None else len(graph.programs(self.others, self.resolved_name))

    def has_connections(self) -> bool:
        return self.get_num_connections() > 0

    def release(self) -> None:
        """One of those that use it does so no more."""
        self.ref_count -= 1
        if self.ref_count == 0:
            self.close()
            self._table.pop(self.name, None)

    def close(self) -> None:
        self.closed = True
        port, self.port = self.port, None
        if port is not None and not the_exchange().link.stopped:
            port.close()
            graph.forget()


# ── subscribers ──


class Subscriber(Topic):
    """Lets a function be called with each message of a topic."""

    impl: _SubscriberImpl | None

    def __init__(
        self,
        name: str,
        data_class: Any,
        callback: Callable[..., Any] | None = None,
        callback_args: Any = None,
        queue_size: int | None = None,
        buff_size: int = DEFAULT_BUFF_SIZE,
        tcp_nodelay: bool = False,
    ) -> None:
        super().__init__(name, data_class)
        impl = _subscribers.get(self.resolved_name) or _SubscriberImpl(self.resolved_name, data_class, _subscribers)
        impl.ref_count += 1
        self.impl = impl
        if queue_size is not None:
            impl.set_queue_size(queue_size)
        if buff_size != DEFAULT_BUFF_SIZE:
            impl.set_buff_size(buff_size)
        self.callback, self.callback_args = callback, callback_args if callback is not None else None
        if callback is not None:
            impl.add_callback(callback, callback_args, self)

    def unregister(self) -> None:
        if self.impl is not None:
            if self.callback is not None:
                self.impl.remove_callback(self.callback, self.callback_args)
            self.callback = self.callback_args = None
            super().unregister()


class _Callback:
    """A function, and the subscriber that has brought it, for as long as the program has that."""

    __slots__ = ("call", "args", "subscriber")

    def __init__(self, call: Callable[..., Any], args: Any, subscriber: Any) -> None:
        self.call, self.args = call, args
        self.subscriber = weakref.ref(subscriber)

    def is_same(self, call: Callable[..., Any], args: Any) -> bool:
        return self.args is args and _is_same(self.call, call)


class _SubscriberImpl(_Impl):
    kind, others = "subscriber", "publisher"

    def __init__(self, name: str, data_class: Any, table: dict[str, Any]) -> None:
        self.callbacks: list[_Callback] = []
        self._box = Mailbox()
        self._latched: Any = None  # the last message of a publisher that is known to be latched
        self._header: dict[str, str] = {}
        super().__init__(name, data_class, table)

    def connect(self) -> None:
        if self.type != "*":
            super().connect()
        else:  # when somebody has the topic, and so its type is known
            threading.Thread(target=self._connect_later, name=resolve_name(self.name), daemon=True).start()

    def _connect_later(self) -> None:
        name = resolve_name(self.name)
        graph.wait(lambda: self.closed or graph.type_of(name), None)
        super().connect()

    def open(self) -> Port:
        type_name = self.type if self.type != "*" else graph.type_of(self.resolved_name) or "*"
        self._reads = self.data_class._of_json if self.type != "*" else _any_reader(type_name)
        self._header = {
            "topic": self.resolved_name, "type": type_name, "md5sum": self.data_class._md5sum, "callerid": get_caller_id(),
            "latching": "0", "message_definition": self.data_class._full_text,
        }  # fmt: skip
        port = the_exchange().open("subscriber", self.resolved_name, type_name, handler=self._box.put)
        threading.Thread(target=self._receive, name=self.resolved_name, daemon=True).start()
        return port

    def set_queue_size(self, queue_size: Any) -> None:
        """Keeps so many messages at most while the callbacks are busy; the oldest are lost."""
        if queue_size == 0:
            raise ROSException("queue size may not be set to zero")
        if type(queue_size) is not int:
            raise ROSException("queue size must be an integer")
        self._box.limit(None if queue_size == -1 else queue_size)

    def set_buff_size(self, buff_size: Any) -> None:
        if type(buff_size) is not int:
            raise ROSException("buffer size must be an integer")
        if buff_size <= 0:
            raise ROSException("buffer size must be a positive integer")

    def add_callback(self, cb: Callable[..., Any], cb_args: Any, subscriber: Any) -> None:
        """Calls it from now on. Where a program makes the same subscriber again and again, and keeps none of them, it is called
        once."""
        for known in self.callbacks:
            if known.subscriber() is None and known.is_same(cb, cb_args):
                known.call, known.subscriber = cb, weakref.ref(subscriber)
                self.ref_count -= 1
                break
        else:
            self.callbacks = self.callbacks + [_Callback(cb, cb_args, subscriber)]
        if self._latched is not None:
            self._invoke(self._latched, cb, cb_args)

    def remove_callback(self, cb: Callable[..., Any], cb_args: Any) -> None:
        if self.closed:
            return
        for at, known in enumerate(self.callbacks):
            if known.call == cb and known.args == cb_args:
                self.callbacks = self.callbacks[:at] + self.callbacks[at + 1 :]
                return
        raise KeyError("no matching cb")

    def close(self) -> None:
        super().close()
        self.callbacks = []
        self._box.put(None)

    def _receive(self) -> None:
        while True:
            arrival: Arrival | None = self._box.get()
            if arrival is None or self.closed:
                return
            try:
                message = self._reads(arrival["message"])
            except genpy.DeserializationError as error:
                logerr("unable to receive a message on topic %s: %s" % (self.resolved_name, error))
                continue
            message._connection_header = self._header
            publisher = _publishers.get(self.name)
            if arrival.get("latched") or publisher is not None and publisher.is_latch:
                self._latched = message
            for callback in self.callbacks:
                self._invoke(message, callback.call, callback.args)

    def _invoke(self, message: Any, cb: Callable[..., Any], cb_args: Any) -> None:
        try:
            if cb_args is not None:
                cb(message, cb_args)
            else:
                cb(message)
        except Exception:
            import traceback

            if not core.is_shutdown():
                logerr("bad callback: %s\n%s" % (cb, traceback.format_exc()))


def _is_same(one: Any, other: Any) -> bool:
    """Whether they are one function, or two that were made by the same line of the program and have the same in hand."""
    if one == other:
        return True
    if type(one) is not type(other):
        return False
    if hasattr(one, "func") and hasattr(one, "keywords"):  # `functools.partial`
        return _is_same(one.func, other.func) and one.args == other.args and one.keywords == other.keywords
    if type(one) is not types.FunctionType or one.__code__ is not other.__code__ or one.__defaults__ != other.__defaults__:
        return False
    try:
        cells = zip(one.__closure__ or (), other.__closure__ or ())
        return all(mine.cell_contents is its.cell_contents for mine, its in cells)
    except ValueError:  # one is empty
        return False


def _any_reader(type_name: str) -> Callable[[Any], AnyMsg]:
    """Of messages that become bytes."""
    import io

    from hrdsl.interfaces import class_of

    cls = class_of(type_name)

    def read(value: Any) -> AnyMsg:
        file = io.BytesIO()
        cls._of_json(value).serialize(file)
        return AnyMsg().deserialize(file.getvalue())

    return read


# ── publishers ──


class SubscribeListener:
    """Is told of subscribers that come and go."""

    def peer_subscribe(self, topic_name: str, topic_publish: Any, peer_publish: Any) -> None:
        """There is one more; it can be sent a message that all get (`topic_publish`), or, so far as that can be told apart here,
        it alone."""

    def peer_unsubscribe(self, topic_name: str, num_peers: int) -> None:
        """There is one less."""


class Publisher(Topic):
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
        impl = _publishers.get(self.resolved_name) or _PublisherImpl(self.resolved_name, data_class, _publishers)
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
        if not core._client_ready:
            raise ROSException("ROS node has not been initialized yet. Please call init_node() first")
        if len(args) == 1 and not kwds:
            message = args[0]
            kind = message.__class__
            if kind is float:
                message = self.data_class(message)
            elif kind is not self.data_class:
                message = self._message(args, kwds)
        else:
            message = self._message(args, kwds)
        try:
            impl.publish(message)
        except SerializationError as error:
            raise ROSSerializationException(str(error)) from None

    def _message(self, args: tuple[Any, ...], kwds: dict[str, Any]) -> Any:
        message = args_kwds_to_message(self.data_class, args, kwds)
        return self.data_class().deserialize(message._buff) if message.__class__ is AnyMsg else message


class _PublisherImpl(_Impl):
    kind, others = "publisher", "subscriber"

    def __init__(self, name: str, data_class: Any, table: dict[str, Any]) -> None:
        self.is_latch = False
        self.seq = 0
        self._listeners: list[SubscribeListener] = []
        self._has_header = data_class._has_header
        if data_class is AnyMsg:
            raise NotImplementedError("a publisher of AnyMsg on %s: name the type that it publishes" % name)
        self._json = data_class._json
        super().__init__(name, data_class, table)

    def open(self) -> Port:
        if self._listeners:
            self._watch()
        return the_exchange().open("publisher", self.resolved_name, self.type, latched=self.is_latch)

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
        port.publish(self._json(message).encode("ascii"))

    def add_subscriber_listener(self, listener: SubscribeListener) -> None:
        self._listeners.append(listener)
        if self.port is not None and len(self._listeners) == 1:
            self._watch()

    def _watch(self) -> None:
        threading.Thread(target=self._tell_listeners, name="listeners of %s" % self.resolved_name, daemon=True).start()

    def _tell_listeners(self) -> None:
        known: list[str] = []
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


def published_here() -> list[str]:
    """The topics of this program."""
    return sorted({*_publishers, *_subscribers})
