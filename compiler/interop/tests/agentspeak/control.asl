// Blocks in blocks, and triggers of all sorts.
state(idle, 0).
on(true).
+!g(X) : on(true) & state(S, N) & N * 2 - 1 < (X + 3) * -2
   <- if (S == idle | not on(false)) { +busy } else { if (X > 1) { -busy } };
      if (busy) { Y = 1 } else { Y = 2 };
      use(Y);
      if (busy) { W = 1 };
      use(W);
      while (state(_, M) & M < 3) { -+state(idle, M + 1); if (M == 2) { !g(M) } }
      for (state(K, L) & L > 0) { !!g(L) }
      .fork(and, { .print(1) }, { .print(2) });
      .suspend;
      .drop_intention(g(_)); .drop_event(g(1)); .drop_all_events; .drop_all_desires.
-!g(_)[error(no_applicable), source(self)] <- .print("failed").
-state(S, N) : N >= 0 <- .print(S).
+on(B)[source(S)] : S == percept <- .print(B).
+?busy <- .fail(reason(1), because("x")).
!g(1).
