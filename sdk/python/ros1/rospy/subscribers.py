"""Subscribers. All of a topic in a program have one connection; their callbacks are called in a thread of the topic, one after
the other."""

from __future__ import annotations

import threading
import types
import weakref

import genpy
from hrdsl import told
from hrdsl.exchange import the_exchange
from hrdsl.interfaces import class_of
from hrdsl.mailbox import Mailbox
from rospy import core, topic
from rospy.exceptions import ROSException
from rospy.graph import graph
from rospy.header import ConnectionHeader
from rospy.log import logerr
from rospy.msg import AnyMsg
from rospy.names import resolve_name

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Callable

    from hrdsl.exchange import Arrival, Port

DEFAULT_BUFF_SIZE = 65536


class Subscriber(topic.Topic):
    """Lets a function be called with each message of a topic."""

    impl: _SubscriberImpl | None
    _has_no_thread = False

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
        table = topic.subscribers
        impl = table.get(self.resolved_name) or _SubscriberImpl(self.resolved_name, data_class, table, self._has_no_thread)
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


class Unreadable:
    """A message that is none of its type."""

    def __init__(self, error: genpy.DeserializationError) -> None:
        self.error = error


class Listener(Subscriber):
    """Lets a function be called that puts the message by, and neither waits nor fails: no thread is made for it, and the topic is opened
    without waiting for a reply. It may get something `Unreadable`, too."""

    _has_no_thread = True


class _Callback:
    """A function, and the subscriber that has brought it, for as long as the program has that."""

    __slots__ = ("call", "args", "subscriber")

    def __init__(self, call: Callable[..., Any], args: Any, subscriber: Any) -> None:
        self.call, self.args = call, args
        self.subscriber = weakref.ref(subscriber)

    def is_same(self, call: Callable[..., Any], args: Any) -> bool:
        return self.args is args and _is_same(self.call, call)


class _SubscriberImpl(topic.TopicImpl):
    kind, others = "subscriber", "publisher"

    def __init__(self, name: str, data_class: Any, table: dict[str, Any], has_no_thread: bool) -> None:
        self.callbacks: list[_Callback] = []
        self._has_no_thread = has_no_thread and data_class._type != "*"
        self._box = Mailbox()
        self._latched: Any = None  # the last message of a publisher that is known to be latched
        self._header = ConnectionHeader(self.others, name)
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
        cls = self.data_class if self.type != "*" else class_of(type_name)
        self._header = ConnectionHeader(
            self.others,
            self.resolved_name,
            topic=self.resolved_name,
            type=type_name,
            md5sum=cls._md5sum,
            latching="0",
            message_definition=cls._full_text,
        )
        self._latched_header = self._header.with_latching()
        handler, is_told = (self._hear, True) if self._has_no_thread else (self._box.put, False)
        port = the_exchange().open("subscriber", self.resolved_name, type_name, handler=handler, is_told=is_told)
        if not is_told:
            self._start()
        return port

    def _start(self) -> None:
        threading.Thread(target=self._run, name=self.resolved_name, daemon=True).start()

    def _hear(self, arrival: Arrival) -> None:
        self._box.put(arrival)
        if self._has_no_thread:  # when a thread of it would have its turn
            the_exchange().scheduler.errand(self._take)

    def _take(self) -> None:
        if self.closed or not len(self._box):
            return
        arrival = self._box.get()
        try:
            message = self._read(arrival)
        except genpy.DeserializationError as error:
            message = Unreadable(error)
        for callback in self.callbacks:
            callback.call(message)

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
        if self._has_no_thread and not subscriber._has_no_thread:
            self._has_no_thread = False
            if self.port is not None:
                self._start()
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

    def _run(self) -> None:
        try:
            self._receive()
        except Exception as error:  # that what a callback has published was refused
            core.failed(str(self), error)
            raise

    def __str__(self) -> str:
        return "subscriber of %s (%s)" % (self.resolved_name, self.type)

    def _receive(self) -> None:
        while True:
            arrival: Arrival | None = self._box.get()
            if arrival is None or self.closed:
                return
            try:
                message = self._read(arrival)
            except genpy.DeserializationError as error:
                logerr("unable to receive a message on topic %s: %s" % (self.resolved_name, error))
                continue
            for callback in self.callbacks:
                self._invoke(message, callback.call, callback.args)

    def _read(self, arrival: Arrival) -> Any:
        """The message; of a latched one it keeps the last."""
        message = self._reads(arrival["message"])
        publisher = topic.publishers.get(self.name)
        is_latched = arrival.get("latched") or publisher is not None and publisher.is_latch
        message._connection_header = self._latched_header if is_latched else self._header
        if is_latched:
            self._latched = message
        return message

    def _invoke(self, message: Any, cb: Callable[..., Any], cb_args: Any) -> None:
        try:
            if cb_args is not None:
                cb(message, cb_args)
            else:
                cb(message)
        except Exception as error:
            import traceback

            if not core.is_shutdown():
                logerr("bad callback: %s\n%s" % (cb, traceback.format_exc()))
                core.failed("%s: %s" % (self, told.name_of(cb)), error)


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

    cls = class_of(type_name)

    def read(value: Any) -> AnyMsg:
        file = io.BytesIO()
        cls._of_json(value).serialize(file)
        return AnyMsg().deserialize(file.getvalue())

    return read
