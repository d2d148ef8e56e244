/* Lists, lists of structures, recursion. */
path([a, b, c]).
grid([[1, 2], [3]]).
sum([], 0).
sum([H | T], S) :- sum(T, R) & S = H + R.
last([X], X).
last([_ | T], X) :- last(T, X).
edge(a, b). edge(b, c).
reach(X, Y) :- edge(X, Y).
reach(X, Y) :- edge(X, Z) & reach(Z, Y).
big(X, Y) :- X > Y.
!run.
+!run : path(P) & grid(G)
   <- .findall(pair(X, Y), edge(X, Y), Pairs);
      .length(Pairs, N);
      for (.member(pair(A, B), Pairs)) { .print(A, " to ", B) };
      .nth(0, Pairs, pair(First, _));
      .concat(Pairs, Pairs, Twice);
      !walk(Twice, First);
      .sort([3, 1, 2], Sorted);
      .union(Sorted, [4], U); .intersection(U, [1], I); .difference(U, I, D);
      .delete(b, P, Without);
      .delete(0, P, Rest);
      .delete("a", "banana", Fewer);
      .shuffle(D, Mixed); .random(Mixed, One); .all_names(Names);
      ?reach(a, To);
      ?big(One, 2);
      ?big(Other, 2);
      ?sum(Sorted, Total);
      .term2string(Total, Text);
      if (.sublist([1], Sorted) & .prefix([1], Sorted) | .empty(Without)) { .print(Text) }.
+!walk([], _).
+!walk([pair(X, Y) | T], Last) : big(1, 0) <- !walk(T, Y).
