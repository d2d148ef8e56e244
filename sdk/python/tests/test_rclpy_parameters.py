"""Parameters of ROS 2's nodes, and the arguments after `--ros-args`."""

import unittest

from ros2_programs import TRIED, Ros2Case


class Parameters(Ros2Case):
    def test_declaring(self):
        text = TRIED + """
rclpy.init()
n = Node("n")
print(n.declare_parameter("speed", 1.5).value, n.get_parameter("speed").get_parameter_value().double_value)
tried(lambda: n.get_parameter("speed").type_)
tried(lambda: n.declare_parameter("speed", 2.0))
tried(lambda: n.get_parameter("nope"))
tried(lambda: n.get_parameter_or("nope", Parameter("nope", value=3)).value)
tried(lambda: n.declare_parameter("typed", Parameter.Type.INTEGER).value)
tried(lambda: n.get_parameter("typed"))
tried(lambda: n.declare_parameter("", 3))
tried(lambda: n.declare_parameter("bad", [1, "a"]))
tried(lambda: n.declare_parameter("bad", None, ParameterDescriptor()))
tried(lambda: len(n.declare_parameters("ns", [("a", 1), ("b", "x", ParameterDescriptor()), ("c.d", [1.0, 2.0])])))
tried(lambda: {k: v.value for k, v in n.get_parameters_by_prefix("ns").items()})
tried(lambda: [p.value for p in n.get_parameters(["ns.a", "ns.b"])])
tried(lambda: n.list_parameters([], 0).names)
tried(lambda: n.list_parameters(["ns"], 2).names)
tried(lambda: n.undeclare_parameter("ns.a"))
tried(lambda: n.has_parameter("ns.a"))
m = Node("m", allow_undeclared_parameters=True, parameter_overrides=[Parameter("k", value="v")])
tried(lambda: m.get_parameter("zz").value)
tried(lambda: m.set_parameters([Parameter("zz", value=1)])[0].successful)
tried(lambda: m.get_parameter("zz").value)
tried(lambda: m.declare_parameter("k", "d").value)
a = Node("a", automatically_declare_parameters_from_overrides=True, parameter_overrides=[Parameter("k", value=2)])
tried(lambda: a.get_parameter("k").value)
"""
        out = [
            "1.5 1.5",
            "Type.DOUBLE",
            "ParameterAlreadyDeclaredException: ('Parameter(s) already declared', ['speed'])",
            "ParameterNotDeclaredException: ('Invalid access to undeclared parameter(s)', 'nope')",
            "3",
            "None",
            "ParameterUninitializedException: The parameter 'typed' is not initialized",
            "InvalidParameterException: ('Invalid parameter name', '')",
            "TypeError: The given value is not a list of one of the allowed types '[1, 'a']'.",
            "ValueError: Cannot declare a statically typed parameter with default value of type PARAMETER_NOT_SET",
            "3",
            "{'a': 1, 'b': 'x', 'c.d': [1.0, 2.0]}",
            "[1, 'x']",
            "['use_sim_time', 'speed', 'typed', 'ns.a', 'ns.b', 'ns.c.d']",
            "['ns.a', 'ns.b', 'ns.c.d']",
            "None",
            "False",
            "None",
            "True",
            "1",
            "v",
            "2",
        ]
        self.assertEqual(self.said(text), out)

    def test_setting(self):
        text = TRIED + """
rclpy.init()
n = Node("n")
n.declare_parameter("speed", 1.5)
tried(lambda: n.set_parameters([Parameter("nope", value=1)]))
tried(lambda: n.set_parameters([Parameter("speed", value=1)])[0])
tried(lambda: n.set_parameters([Parameter("speed", value=2.5)])[0])

def check(parameters):
    for p in parameters:
        if p.name == "speed" and p.value > 5:
            return SetParametersResult(successful=False, reason="too fast")
    return SetParametersResult(successful=True)

n.add_on_set_parameters_callback(check)
tried(lambda: n.set_parameters([Parameter("speed", value=9.0)])[0])
tried(lambda: n.get_parameter("speed").value)
n.add_post_set_parameters_callback(lambda ps: print("post", [p.name for p in ps]))
tried(lambda: n.set_parameters([Parameter("speed", Parameter.Type.DOUBLE, 4.0)])[0].successful)
tried(lambda: Parameter("x", Parameter.Type.INTEGER, "a"))
n.remove_on_set_parameters_callback(check)
tried(lambda: n.set_parameters_atomically([Parameter("speed", value=9.0)]).successful)
"""
        out = [
            "ParameterNotDeclaredException: ('Invalid access to undeclared parameter(s)', ['nope'])",
            "rcl_interfaces.msg.SetParametersResult(successful=False, reason=\"Wrong parameter type, expected "
            "'Type.DOUBLE' got 'Type.INTEGER'\")",
            "rcl_interfaces.msg.SetParametersResult(successful=True, reason='')",
            "rcl_interfaces.msg.SetParametersResult(successful=False, reason='too fast')",
            "2.5",
            "post ['speed']",
            "True",
            "ValueError: Type 'Type.INTEGER' and value 'a' do not agree",
            "post ['speed']",
            "True",
        ]
        self.assertEqual(self.said(text), out)

    def test_descriptors(self):
        text = TRIED + """
rclpy.init()
n = Node("n")
d = ParameterDescriptor(description="x", integer_range=[IntegerRange(from_value=0, to_value=10, step=2)])
tried(lambda: n.declare_parameter("count", 4, d).value)
tried(lambda: n.set_parameters([Parameter("count", value=5)])[0].reason)
tried(lambda: n.set_parameters([Parameter("count", value=12)])[0].reason)
limits = FloatingPointRange(from_value=0.0, to_value=1.0, step=0.25)
tried(lambda: n.declare_parameter("ratio", 2.0, ParameterDescriptor(floating_point_range=[limits])))
tried(lambda: n.declare_parameter("ratio", 0.3, ParameterDescriptor(floating_point_range=[limits])))
tried(lambda: n.declare_parameter("ratio", 0.75, ParameterDescriptor(floating_point_range=[limits])).value)
tried(lambda: n.declare_parameter("fixed", "x", ParameterDescriptor(read_only=True)).value)
tried(lambda: n.set_parameters([Parameter("fixed", value="y")])[0].reason)
tried(lambda: n.undeclare_parameter("fixed"))
tried(lambda: n.describe_parameter("count"))
tried(lambda: n.declare_parameter("any", 1, ParameterDescriptor(dynamic_typing=True)).value)
tried(lambda: n.set_parameters([Parameter("any", value="text")])[0].successful)
"""
        out = [
            "4",
            "The parameter value for count is not a valid step. Min: 0, max: 10, value: 5, step: 2",
            "Parameter count out of range. Min: 0, Max: 10, value: 12",
            "InvalidParameterValueException: ('Invalid parameter value (2.0) for parameter. Reason: Parameter ratio "
            "out of range Min: 0.0, Max: 1.0, value: 2.0', 'ratio')",
            "InvalidParameterValueException: ('Invalid parameter value (0.3) for parameter. Reason: The parameter "
            "value for ratio is not close enough to a valid step. Min: 0.0, max: 1.0, value: 0.3, step: 0.25', "
            "'ratio')",
            "0.75",
            "x",
            "Trying to set a read-only parameter: fixed.",
            "ParameterImmutableException: ('Attempted to modify read-only parameter', 'fixed')",
            "rcl_interfaces.msg.ParameterDescriptor(name='count', type=2, description='x', "
            "additional_constraints='', read_only=False, dynamic_typing=False, floating_point_range=[], "
            "integer_range=[rcl_interfaces.msg.IntegerRange(from_value=0, to_value=10, step=2)])",
            "1",
            "True",
        ]
        self.assertEqual(self.said(text), out)

    def test_services_and_events(self):
        text = TRIED + """
from rcl_interfaces.srv import GetParameters, ListParameters, SetParameters
rclpy.init()
n = Node("n")
n.create_subscription(ParameterEvent, "/parameter_events", lambda e: print([p.name for p in e.new_parameters], e.node), 10)
n.declare_parameter("speed", 1.5)
asker = Node("asker")
from rclpy.executors import SingleThreadedExecutor
executor = SingleThreadedExecutor()
executor.add_node(n)
executor.add_node(asker)

def ask(kind, name, request):
    future = asker.create_client(kind, name).call_async(request)
    executor.spin_until_future_complete(future)
    return future.result()

print(ask(GetParameters, "n/get_parameters", GetParameters.Request(names=["speed"])).values[0].double_value)
new = Parameter("speed", value=2.0).to_parameter_msg()
print(ask(SetParameters, "n/set_parameters", SetParameters.Request(parameters=[new])))
print(ask(ListParameters, "n/list_parameters", ListParameters.Request()).result.names, n.get_parameter("speed").value)
print(ask(GetParameters, "n/get_parameters", GetParameters.Request(names=["other"])).values)
"""
        out = [
            "['speed'] /n",
            "['use_sim_time'] /asker",
            "1.5",
            "[] /n",
            "rcl_interfaces.srv.SetParameters_Response(results=[rcl_interfaces.msg.SetParametersResult(successful=Tru"
            "e, reason='')])",
            "['use_sim_time', 'speed'] 2.0",
            "[]",
        ]
        self.assertEqual(self.said(text), out)


class Clients(Ros2Case):
    def test_of_another_node(self):
        text = TRIED + """
import os, tempfile
from rclpy.parameter_client import AsyncParameterClient
rclpy.init()
asker, node = Node("asker", namespace="ns"), Node("node", namespace="ns")
node.declare_parameter("speed", 1.0)
node.declare_parameter("name", "arm", ParameterDescriptor(description="of the arm"))
node.declare_parameter("gains.p", 2)
client = AsyncParameterClient(asker, "node")
nobody = AsyncParameterClient(asker, "/nobody")
print(client.services_are_ready(), client.wait_for_services(1.0), nobody.services_are_ready())
print(nobody.wait_for_services(timeout_sec=1.0), asker.get_clock().now().nanoseconds % 10**11)
executor = rclpy.executors.SingleThreadedExecutor()
executor.add_node(node)
executor.add_node(asker)
def done(future):
    executor.spin_until_future_complete(future)
    return future.result()
print([value.double_value or value.string_value for value in done(client.get_parameters(["speed", "name"])).values])
print(list(done(client.get_parameter_types(["speed", "name"])).types))
print([each.description for each in done(client.describe_parameters(["name"])).descriptors])
print(done(client.list_parameters(["gains"])).result.names, done(client.list_parameters(depth=1)).result.names)
news = [Parameter("speed", value=3.0), Parameter("name", value="leg").to_parameter_msg(), Parameter("no", value=1)]
print([(each.successful, each.reason) for each in done(client.set_parameters(news)).results])
print(done(client.set_parameters_atomically(news)).result.successful, node.get_parameter("speed").value)
heard = []
done(client.set_parameters([Parameter("speed", value=4.0)], callback=heard.append))
while not heard:
    executor.spin_once(timeout_sec=0.1)
print(node.get_parameter("speed").value, [future.done() for future in heard])
text = "/**: {ros__parameters: {speed: 5.0}}\\nnode:\\n  ros__parameters:\\n    gains: {p: 6}\\n"
path = os.path.join(tempfile.mkdtemp(), "load.yaml")
with open(path, "w") as file:
    file.write(text)
done(client.load_parameter_file(path))
print(node.get_parameter("speed").value, node.get_parameter("gains.p").value)
done(client.load_parameter_file_atomically(path, use_wildcard=True))
print(node.get_parameter("speed").value)
tried(lambda: nobody.load_parameter_file(path))
print([each.successful for each in done(client.delete_parameters(["name"])).results])
os.remove(path)
"""
        out = [
            "True True False",
            "False 1000000000",
            "[1.0, 'arm']",
            "[3, 4]",
            "['of the arm']",
            "['gains.p'] ['use_sim_time', 'speed', 'name']",
            "[(True, ''), (True, ''), (False, \"('Invalid access to undeclared parameter(s)', ['no'])\")]",
            "False 3.0",
            "4.0 [True]",
            "4.0 6",
            "5.0",
            "RuntimeError: Param file does not contain parameters for /nobody,only for nodes: ['/**', 'node'] ",
            "[False]",
        ]
        self.assertEqual(self.said(text), out)


class Arguments(Ros2Case):
    def test_all_of_them(self):
        text = TRIED + """
import os
path = os.path.join(os.path.dirname(__file__), "parameters.yaml")
with open(path, "w") as file:
    file.write('''/**:
  ros__parameters:
    rate: 5   # for all
/ns/zed:
  ros__parameters:
    gains: {p: 1.5, i: 0.1}
    names: ["a", 'b']
    flag: yes
    grid:
      - 1.0
      - 2.0
other:
  ros__parameters:
    rate: 7
''')
sys.argv += ["--params-file", path, "--", "tail"]
rclpy.init()
print(sys.argv[1], rclpy.utilities.remove_ros_args()[1:])
n = Node("n")
print(n.get_fully_qualified_name(), n.get_logger().name)
for p, v in (("rate", 1), ("gains.p", 1.0), ("names", ["x"]), ("flag", False), ("cmd", "x"), ("grid", [0.0])):
    print(n.declare_parameter(p, v).value, end=" ")
print()
tried(lambda: n.declare_parameter("bad", 3))
for t in ("a", "/a", "~/a", "b", "x/y", "{node}/q"):
    print(t, n.resolve_topic_name(t), n.resolve_topic_name(t, only_expand=True))
print(n.resolve_service_name("s"), n.resolve_topic_name("s"))
o = Node("other", use_global_arguments=False, cli_args=["-r", "a:=zz", "-p", "rate:=9"])
print(o.get_fully_qualified_name(), o.declare_parameter("rate", 1).value, o.resolve_topic_name("a"))
n.get_logger().debug("told")
rclpy.logging.get_logger("quiet.child").warn("not told")
rclpy.logging.get_logger("quiet").error("told")
"""
        args = (
            "pos --ros-args -r __node:=zed -r __ns:=/ns -r a:=b -r other:a:=c -r rosservice://s:=/serv -p bad:=text "
            "-p cmd:='1' --log-level debug --log-level quiet:=error"
        ).split()
        err = [
            "[DEBUG] [1735689600.000000000] [ns.zed]: told",
            "[ERROR] [1735689600.000000000] [quiet]: told",
        ]
        out = [
            "pos ['pos', 'tail']",
            "/ns/zed ns.zed",
            "5 1.5 ['a', 'b'] True 1 [1.0, 2.0] ",
            "InvalidParameterTypeException: Trying to set parameter 'bad' to 'text' of type 'STRING', expecting type "
            "'INTEGER'",
            "a /ns/b /ns/a",
            "/a /a /a",
            "~/a /ns/zed/a /ns/zed/a",
            "b /ns/b /ns/b",
            "x/y /ns/x/y /ns/x/y",
            "{node}/q /ns/zed/q /ns/zed/q",
            "/serv /ns/s",
            "/other 9 /zz",
        ]
        self.assertEqual(self.said(text, args=args, err="\n".join(err) + "\n"), out)

    def test_what_cannot_be_read(self):
        text = TRIED + """
from rclpy import _yaml
for words in ("-r foo", "-r a:=", "--foo", "-p", "-p a:=[1,b]", "--params-file /nowhere", "--log-level loud"):
    tried(lambda: rclpy.init(args=["--ros-args", *words.split()], context=rclpy.Context()))
for text in ("a: 1\\n\\tb: 2", "a: &x 1", "a: |\\n  b", "a: [1, 2", "a:", "a: 'b", "a: 1\\n   b: 2", "- a: 1", "a: " + "[" * 200):
    tried(lambda: _yaml.parse(text))
text = "a: {b: 0x10, c: [1, 2], 'd e': \\"x\\\\n\\"} # c\\n"
print(_yaml.parse(text + "f: -.inf\\ng: 'it''s # no'\\nh: 1e3\\ni: http://x:1\\nj: 010\\nk: 1_000\\nl: -5"))
rclpy.init(args=["x:=y"])
print(Node("n").resolve_topic_name("x"))
"""
        err = [
            "[WARN] [1735689600.000000000] [rcl]: Found remap rule 'x:=y'. This syntax is deprecated. Use "
            "'--ros-args --remap x:=y' instead.",
        ]
        out = [
            "RCLInvalidROSArgsError: Failed to parse ROS arguments: Couldn't parse remap rule: '-r foo'. Error: a "
            "remap rule is FROM:=TO",
            "RCLInvalidROSArgsError: Failed to parse ROS arguments: Couldn't parse remap rule: '-r a:='. Error: a "
            "remap rule is FROM:=TO",
            "UnknownROSArgsError: ['--foo']",
            "RCLInvalidROSArgsError: Failed to parse ROS arguments: Couldn't parse trailing -p flag. No parameter "
            "override rule found.",
            "RCLInvalidROSArgsError: Failed to parse ROS arguments: Couldn't parse parameter override rule: '-p "
            "a:=[1,b]'. Error: Sequence should be of same type: parameter a",
            "RCLInvalidROSArgsError: Failed to parse ROS arguments: Couldn't parse params file: '--params-file "
            "/nowhere'. Error: [Errno 2] No such file or directory: '/nowhere'",
            "RCLInvalidROSArgsError: Failed to parse ROS arguments: Couldn't parse log level: '--log-level loud'. "
            "Error: a level is debug, info, warn, error or fatal",
            "YamlError: a tab cannot indent at line 2",
            "YamlError: anchors and tags are not supported at line 1",
            "YamlError: texts of several lines are not supported; write them between quotes, at line 1",
            "YamlError: a bracket is never closed at line 1",
            "YamlError: No value at line 1",
            "YamlError: a quote is never closed at line 1",
            "YamlError: this line is indented otherwise than those before at line 2",
            "YamlError: a list of parameters holds values, and no mappings, at line 1",
            "YamlError: a bracket is never closed at line 1",
            "{'a': {'b': 16, 'c': [1, 2], 'd e': 'x\\n'}, 'f': -inf, 'g': \"it's # no\", 'h': 1000.0, 'i': "
            "'http://x:1', 'j': 8, 'k': '1_000', 'l': -5}",
            "/y",
        ]
        self.assertEqual(self.said(text, err="\n".join(err) + "\n"), out)


if __name__ == "__main__":
    unittest.main()
