//! Sums per cell, in parts that share no cell.

use super::key::Key;
use crate::{Contribution, parallel};

/// Vertices of a part, about: its table fits into a cache.
const PART: usize = 1 << 12;

/// Vertices in parts by the hash of their cells.
struct Parts {
    /// Vertices of the parts, one part after the other, ascending within.
    ids: Vec<u32>,
    starts: Vec<usize>,
    bits: u32,
}

impl Parts {
    fn new(keys: &[Option<Key>]) -> Self {
        let bits = (keys.len() / PART).max(1).ilog2().min(16);
        let parts = parallel::map(keys, |key| key.as_ref().map_or(u32::MAX, |key| part_of(key, bits)));
        let mut starts = vec![0_usize; (1 << bits) + 1];
        for &part in &parts {
            if part != u32::MAX {
                starts[part as usize + 1] += 1;
            }
        }
        for part in 1..starts.len() {
            starts[part] += starts[part - 1];
        }
        let mut ids = vec![0; starts[starts.len() - 1]];
        let mut next = starts.clone();
        for (id, &part) in (0_u32..).zip(&parts) {
            if part != u32::MAX {
                ids[next[part as usize]] = id;
                next[part as usize] += 1;
            }
        }
        Self { ids, starts, bits }
    }

    fn len(&self) -> usize {
        self.starts.len() - 1
    }

    fn ids(&self, part: usize) -> &[u32] {
        &self.ids[self.starts[part]..self.starts[part + 1]]
    }
}

#[inline(always)]
fn part_of(key: &Key, bits: u32) -> u32 {
    // The lower bits are for the table.
    if bits == 0 { 0 } else { (key.hash() >> (64 - bits)) as u32 }
}

/// A cell with the sum of what fell into it.
struct Cell<S> {
    key: Key,
    sum: S,
    count: u32,
}

/// The cells of a part.
struct Table<S> {
    /// Position in `cells`, plus one; a power of two of them, at least half of them zero.
    slots: Vec<u32>,
    cells: Vec<Cell<S>>,
}

impl<S> Table<S> {
    fn new(most: usize) -> Self {
        Self { slots: vec![0; (2 * most).next_power_of_two()], cells: Vec::new() }
    }

    /// The slot of a cell, or the one where it would be: linear probing.
    #[inline(always)]
    fn slot(&self, key: &Key) -> usize {
        let mask = self.slots.len() - 1;
        let mut slot = key.hash() as usize & mask;
        while self.slots[slot] != 0 && self.cells[self.slots[slot] as usize - 1].key != *key {
            slot = (slot + 1) & mask;
        }
        slot
    }

    fn find(&self, key: &Key) -> Option<&Cell<S>> {
        let place = self.slots[self.slot(key)];
        (place != 0).then(|| &self.cells[place as usize - 1])
    }
}

impl<S: Clone> Table<S> {
    /// Adds up the contributions of a part; the position of each one's cell.
    fn sum<C: Contribution<Sum = S>>(&mut self, ids: &[u32], keys: &[Option<Key>], values: &[C], cells: &mut Vec<u32>) {
        for &id in ids {
            let Some(key) = &keys[id as usize] else { continue };
            let slot = self.slot(key);
            if self.slots[slot] == 0 {
                self.cells.push(Cell { key: *key, sum: C::NOTHING, count: 0 });
                self.slots[slot] = self.cells.len() as u32;
            }
            let place = self.slots[slot] - 1;
            let cell = &mut self.cells[place as usize];
            values[id as usize].add(1.0, &mut cell.sum);
            cell.count += 1;
            cells.push(place);
        }
    }
}

/// Replaces values by the averages of their cells; how many each averages, zero without a key.
pub(super) fn averages<C>(keys: &[Option<Key>], values: &mut [C]) -> Vec<u32>
where
    C: Contribution + Send + Sync,
{
    let parts = Parts::new(keys);
    let of_part = |part: usize| {
        let ids = parts.ids(part);
        let (mut table, mut cells) = (Table::new(ids.len()), Vec::with_capacity(ids.len()));
        table.sum(ids, keys, values, &mut cells);
        let mean = |cell: &Cell<C::Sum>| (C::mean(&cell.sum, f64::from(cell.count)), cell.count);
        (table.cells.iter().map(mean).collect::<Vec<_>>(), cells)
    };
    let found = parallel::map_parts(parts.len(), of_part);
    let mut counts = vec![0; values.len()];
    for (part, (means, cells)) in found.into_iter().enumerate() {
        for (&id, cell) in parts.ids(part).iter().zip(cells) {
            let (mean, count) = means[cell as usize];
            // Alone, bit for bit.
            if count > 1 {
                values[id as usize] = mean;
            }
            counts[id as usize] = count;
        }
    }
    counts
}

/// All cells, to be asked.
pub(super) struct Cells<C: Contribution> {
    tables: Vec<Table<C::Sum>>,
    bits: u32,
}

impl<C> Cells<C>
where
    C: Contribution + Send + Sync,
{
    pub(super) fn new(keys: &[Option<Key>], values: &[C]) -> Self {
        let parts = Parts::new(keys);
        let of_part = |part: usize| {
            let ids = parts.ids(part);
            let mut table = Table::new(ids.len());
            table.sum(ids, keys, values, &mut Vec::new());
            table
        };
        Self { tables: parallel::map_parts(parts.len(), of_part), bits: parts.bits }
    }

    /// The average of a cell, if anything fell into it.
    pub(super) fn mean(&self, key: &Key) -> Option<C> {
        let cell = self.tables[part_of(key, self.bits) as usize].find(key)?;
        Some(C::mean(&cell.sum, f64::from(cell.count)))
    }
}
