//! Disjoint sets of indices, merged (Tarjan 1975, with path halving).

/// Each set is known by its smallest index, so that results do not depend on the order of merging.
#[derive(Debug, Clone, Default)]
pub struct Roots(Vec<u32>);

impl Roots {
    /// Each index in a set of its own.
    pub fn new(count: usize) -> Self {
        Self((0..count as u32).collect())
    }

    /// One more index, in a set of its own.
    pub fn add(&mut self) -> u32 {
        self.0.push(self.0.len() as u32);
        self.0.len() as u32 - 1
    }

    /// The smallest index of the set.
    pub fn root(&mut self, mut i: u32) -> u32 {
        while self.0[i as usize] != i {
            let above = self.0[self.0[i as usize] as usize];
            self.0[i as usize] = above;
            i = above;
        }
        i
    }

    /// Merges two sets; false if they are one already.
    pub fn join(&mut self, a: u32, b: u32) -> bool {
        let (a, b) = (self.root(a), self.root(b));
        self.0[a.max(b) as usize] = a.min(b);
        a != b
    }

    /// The root of each index.
    pub fn into_roots(mut self) -> Vec<u32> {
        (0..self.0.len() as u32).map(|i| self.root(i)).collect()
    }
}
