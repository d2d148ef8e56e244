import hrdsl

node = hrdsl.Node("refused")
try:
    node.emit("leg_reqest")
except hrdsl.ProtocolError as error:
    print("error:", error.message, "| help:", error.help)
for wrong in (lambda: node.sleep(-1), lambda: node.emit("x", n=float("nan")), lambda: node.arm("a").move_to((1, 2))):
    try:
        wrong()
    except ValueError as error:
        print("value error:", error)
link = node._link
for message in ({"request": "fly"}, {"request": "sleep", "seconds": "long"}, {"request": "hello", "version": 9, "name": ""}):
    try:
        link.request(message)
    except hrdsl.ProtocolError as error:
        print("refused:", error.message)
node.read("nothing")
