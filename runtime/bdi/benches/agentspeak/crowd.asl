!count(1000).

// The program of `counter.asl` for each of many agents.
+!count(N) : N > 0 <- !count(N - 1).
+!count(_) <- .print(done).
