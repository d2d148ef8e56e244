//! The waiting states of a search, and which are taken first.

use std::{
    cmp::Reverse,
    collections::{BinaryHeap, VecDeque},
};

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::{
    network::model::CompiledNetwork,
    search::{options::SearchOrder, store::NodeSet},
};

/// Waiting states.
pub(crate) struct WaitingList {
    order: SearchOrder,
    /// Instead of that order: by arrival, then by place in the topological order, then the older.
    by_time: Option<BinaryHeap<Reverse<(i64, u32, u32)>>>,
    queue: VecDeque<u32>,
    /// Of a rank: that, then the earlier in the topological order, then the newer: the greatest goes first.
    heap: BinaryHeap<(u32, Reverse<u32>, u32)>,
    /// Without a rank, by place in the topological order.
    levels: Vec<Vec<u32>>,
    /// All levels below this are empty.
    lowest: usize,
    /// How many are in `levels`.
    level_count: usize,
    /// The greatest rank given so far.
    rank: u32,
    /// Nodes that were taken, if the order wants to know.
    taken: NodeSet,
    /// What the round has brought, in order.
    fresh: Vec<u32>,
    rng: ChaCha8Rng,
    /// A state that was taken already was driven out.
    overtaken: bool,
}

impl WaitingList {
    pub(crate) fn new(order: SearchOrder, seed: u64) -> Self {
        Self {
            order,
            by_time: None,
            queue: VecDeque::new(),
            heap: BinaryHeap::new(),
            levels: Vec::new(),
            lowest: 0,
            level_count: 0,
            rank: 0,
            taken: NodeSet::default(),
            fresh: Vec::new(),
            rng: ChaCha8Rng::seed_from_u64(seed),
            overtaken: false,
        }
    }

    /// What arrives first is next.
    pub(crate) fn by_time() -> Self {
        Self { by_time: Some(BinaryHeap::new()), ..Self::new(SearchOrder::Breadth, 0) }
    }

    pub(crate) fn len(&self) -> usize {
        self.by_time.as_ref().map_or(0, BinaryHeap::len)
            + self.queue.len()
            + self.heap.len()
            + self.level_count
            + self.fresh.len()
    }

    pub(crate) fn bytes(&self) -> usize {
        self.by_time.as_ref().map_or(0, |heap| heap.capacity() * 16)
            + (self.queue.capacity() + self.level_count) * 4
            + self.heap.capacity() * 12
            + self.taken.bytes()
    }

    /// Whether nothing waits; states that were driven out are forgotten, and so are those that arrive later than `latest`.
    pub(crate) fn is_empty(&mut self, covered: &NodeSet, latest: Option<i64>) -> bool {
        let gone = |n: u32| covered.has(n);
        if let Some(heap) = &mut self.by_time {
            let late = |arrival: i64| latest.is_some_and(|l| arrival > l);
            while heap.peek().is_some_and(|Reverse((arrival, _, n))| late(*arrival) || gone(*n)) {
                heap.pop();
            }
            return heap.is_empty();
        }
        match self.order {
            SearchOrder::Breadth | SearchOrder::RandomBreadth => {
                while self.queue.front().is_some_and(|n| gone(*n)) {
                    self.queue.pop_front();
                }
            }
            SearchOrder::Depth | SearchOrder::RandomDepth => {
                while self.queue.back().is_some_and(|n| gone(*n)) {
                    self.queue.pop_back();
                }
            }
            SearchOrder::Topological => {
                while self.heap.peek().is_some_and(|n| gone(n.2)) {
                    self.heap.pop();
                }
                if self.heap.is_empty() {
                    while let Some(node) = self.lowest_level() {
                        if !gone(node) {
                            self.put(node);
                            break;
                        }
                    }
                }
            }
        }
        self.queue.is_empty() && self.heap.is_empty() && self.level_count == 0
    }

    /// The newest of the first level that has any.
    fn lowest_level(&mut self) -> Option<u32> {
        while let Some(level) = self.levels.get_mut(self.lowest) {
            if let Some(node) = level.pop() {
                self.level_count -= 1;
                return Some(node);
            }
            self.lowest += 1;
        }
        None
    }

    /// Gives back what [`lowest_level`](Self::lowest_level) took.
    fn put(&mut self, node: u32) {
        if let Some(level) = self.levels.get_mut(self.lowest) {
            level.push(node);
            self.level_count += 1;
        }
    }

    fn wait_at(&mut self, node: u32, level: usize) {
        if self.levels.len() <= level {
            self.levels.resize_with(level + 1, Vec::new);
        }
        self.levels[level].push(node);
        self.level_count += 1;
        self.lowest = self.lowest.min(level);
    }

    /// A state waits. `covers`: it drove out others.
    pub(crate) fn push(&mut self, node: u32, covers: bool, level: u32, arrival: i64) {
        if let Some(heap) = &mut self.by_time {
            heap.push(Reverse((arrival, level, node)));
            return;
        }
        match self.order {
            SearchOrder::Breadth => self.queue.push_back(node),
            SearchOrder::RandomBreadth | SearchOrder::Depth | SearchOrder::RandomDepth => {
                self.fresh.push(node)
            }
            SearchOrder::Topological => {
                let ahead = covers && std::mem::take(&mut self.overtaken);
                if ahead {
                    self.rank += 1;
                    self.heap.push((self.rank, Reverse(level), node));
                } else {
                    self.wait_at(node, level as usize);
                }
            }
        }
    }

    /// A state is driven out.
    pub(crate) fn covered(&mut self, node: u32) {
        if self.order == SearchOrder::Topological {
            self.overtaken |= self.taken.has(node);
        }
    }

    /// A round is stored.
    pub(crate) fn settle(&mut self) {
        self.overtaken = false;
        match self.order {
            SearchOrder::Breadth | SearchOrder::Topological => {}
            SearchOrder::Depth => self.queue.extend(self.fresh.drain(..).rev()),
            SearchOrder::RandomBreadth | SearchOrder::RandomDepth => {
                let fresh = &mut self.fresh;
                for i in (1..fresh.len()).rev() {
                    fresh.swap(i, self.rng.random_range(0..=i));
                }
                self.queue.extend(fresh.drain(..));
            }
        }
    }

    /// Gives back states that were taken from the front, breadth first.
    pub(crate) fn give_back(&mut self, nodes: &[u32]) {
        nodes.iter().rev().for_each(|&n| self.queue.push_front(n));
    }

    /// Takes up to `most` states; orders other than breadth first take a part of those that wait, so that the newest still
    /// come first where few wait.
    pub(crate) fn take(&mut self, covered: &NodeSet, most: usize, out: &mut Vec<u32>) {
        out.clear();
        if self.by_time.is_some() {
            return self.take_earliest(covered, most.min(FEW), out);
        }
        let most = match self.order {
            SearchOrder::Breadth | SearchOrder::RandomBreadth => most,
            SearchOrder::Depth | SearchOrder::RandomDepth => (self.len() / 8).clamp(1, most / 4),
            // Few more are expanded so than one by one, and they are enough for several threads.
            SearchOrder::Topological => (self.len() / 8).max(FEW).min(most / 4),
        };
        while out.len() < most {
            let next = match self.order {
                SearchOrder::Breadth | SearchOrder::RandomBreadth => self.queue.pop_front(),
                SearchOrder::Depth | SearchOrder::RandomDepth => self.queue.pop_back(),
                SearchOrder::Topological => self.heap.pop().map(|n| n.2).or_else(|| self.lowest_level()),
            };
            let Some(node) = next else { return };
            if covered.has(node) {
                continue;
            }
            if self.order == SearchOrder::Topological {
                self.taken.add(node);
            }
            out.push(node);
        }
    }
}

/// States of a round by time: of all that arrive at once the first may do, or lead to what covers the others. Of a round by topological
/// order the least.
const FEW: usize = 64;

impl WaitingList {
    /// Up to `most` states that arrive at the same time.
    fn take_earliest(&mut self, covered: &NodeSet, most: usize, out: &mut Vec<u32>) {
        let Some(heap) = &mut self.by_time else { return };
        let mut first = None;
        while out.len() < most
            && let Some(&Reverse((arrival, _, node))) = heap.peek()
            && *first.get_or_insert(arrival) == arrival
        {
            heap.pop();
            if !covered.has(node) {
                out.push(node);
            } else if out.is_empty() {
                first = None;
            }
        }
    }
}

/// By member and location: its place in a topological order of the edges that do not lead back.
pub(crate) fn levels(model: &CompiledNetwork) -> Vec<Vec<u32>> {
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

/// Of a state: the sum over its locations, after those with better counters.
pub(crate) fn level(levels: &[Vec<u32>], state: &[i64], ranks: &[u32]) -> u32 {
    let place: u32 = levels.iter().zip(state).map(|(by_location, &at)| by_location[at as usize]).sum();
    if ranks.is_empty() {
        return place;
    }
    // What a better counter leads to covers the rest, so that it is expanded once. The place in the order decides among the like.
    let total = ranks.iter().fold(0u32, |sum, r| sum.saturating_add(*r));
    if total < PRECISE { total * PLACES + place.min(PLACES - 1) } else { PRECISE * PLACES + total.ilog2() }
}

/// Up to this sum of ranks each has its own levels, so many for places.
const PRECISE: u32 = 1 << 14;
const PLACES: u32 = 16;
