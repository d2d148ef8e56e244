import hrdsl

node = hrdsl.Node("asker")
while True:
    node.now()
