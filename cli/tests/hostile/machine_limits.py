# Raises its limits as far as it may, then wants memory.
# expect: error "MemoryError"
import resource
import hrdsl
node = hrdsl.Node('robot')
for name in ['RLIMIT_DATA', 'RLIMIT_STACK', 'RLIMIT_CORE']:
    try:
        resource.setrlimit(getattr(resource, name), (resource.RLIM_INFINITY,) * 2)
    except (OSError, ValueError):
        pass
bytearray(1 << 30)
