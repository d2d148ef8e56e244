import hrdsl

hrdsl.Node("hello")
