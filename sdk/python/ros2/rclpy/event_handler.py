"""The name that Jazzy has for `rclpy.qos_event`."""

from rclpy.qos_event import PublisherEventCallbacks as PublisherEventCallbacks
from rclpy.qos_event import QoSOfferedIncompatibleQoSInfo as QoSOfferedIncompatibleQoSInfo
from rclpy.qos_event import QoSRequestedIncompatibleQoSInfo as QoSRequestedIncompatibleQoSInfo
from rclpy.qos_event import SubscriptionEventCallbacks as SubscriptionEventCallbacks
from rclpy.qos_event import UnsupportedEventTypeError as UnsupportedEventTypeError
