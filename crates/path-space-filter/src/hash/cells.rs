//! Sums per cell, in parts that share no cell.

use super::key::Key;
use crate::{Contribution, parallel};

/// Vertices of a part, about: its table fits into a cache.
const PART: usize = 1 << 12;

/// A vertex with its cell.
#[derive(Clone, Copy)]
struct Entry<C> {
    key: Key,
    id: u32,
    value: C,
}

/// Vertices in parts by the hash of their cells: what a part needs lies together, ids ascending.
struct Parts<C> {
    parts: Vec<Vec<Entry<C>>>,
    bits: u32,
}

impl<C: Copy + Send + Sync> Parts<C> {
    fn new(keys: &[Option<Key>], values: &[C]) -> Self {
        let bits = (keys.len() / PART).max(1).ilog2().min(16);
        let part_of_each = parallel::map(keys, |key| key.as_ref().map_or(u32::MAX, |key| part_of(key, bits)));
        let mut counts = vec![0_usize; 1 << bits];
        part_of_each.iter().filter(|&&part| part != u32::MAX).for_each(|&part| counts[part as usize] += 1);
        let mut parts: Vec<Vec<Entry<C>>> = counts.into_iter().map(Vec::with_capacity).collect();
        for (((id, key), &value), &part) in (0_u32..).zip(keys).zip(values).zip(&part_of_each) {
            if let Some(key) = *key {
                parts[part as usize].push(Entry { key, id, value });
            }
        }
        Self { parts, bits }
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
    fn sum<C: Contribution<Sum = S>>(&mut self, entries: &[Entry<C>], cells: &mut Vec<u32>) {
        for entry in entries {
            let slot = self.slot(&entry.key);
            if self.slots[slot] == 0 {
                self.cells.push(Cell { key: entry.key, sum: C::NOTHING, count: 0 });
                self.slots[slot] = self.cells.len() as u32;
            }
            let place = self.slots[slot] - 1;
            let cell = &mut self.cells[place as usize];
            entry.value.add(1.0, &mut cell.sum);
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
    let Parts { parts, .. } = Parts::new(keys, values);
    let of_part = |part: usize| {
        let entries = &parts[part];
        let (mut table, mut cells) = (Table::new(entries.len()), Vec::with_capacity(entries.len()));
        table.sum(entries, &mut cells);
        let mean = |cell: &Cell<C::Sum>| (C::mean(&cell.sum, f64::from(cell.count)), cell.count);
        (table.cells.iter().map(mean).collect::<Vec<_>>(), cells)
    };
    let found = parallel::map_parts(parts.len(), of_part);
    let mut counts = vec![0; values.len()];
    for (entries, (means, cells)) in parts.iter().zip(found) {
        for (entry, cell) in entries.iter().zip(cells) {
            let (mean, count) = means[cell as usize];
            // Alone, bit for bit.
            if count > 1 {
                values[entry.id as usize] = mean;
            }
            counts[entry.id as usize] = count;
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
        let Parts { parts, bits } = Parts::new(keys, values);
        let of_part = |part: usize| {
            let mut table = Table::new(parts[part].len());
            table.sum(&parts[part], &mut Vec::new());
            table
        };
        Self { tables: parallel::map_parts(parts.len(), of_part), bits }
    }

    /// The average of a cell, if anything fell into it.
    pub(super) fn mean(&self, key: &Key) -> Option<C> {
        let cell = self.tables[part_of(key, self.bits) as usize].find(key)?;
        Some(C::mean(&cell.sum, f64::from(cell.count)))
    }
}
