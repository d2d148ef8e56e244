# Waits for a reader of a pipe that has none, where no simulated time passes.
# expect: error "it slept for 1 s of wall time"
import os
import hrdsl
node = hrdsl.Node('robot')
os.mkfifo('pipe')
open('pipe', 'w')
