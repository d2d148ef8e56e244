# Asks for the first place among all processes, and computes.
# expect: error "as it should be"
# needs: namespaces
import os
import hrdsl
node = hrdsl.Node('robot')
try:
    os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(1))
    raise SystemExit('it is before all others')
except OSError:
    pass
raise SystemExit('as it should be')
