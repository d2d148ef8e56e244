last_order_id(1). // initial belief

// plan to achieve the goal "order" for agent Ag
+!order(Product, Qtd)[source(Ag)] : open(true)
   <- ?last_order_id(N);
      OrderId = N + 1;
      -+last_order_id(OrderId);
      deliver(Product, Qtd);
      .send(Ag, tell, delivered(Product, Qtd, OrderId)).

+!advertise <- .broadcast(tell, offer(beer, 1.5)).
