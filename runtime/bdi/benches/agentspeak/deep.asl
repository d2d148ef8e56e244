!start(20000).

// Deep recursion. Each goal has a step left to do when the next one is adopted, so all of them wait at the same time.
+!start(N) <- !deep(N); .print(done).
+!deep(N) : N > 0 <- !deep(N - 1); !nothing.
+!deep(_).
+!nothing.
