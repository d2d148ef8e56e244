all_proposals_received(CNPId, NP) :-
    .count(propose(CNPId, _)[source(_)], NO) &
    .count(refuse(CNPId)[source(_)], NR) &
    NP = NO + NR.

!cnp(1, fix(computer)).

+!cnp(Id, Task)
   <- !call(Id, Task, LP);
      .print("no one").

+!cnp(Id, Task)
   <- .print("Waiting for participants for task ", Task);
      .wait(2000);
      +cnp_state(Id, propose);
      .findall(Name, introduction(participant, Name), LP);
      .print("Sending CFP to ", LP);
      .send(LP, tell, cfp(Id, Task));
      .length(LP, N);
      .wait(all_proposals_received(Id, N), 4000, _);
      .findall(offer(O, A), propose(Id, O)[source(A)], L);
      .print("Offers are ", L);
      L \== [];
      .min(L, offer(WOf, WAg));
      .print("Winner is ", WAg, " with ", WOf);
      !result(Id, L, WAg);
      -+cnp_state(Id, finished).

// several could be contracted
+!result(_, [], _).
+!result(CNPId, [offer(_, WAg) | T], WAg)
   <- .send(WAg, tell, accept_proposal(CNPId));
      !result(CNPId, T, WAg).
+!result(CNPId, [offer(_, LAg) | T], WAg)
   <- .send(LAg, tell, reject_proposal(CNPId));
      !result(CNPId, T, WAg).
