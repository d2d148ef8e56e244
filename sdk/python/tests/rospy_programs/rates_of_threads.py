"""Loops with a rate that is changed, and a pause in two threads at one time."""
import threading

import rospy

rospy.init_node("rates_of_threads")
start = rospy.get_time()
rate = rospy.Rate(2)
rate.sleep()
rate.sleep_dur = rospy.Duration(0.2)
rate.sleep()
print("%.1f s" % (rospy.get_time() - start))
said = []


def loop(name, hz):
    own = rospy.Rate(hz)
    for _ in range(3):
        own.sleep()
        said.append((name, "%.1f" % (rospy.get_time() - start)))


threads = [threading.Thread(target=loop, args=("slow", 1.25)), threading.Thread(target=loop, args=("fast", 2))]
for thread in threads:
    thread.start()
for thread in threads:
    thread.join()
print(said)
rospy.Rate(2).sleep()
print("%.1f s" % (rospy.get_time() - start))
