# Forks two hundred processes, each from the one before.
# expect: any
# needs: namespaces
import os
import posix
import hrdsl
node = hrdsl.Node('robot')
for _ in range(200):
    if posix.fork():
        break
else:
    os._exit(0)
os.execvp('sleep', ['sleep', '1000'])
