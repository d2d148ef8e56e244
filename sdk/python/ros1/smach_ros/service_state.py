"""`ServiceState`: calls a service."""

from __future__ import annotations

import rospy
import smach
from smach_ros._filling import Called, attempt

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

__all__ = ["ServiceState"]


class ServiceState(smach.State):
    """Calls a service with a request that is given, or made of userdata, and puts the response there."""

    def __init__(
        self,
        service_name: str,
        service_spec: Any,
        request: Any = None,
        request_cb: Any = None,
        request_cb_args: Any = [],
        request_cb_kwargs: Any = {},
        request_key: str | None = None,
        request_slots: list[str] = [],
        response_cb: Any = None,
        response_cb_args: Any = [],
        response_cb_kwargs: Any = {},
        response_key: str | None = None,
        response_slots: list[str] = [],
        input_keys: list[str] = [],
        output_keys: list[str] = [],
        outcomes: list[str] = [],
    ) -> None:
        smach.State.__init__(self, outcomes=["succeeded", "aborted", "preempted"])
        self._service_name = service_name
        self._service_spec = service_spec
        self._proxy: Any = None
        self._request = service_spec._request_class() if request is None else request
        keys = input_keys, output_keys
        wrong = "%s callback object given to ServiceState that IS NOT a function object"
        self._request_cb = Called(self, request_cb, request_cb_args, request_cb_kwargs, keys, wrong % "Request")
        self._response_cb = Called(self, response_cb, response_cb_args, response_cb_kwargs, keys, wrong % "Response")
        self._response_cb.outcomes(self)
        self._request_key, self._request_slots = request_key, request_slots
        self._response_key, self._response_slots = response_key, response_slots
        self.register_input_keys([*request_slots, *([] if request_key is None else [request_key]), *input_keys])
        self.register_output_keys([*response_slots, *([] if response_key is None else [response_key]), *output_keys])
        self.register_outcomes(outcomes)

    def execute(self, ud: Any) -> Any:
        """Calls the service."""
        if self.preempt_requested():
            rospy.loginfo("Preempting %s before sending request." % self._service_name)
            self.service_preempt()
            return "preempted"
        failed = self._connect() or self._fill(ud)
        if failed is not None:
            return failed
        try:
            rospy.logdebug("Calling service %s with request:\n%s" % (self._service_name, str(self._request)))
            response = self._proxy(self._request)
        except rospy.ServiceException as error:
            rospy.logerr("Exception when calling service '%s': %s" % (self._service_name, str(error)))
            return "aborted"
        return self._answered(ud, response)

    def _connect(self) -> str | None:
        """The outcome, if there is no service."""
        try:
            while self._proxy is None:
                if self.preempt_requested():
                    rospy.loginfo("Preempting while waiting for service '%s'." % self._service_name)
                    self.service_preempt()
                    return "preempted"
                if rospy.is_shutdown():
                    rospy.loginfo("Shutting down while waiting for service '%s'." % self._service_name)
                    return "aborted"
                try:
                    rospy.wait_for_service(self._service_name, 1.0)
                    self._proxy = rospy.ServiceProxy(self._service_name, self._service_spec)
                    rospy.logdebug("Connected to service '%s'" % self._service_name)
                except rospy.ROSException:
                    rospy.logwarn("Still waiting for service '%s'..." % self._service_name)
        except BaseException as error:
            if smach.is_the_end(error):
                raise
            rospy.logwarn("Terminated while waiting for service '%s'." % self._service_name)
            return "aborted"
        return None

    def _fill(self, ud: Any) -> str | None:
        """The outcome, if there is no request."""
        if self._request_key is not None:
            if self._request_key not in ud:
                rospy.logerr(
                    "Requested request key '%s' not in userdata struture. Available keys are: %s"
                    % (self._request_key, str(list(ud.keys())))
                )
                return "aborted"
            self._request = ud[self._request_key]
        for key in self._request_slots:
            if key not in ud:
                rospy.logerr(
                    "Requested request slot key '%s' is not in userdata strcture. Available keys are: %s"
                    % (key, str(list(ud.keys())))
                )
                return "aborted"
            setattr(self._request, key, ud[key])
        if self._request_cb.callback is not None:
            done, update = attempt("request callback", lambda: self._request_cb(ud, self._request))
            if not done:
                return "aborted"
            self._request = self._request if update is None else update
        if self._request is None:
            rospy.logerr("Attempting to call service " + self._service_name + " with no request")
            return "aborted"
        return None

    def _answered(self, ud: Any, response: Any) -> Any:
        self._response = response
        outcome = None
        if self._response_cb.callback is not None:
            done, outcome = attempt("response callback", lambda: self._response_cb(ud, response))
            if not done:
                return "aborted"
            if outcome is not None and outcome not in self.get_registered_outcomes():
                rospy.logerr(
                    "Result callback for service %s, %s was not registered with the response_cb_outcomes argument. The"
                    " response callback returned '%s' but the only registered outcomes are: %s"
                    % (self._service_name, self._response_cb.callback, outcome, self.get_registered_outcomes())
                )
                return "aborted"
        if self._response_key is not None:
            ud[self._response_key] = response
        for key in self._response_slots:
            ud[key] = getattr(response, key)
        return "succeeded" if outcome is None else outcome
