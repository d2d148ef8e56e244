//! The waiting states of a search, and which are taken first.

use std::{
    cmp::Reverse,
    collections::{BinaryHeap, VecDeque},
};

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::{Model, Order, store::Node};

/// Waiting states.
pub(crate) struct Waiting {
    order: Order,
    queue: VecDeque<u32>,
    /// Rank, then the earlier in the topological order, then the newer: the greatest goes first.
    heap: BinaryHeap<(u32, Reverse<u32>, u32)>,
    /// The greatest rank given so far.
    rank: u32,
    /// Nodes that were taken, as bits, if the order wants to know.
    taken: Vec<u64>,
    /// What the round has brought, in order.
    fresh: Vec<u32>,
    rng: ChaCha8Rng,
    /// A state that was taken already was driven out.
    overtaken: bool,
}

impl Waiting {
    pub(crate) fn new(_: &Model, order: Order, seed: u64) -> Self {
        Self {
            order,
            queue: VecDeque::new(),
            heap: BinaryHeap::new(),
            rank: 0,
            taken: Vec::new(),
            fresh: Vec::new(),
            rng: ChaCha8Rng::seed_from_u64(seed),
            overtaken: false,
        }
    }

    pub(crate) fn len(&self) -> usize {
        self.queue.len() + self.heap.len() + self.fresh.len()
    }

    pub(crate) fn bytes(&self) -> usize {
        self.queue.capacity() * 4 + self.heap.capacity() * 12 + self.taken.len() * 8
    }

    /// Whether nothing waits; states that were driven out are forgotten.
    pub(crate) fn is_empty(&mut self, nodes: &[Node]) -> bool {
        let gone = |n: u32| nodes[n as usize].covered;
        match self.order {
            Order::Breadth => {
                while self.queue.front().is_some_and(|n| gone(*n)) {
                    self.queue.pop_front();
                }
            }
            Order::Depth | Order::RandomDepth => {
                while self.queue.back().is_some_and(|n| gone(*n)) {
                    self.queue.pop_back();
                }
            }
            Order::Topological => {
                while self.heap.peek().is_some_and(|n| gone(n.2)) {
                    self.heap.pop();
                }
            }
        }
        self.queue.is_empty() && self.heap.is_empty()
    }

    /// A state waits. `covers`: it drove out others.
    pub(crate) fn push(&mut self, node: u32, covers: bool, level: u32) {
        match self.order {
            Order::Breadth => self.queue.push_back(node),
            Order::Depth | Order::RandomDepth => self.fresh.push(node),
            Order::Topological => {
                let ahead = covers && std::mem::take(&mut self.overtaken);
                if ahead {
                    self.rank += 1;
                }
                let rank = if ahead { self.rank } else { 0 };
                self.heap.push((rank, Reverse(level), node));
            }
        }
    }

    /// A state is driven out.
    pub(crate) fn covered(&mut self, node: u32) {
        if self.order == Order::Topological {
            let (word, bit) = (node as usize / 64, node % 64);
            self.overtaken |= self.taken.get(word).is_some_and(|w| w >> bit & 1 == 1);
        }
    }

    /// A round is stored.
    pub(crate) fn settle(&mut self, _: &[Node]) {
        self.overtaken = false;
        match self.order {
            Order::Breadth | Order::Topological => {}
            Order::Depth => self.queue.extend(self.fresh.drain(..).rev()),
            Order::RandomDepth => {
                let fresh = &mut self.fresh;
                for i in (1..fresh.len()).rev() {
                    fresh.swap(i, self.rng.random_range(0..=i));
                }
                self.queue.extend(fresh.drain(..));
            }
        }
    }

    /// Takes up to `most` states; orders other than breadth first take a part of those that wait, so that the newest still
    /// come first where few wait.
    pub(crate) fn take(&mut self, nodes: &[Node], most: usize, out: &mut Vec<u32>) {
        out.clear();
        let most = match self.order {
            Order::Breadth => most,
            Order::Depth | Order::RandomDepth | Order::Topological => (self.len() / 8).clamp(1, most / 4),
        };
        while out.len() < most {
            let next = match self.order {
                Order::Breadth => self.queue.pop_front(),
                Order::Depth | Order::RandomDepth => self.queue.pop_back(),
                Order::Topological => self.heap.pop().map(|n| n.2),
            };
            let Some(node) = next else { return };
            if nodes[node as usize].covered {
                continue;
            }
            if self.order == Order::Topological {
                let word = node as usize / 64;
                if self.taken.len() <= word {
                    self.taken.resize(word + 1, 0);
                }
                self.taken[word] |= 1 << (node % 64);
            }
            out.push(node);
        }
    }
}

/// By member and location: its place in a topological order of the edges that do not lead back.
pub(crate) fn levels(model: &Model) -> Vec<Vec<u32>> {
    model
        .members
        .iter()
        .map(|m| {
            let count = m.locations.len();
            let targets: Vec<Vec<usize>> = (0..count)
                .map(|l| m.edges.iter().filter(|e| e.from() == l).map(|e| e.to()).collect())
                .collect();
            let mut level = vec![0; count];
            let mut seen = vec![false; count];
            let mut left = count as u32;
            let start = usize::from(m.automaton.initial.0);
            // Depth first; a location is numbered, from the greatest down, when all it leads to is.
            let mut stack = vec![(start, 0)];
            seen[start] = true;
            while let Some((l, next)) = stack.pop() {
                match targets[l].get(next) {
                    Some(&to) => {
                        stack.push((l, next + 1));
                        if !seen[to] {
                            seen[to] = true;
                            stack.push((to, 0));
                        }
                    }
                    None => {
                        left -= 1;
                        level[l] = left;
                    }
                }
            }
            level
        })
        .collect()
}

/// Of a state: the sum over its locations.
pub(crate) fn level(levels: &[Vec<u32>], state: &[i64]) -> u32 {
    levels.iter().zip(state).map(|(by_location, &at)| by_location[at as usize]).sum()
}
