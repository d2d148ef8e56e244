# Waits for a child that sleeps, where no simulated time passes.
# expect: error "it slept for 1 s of wall time"
import subprocess
import hrdsl
node = hrdsl.Node('robot')
subprocess.run(['sleep', '1000'])
