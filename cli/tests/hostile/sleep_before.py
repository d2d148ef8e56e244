# Sleeps before it has greeted.
# expect: error "it never spoke to the harness"
import select
select.select([], [], [], 1000)
