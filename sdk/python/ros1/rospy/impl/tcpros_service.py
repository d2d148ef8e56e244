"""Services, by the name of the module in which rospy has them."""

from rospy.service import Service, ServiceImpl, ServiceProxy, convert_return_to_response, wait_for_service

__all__ = ["Service", "ServiceImpl", "ServiceProxy", "convert_return_to_response", "wait_for_service"]
