# Waits for select, where no simulated time passes.
# expect: error "it slept for 1 s of wall time"
import select
import hrdsl
node = hrdsl.Node('robot')
select.select([], [], [], 1000)
