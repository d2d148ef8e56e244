# Closes the descriptors of the protocol and sleeps.
# expect: error "it slept for 1 s of wall time"
import os, select
import hrdsl
node = hrdsl.Node('robot')
os.closerange(3, 50)
select.select([], [], [], 1000)
