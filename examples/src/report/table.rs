//! Tables of measurements.

use maud::{Markup, html};

use super::Estimate;
use super::number::{breakable, with_interval};

/// Which end of a column is the better one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Better {
    /// Small numbers, as of errors and times.
    Lower,
    /// Large numbers, as of efficiencies.
    Higher,
}

/// What a number is among those of its column.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mark {
    /// Nothing in particular.
    #[default]
    None,
    /// Better than all others, by intervals that are apart.
    Best,
    /// It may be the best: its interval overlaps that of the best number, or that number is it and others overlap.
    Tied,
}

/// Marks the best number of a column, or those that it is tied with.
///
/// Numbers that are not finite take no part; a number alone has nothing to be compared with.
///
/// ```
/// use lichtwerk::report::{Better, Estimate, Mark, mark};
///
/// let of = |value, low, high| Estimate { value, ci95: [low, high] };
/// let column = [of(3.0, 2.5, 3.5), of(1.0, 0.9, 1.1), of(1.1, 1.05, 1.2)];
/// assert_eq!(mark(&column, Better::Lower), [Mark::None, Mark::Tied, Mark::Tied]);
/// assert_eq!(mark(&column, Better::Higher), [Mark::Best, Mark::None, Mark::None]);
/// ```
pub fn mark(column: &[Estimate], better: Better) -> Vec<Mark> {
    let compare = |a: &&Estimate, b: &&Estimate| match better {
        Better::Lower => a.value.total_cmp(&b.value),
        Better::Higher => b.value.total_cmp(&a.value),
    };
    let finite: Vec<&Estimate> = column.iter().filter(|estimate| estimate.value.is_finite()).collect();
    let Some(&best) = finite.iter().min_by(|a, b| compare(a, b)).filter(|_| finite.len() > 1) else {
        return vec![Mark::None; column.len()];
    };
    let overlaps = |estimate: &Estimate| estimate.value.is_finite() && estimate.overlaps(best);
    let first = if column.iter().filter(|estimate| overlaps(estimate)).count() > 1 { Mark::Tied } else { Mark::Best };
    column.iter().map(|estimate| if overlaps(estimate) { first } else { Mark::None }).collect()
}

/// A column of measurements.
#[derive(Clone, Debug)]
pub struct Column {
    /// What is measured.
    pub title: String,
    /// Its unit, or what it is in a few words.
    pub unit: String,
    /// What to mark; nothing where no end is better.
    pub better: Option<Better>,
    /// One for each row.
    pub values: Vec<Estimate>,
}

/// A table: what its rows are, and what was measured.
#[derive(Clone, Debug)]
pub struct Table {
    /// What it shows.
    pub caption: String,
    /// What the rows are called.
    pub heading: String,
    /// The rows.
    pub rows: Vec<String>,
    /// The columns.
    pub columns: Vec<Column>,
}

impl Table {
    /// The table in HTML.
    pub fn html(&self) -> Markup {
        let marks: Vec<Vec<Mark>> = self
            .columns
            .iter()
            .map(|column| column.better.map_or_else(Vec::new, |better| mark(&column.values, better)))
            .collect();
        html! {
            div.scroll tabindex="0" role="region" aria-label=(self.caption) {
                table.measured {
                    caption { (self.caption) }
                    thead {
                        tr {
                            th scope="col" { (self.heading) }
                            @for column in &self.columns {
                                th.number scope="col" { (column.title) @if !column.unit.is_empty() { br; small { (column.unit) } } }
                            }
                        }
                    }
                    tbody {
                        @for (index, row) in self.rows.iter().enumerate() {
                            tr {
                                th scope="row" { (breakable(row)) }
                                @for (column, marks) in self.columns.iter().zip(&marks) {
                                    (cell(column.values.get(index), marks.get(index).copied().unwrap_or_default()))
                                }
                            }
                        }
                    }
                }
            }
        }
    }
}

fn cell(value: Option<&Estimate>, mark: Mark) -> Markup {
    let text = value.map(with_interval).unwrap_or_default();
    match mark {
        Mark::None => html! { td.number { (text) } },
        Mark::Best => html! { td.number.best { (text) " " span.mark { "★ best" } } },
        Mark::Tied => html! { td.number.tied { (text) " " span.mark { "≈ tied" } } },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(value: f64, half: f64) -> Estimate {
        Estimate { value, ci95: [value - half, value + half] }
    }

    #[test]
    fn the_best_is_marked_only_if_it_is_apart() {
        let apart = [of(1.0, 0.1), of(2.0, 0.1), of(3.0, 0.1)];
        assert_eq!(mark(&apart, Better::Lower), [Mark::Best, Mark::None, Mark::None]);
        assert_eq!(mark(&apart, Better::Higher), [Mark::None, Mark::None, Mark::Best]);
        // The third one is farther away, but so uncertain that it may be the best too.
        let uncertain = [of(1.0, 0.1), of(2.0, 0.1), of(3.0, 2.5)];
        assert_eq!(mark(&uncertain, Better::Lower), [Mark::Tied, Mark::None, Mark::Tied]);
        // Two trials that were not repeated.
        let single = [Estimate::of_mean(&[1.0]), Estimate::of_mean(&[2.0])];
        assert_eq!(mark(&single, Better::Lower), [Mark::Tied; 2]);
    }

    #[test]
    fn what_cannot_be_compared_is_not_marked() {
        assert_eq!(mark(&[of(1.0, 0.1)], Better::Lower), [Mark::None]);
        assert_eq!(mark(&[of(f64::NAN, 0.0), of(1.0, 0.1)], Better::Lower), [Mark::None; 2]);
        assert!(mark(&[], Better::Higher).is_empty());
    }

    #[test]
    fn tables_escape_what_they_are_given() {
        let column = Column { title: "<i>".into(), unit: String::new(), better: None, values: vec![of(1.0, 0.1)] };
        let table = Table {
            caption: "a & b".into(),
            heading: "x".into(),
            rows: vec!["<script>".into()],
            columns: vec![column],
        };
        let text = table.html().into_string();
        assert!(text.contains("a &amp; b") && text.contains("&lt;script&gt;") && text.contains("&lt;i&gt;"), "{text}");
        assert!(!text.contains("<script>") && !text.contains("<i>"));
    }
}
