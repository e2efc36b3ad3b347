//! What importers warn of.

use std::collections::HashMap;
use std::fmt::Display;

/// Warnings in their order: the same message at other places is counted only.
#[derive(Debug, Default)]
pub(crate) struct Warnings {
    /// Each with its first place, and how often it came.
    all: Vec<(String, String, usize)>,
    index: HashMap<String, usize>,
}

impl Warnings {
    /// Warns of something at a place.
    pub(crate) fn add(&mut self, place: &impl Display, message: impl Into<String>) {
        let message = message.into();
        if let Some(&index) = self.index.get(&message) {
            self.all[index].2 += 1;
            return;
        }
        self.index.insert(message.clone(), self.all.len());
        self.all.push((place.to_string(), message, 1));
    }

    /// A line each.
    pub(crate) fn into_lines(self) -> impl Iterator<Item = String> {
        self.all.into_iter().map(|(place, message, count)| {
            let again = if count > 1 { format!(" ({count} times)") } else { String::new() };
            format!("{place}: {message}{again}")
        })
    }
}
