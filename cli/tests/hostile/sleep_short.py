# Waits for many short sleeps inside C code, where no simulated time passes.
# expect: error "it slept for 1 s of wall time"
import select
import hrdsl
node = hrdsl.Node('robot')
while True:
    select.select([], [], [], 0.05)
