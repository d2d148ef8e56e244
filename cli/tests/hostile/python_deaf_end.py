# Swallows the news that the test is over, for ever.
# expect: any
import hrdsl
node = hrdsl.Node('robot')
node.wait_for('asked')
node.emit('said', n=1)
while True:
    try:
        node.sleep(1)
    except BaseException:
        pass
