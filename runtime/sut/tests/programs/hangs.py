import hrdsl

node = hrdsl.Node("hangs")
print("thinking")
while True:
    pass
