/* Mutual exclusion */
A[] forall (i : id_t) forall (j : id_t) P(i).cs && P(j).cs imply i == j

// No deadlock
A[] not deadlock

E<> P(4).cs
P(1).req --> P(1).wait
P(1).wait --> P(1).cs
E<> P(1).wait and P(2).wait and turn == 1
E<> P(1).cs and turn == 2
E<> P(1).wait and P(1).x > 5 and turn == 1
E<> P(1).req and P(1).x > 2
inf{P(1).cs}: P(1).x
E<> P(1).cs and P(1).x <= 2
E<> P(1).cs and (exists (i : id_t) i != 1 and P(i).req)
E<> P(1).cs and (exists (i : id_t) i != 1 and P(i).req and turn == i)
A[] (sum (i : id_t) P(i).cs) <= 1
A[] turn == 0 or (exists (i : id_t) turn == i and not P(i).A and not P(i).req)
