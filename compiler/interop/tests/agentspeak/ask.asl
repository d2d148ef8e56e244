// Questions, and what is done with the answers.
price(beer, 3). price(wine, 7).
size(4). size(5).
!shop.
+!shop
   <- .send(ask, askOne, price(beer, P), price(beer, P));
      .print(P);
      .send(ask, askOne, price(wine, _), Answer, 2000);
      Answer = price(What, Cost);
      +known(What, Cost);
      +Answer;
      .send(ask, askOne, size(_));
      .send(ask, askAll, size(_), Sizes);
      .max(Sizes, Largest);
      .print(Largest);
      .send(ask, askAll, price(_, _), All);
      .send([ask, ask], untell, known(_, _));
      .send("ask", achieve, sell(beer));
      .broadcast(untell, price(beer, _));
      .abolish(price(_, _)).
+!sell(G)[source(S)] : S \== self <- .print(S, " wants ", G).
+?size(S) : price(_, S) & S \= 2 <- .print(S).
-?size(_) <- .print("no size").
-price(beer, X)[source(_)] <- .print("gone ", X).
