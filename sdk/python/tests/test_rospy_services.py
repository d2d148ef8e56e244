"""Services of ROS 1, on both sides."""

import unittest

from system import System
from tables import run_ros

SECOND = 10**9
ADD = {"robot_msgs__Add": "int64 a\nint64 b\n---\nint64 sum\n"}


class Services(unittest.TestCase):
    def said(self, text, system=None):
        finished = run_ros(text, ["std_msgs", "std_srvs"], system=system, more=ADD)
        self.assertEqual(finished.code, 0, finished.err)
        return finished.out.splitlines(), finished.err

    def test_calls_in_one_program(self):
        text = """
            import rospy
            from robot_msgs.srv import Add, AddRequest, AddResponse
            rospy.init_node("node")
            answers = {1: AddResponse(5), 2: 6, 3: [7], 4: {"sum": 8}, 5: None, 6: (1, 2), 7: {"a": 1}, 8: "text"}
            def handle(request):
                if request.a in answers:
                    return answers[request.a]
                if request.a == 9:
                    raise rospy.ServiceException("not today")
                raise ValueError("no %d" % request.a)
            service = rospy.Service("add", Add, handle)
            rospy.wait_for_service("add")
            add = rospy.ServiceProxy("add", Add)
            for n in range(1, 11):
                try:
                    print(n, add(n, 0).sum if n % 2 else add(AddRequest(a=n)).sum)
                except rospy.ServiceException as error:
                    print(n, error)
            for wrong in (lambda: add(1), lambda: add("x", 1), lambda: rospy.Service("add", Add, handle)):
                try:
                    wrong()
                except Exception as error:
                    print(type(error).__name__, error)
            service.shutdown()
            try:
                add(1, 2)
            except rospy.ServiceException as error:
                print(error)
            """
        out, err = self.said(text)
        error = "service [/add] responded with an error: b'"
        self.assertEqual(
            out,
            [
                "1 5", "2 6", "3 7", "4 8",
                "5 " + error + "service cannot process request: service handler returned None'",
                "6 service [/add] responded with an error: b\"service cannot process request: handler returned wrong number of values:"
                " Invalid number of arguments, args should be ['sum'] args are(1, 2)\"",
                "7 " + error + "service cannot process request: handler returned invalid value: a is not an attribute of AddResponse'",
                "8 " + error + "error processing request: field sum must be an integer type'",
                "9 " + error + "service cannot process request: not today'",
                "10 " + error + "error processing request: no 10'",
                "TypeError Invalid number of arguments, args should be ['a', 'b'] args are(1,)",
                "SerializationError field a must be an integer type",
                "ServiceException service [/add] already registered",
                "service [/add] unavailable",
            ],
        )  # fmt: skip
        self.assertIn("[ERROR] [1735689600.000000]: Error processing request: no 10\n['Traceback", err)

    def test_handlers_run_side_by_side(self):
        text = """
            import rospy, threading
            from robot_msgs.srv import Add
            rospy.init_node("node")
            def handle(request):
                rospy.sleep(request.a)
                return request.a + request.b
            service = rospy.Service("add", Add, handle)
            def call(a):
                print(rospy.ServiceProxy("add", Add, persistent=True)(a, 1).sum, rospy.get_time() % 60)
            threads = [threading.Thread(target=call, args=(a,)) for a in (2, 1)]
            for thread in threads:
                thread.start()
            """
        self.assertEqual(self.said(text)[0], ["2 1.0", "3 2.0"])

    def test_services_of_others(self):
        text = """
            import rospy
            from std_srvs.srv import SetBool, Trigger
            rospy.init_node("node")
            try:
                rospy.wait_for_service("light", timeout=1)
            except rospy.ROSException as error:
                print(error, rospy.get_time() % 60)
            rospy.wait_for_service("light")
            print(rospy.get_time() % 60)
            light = rospy.ServiceProxy("light", SetBool)
            light.wait_for_service(rospy.Duration(5))
            print(light(True).message, light(data=False).success)
            try:
                rospy.ServiceProxy("dark", Trigger)()
            except rospy.ServiceException as error:
                print(error)
            """
        system = System(
            [(2 * SECOND, lambda system: system.others_open("server", "/light", "std_srvs/SetBool"))],
            services={"/light": lambda request: {"success": request["data"], "message": "done"}, "/dark": lambda request: "broken"},
        )
        self.assertEqual(
            self.said(text, system)[0],
            [
                "timeout exceeded while waiting for service /light 1.0",
                "2.0",
                "done False",
                "service [/dark] responded with an error: b'broken'",
            ],
        )
        light = {"request": "await", "kind": "client", "name": "/light"}
        again = {**light, "type": "std_srvs/SetBool", "give_up": 7 * SECOND}
        self.assertEqual(system.awaited, [{**light, "give_up": SECOND}, light, again])

    def test_called_from_outside(self):
        text = """
            import rospy
            from std_srvs.srv import SetBool
            rospy.init_node("node")
            def handle(request):
                print("asked", request.data, rospy.get_time() % 60)
                return True, "ok"
            rospy.Service("light", SetBool, handle).spin()
            """
        system = System([(SECOND, lambda system: system.call("/light", {"data": True}))], end=2 * SECOND)
        self.assertEqual(self.said(text, system)[0], ["asked True 1.0"])
        # System counts calls that are open; none is.
        self.assertEqual(system.calls, {})


if __name__ == "__main__":
    unittest.main()
