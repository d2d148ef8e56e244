// Values that come back: of goals, of beliefs that are removed, of rules; and strings of actions.
price(bread, 4).
price(milk, 7).
largest(X, Y, X) :- X >= Y.
largest(X, Y, Y) :- X < Y.

!shop.

+!shop
   <- !total([bread, milk], Sum);
      .print(Sum);
      !cost(cake, C);
      .print(C);
      !either(C, _);
      ?largest(Sum, C, Most);
      say("the most");
      ?word(W);
      say(W);
      .concat("it is ", Most, Text);
      say(Text);
      -price(Thing, 7);
      .print(Thing);
      !early(Early);
      !late(Late);
      .print("over").
-!shop <- .print("not bought").

+?word("a word").
+!total([], 0).
+!total([T | Rest], Sum) <- !cost(T, C); !total(Rest, S); Sum = C + S.
+!cost(T, C) : price(T, C).
-!cost(_, C) <- C = 0.
+!either(X, X).
+!early(N) <- -+count(N).
+!late(N) <- .print("late").
