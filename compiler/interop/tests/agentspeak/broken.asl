b(1)
c(2).
+!g <- a b.
+!h : x & <- c.
d("open).
!ok.
