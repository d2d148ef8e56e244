!ball(20000).

// Messages a second. The two agents send a number to and fro until it is 0.
+!ball(N) : N > 0 <- .send(pong, achieve, ball(N - 1)).
+!ball(_) <- .print(done).
