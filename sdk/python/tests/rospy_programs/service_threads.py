"""Calls are handled in threads of their own, at the same time; each caller gets its own answer."""
import threading

import rospy
from std_srvs.srv import SetBool

rospy.init_node("service_threads")
names = set()


def handle(request):
    names.add(threading.current_thread().name == threading.main_thread().name)
    rospy.sleep(0.4 if request.data else 0.8)
    return request.data, "slept"


def call(value):
    start = rospy.get_time()
    response = rospy.ServiceProxy("work", SetBool)(value)
    print(value, response.success, response.message, "%.1f s" % (rospy.get_time() - start))


service = rospy.Service("work", SetBool, handle)
threads = [threading.Thread(target=call, args=(value,)) for value in (True, False)]
for thread in threads:
    thread.start()
for thread in threads:
    thread.join()
print(names)
