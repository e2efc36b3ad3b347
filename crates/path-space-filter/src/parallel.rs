//! Loops that use rayon's pool if there is one.

/// Elements that a task takes.
const CHUNK: usize = 1 << 12;

/// `f` of each element, in their order.
pub(crate) fn map<T: Sync, U: Send>(elements: &[T], f: impl Fn(&T) -> U + Sync) -> Vec<U> {
    map_range(elements.len(), |i| f(&elements[i]))
}

/// `f` of `0..len`, in order.
pub(crate) fn map_range<U: Send>(len: usize, f: impl Fn(usize) -> U + Sync) -> Vec<U> {
    let chunk = |chunk: usize| (chunk * CHUNK..len.min((chunk + 1) * CHUNK)).map(&f).collect::<Vec<U>>();
    let mut chunks = map_parts(len.div_ceil(CHUNK), chunk);
    if chunks.len() == 1 {
        return chunks.remove(0);
    }
    let mut all = Vec::with_capacity(len);
    chunks.iter_mut().for_each(|chunk| all.append(chunk));
    all
}

/// `f` of `0..len`, in order, where each takes long enough to be worth a task.
pub(crate) fn map_parts<U: Send>(len: usize, f: impl Fn(usize) -> U + Sync) -> Vec<U> {
    #[cfg(feature = "rayon")]
    {
        use std::sync::{Mutex, PoisonError};
        let results: Vec<Mutex<Option<U>>> = (0..len).map(|_| Mutex::new(None)).collect();
        for_each(len, &|i| {
            let result = f(i);
            *results[i].lock().unwrap_or_else(PoisonError::into_inner) = Some(result);
        });
        results.into_iter().filter_map(|result| result.into_inner().unwrap_or_else(PoisonError::into_inner)).collect()
    }
    #[cfg(not(feature = "rayon"))]
    (0..len).map(f).collect()
}

/// Calls `f` for `0..len`, on all threads. For all types alike, so that rayon's code is compiled once.
#[cfg(feature = "rayon")]
fn for_each(len: usize, f: &(dyn Fn(usize) + Sync)) {
    use rayon::prelude::*;
    (0..len).into_par_iter().for_each(f);
}
