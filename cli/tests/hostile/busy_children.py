# Lets children compute while it waits for them.
# expect: error "within 1 s of processor time"
import os
import hrdsl
node = hrdsl.Node('robot')
for _ in range(4):
    if os.fork() == 0:
        while True:
            pass
os.wait()
