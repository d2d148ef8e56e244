/* Initial beliefs and rules */

// at first I believe that there is some beer in the fridge
available(beer, fridge).
// how much the owner may drink
limit(beer, 10).

too_much(B) :-
   .count(consumed(_, B), QtdB) &
   limit(B, Limit) &
   QtdB > Limit.

/* Plans */

+!has(owner, beer)
   :  available(beer, fridge) & not too_much(beer)
   <- !at(robot, fridge);
      open(fridge);
      get(beer);
      close(fridge);
      !at(robot, owner);
      hand_in(beer);
      ?has(owner, beer);
      // remember that another beer has been consumed
      ?serial(N);
      -+serial(N + 1);
      +consumed(N, beer).

+!has(owner, beer)
   :  not available(beer, fridge)
   <- .send(supermarket, achieve, order(beer, 5));
      !at(robot, fridge). // go there and wait for the delivery

+!has(owner, beer)
   :  too_much(beer) & limit(beer, L)
   <- .concat("The Department of Health does not allow me to give you more than ", L,
              " beers a day! I am very sorry about that!", M);
      .send(owner, tell, msg(M)).

-!has(_, _)
   :  true
   <- .current_intention(I);
      .print("Failed to achieve a goal. Current intention is: ", I).

+!at(robot, P) : at(robot, P) <- true.
+!at(robot, P) : not at(robot, P)
   <- move_towards(P);
      !at(robot, P).

serial(0).

// when the supermarket makes a delivery, try the "has" goal again
+delivered(beer, _Qtd, _OrderId)[source(supermarket)]
   :  true
   <- +available(beer, fridge);
      !has(owner, beer).

// when the fridge is opened, the beer stock is perceived
+stock(beer, 0)
   :  available(beer, fridge)
   <- -available(beer, fridge).
+stock(beer, N)
   :  N > 0 & not available(beer, fridge)
   <- -+available(beer, fridge).

+?time(T) : true
   <- T = 12.
