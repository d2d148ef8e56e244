"""Waiting for services, services that end, and proxies that persist."""
# departs: a persistent proxy that was closed connects again at the next call, which fails in rospy
import rospy
from std_srvs.srv import Trigger

rospy.init_node("service_waits")


def waited(call, **keys):
    start = rospy.get_time()
    try:
        print(call(**keys), rospy.get_time() - start < 0.2)
    except Exception as error:
        print(type(error).__name__, error, 0.4 < rospy.get_time() - start < 0.9)


proxy = rospy.ServiceProxy("later", Trigger)
waited(proxy.wait_for_service, timeout=0.5)
waited(lambda timeout: rospy.wait_for_service("later", timeout), timeout=rospy.Duration(0.5))
waited(lambda timeout: rospy.wait_for_service("~mine", timeout), timeout=0.5)
waited(proxy.wait_for_service, timeout=0)
waited(proxy.wait_for_service, timeout=-1)
made = []
rospy.Timer(rospy.Duration(0.75), lambda event: made.append(rospy.Service("later", Trigger, lambda r: (True, "here"))), oneshot=True)
start = rospy.get_time()
rospy.wait_for_service("later")
print("there", 0.7 < rospy.get_time() - start < 1.3, proxy().message)
waited(proxy.wait_for_service)
persistent = rospy.ServiceProxy("later", Trigger, persistent=True)
print([persistent().message for _ in range(3)])
persistent.close()
try:
    print(persistent().message)
except Exception as error:
    print(type(error).__name__, error)
proxy.close()
print(proxy().message)
made[0].shutdown()
made[0].shutdown("again")
try:
    proxy()
except rospy.ServiceException as error:
    print(error)
again = rospy.Service("later", Trigger, lambda r: (True, "here again"))
print(proxy().message)
rospy.Timer(rospy.Duration(0.5), lambda event: again.shutdown(), oneshot=True)
print(again.spin(), again.done)
