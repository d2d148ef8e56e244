# Lets children compute while it waits for them.
# expect: error "within 1 s of processor time"
import os
import posix
import hrdsl
node = hrdsl.Node('robot')
for _ in range(4):
    if posix.fork() == 0:
        while True:
            pass
os.wait()
