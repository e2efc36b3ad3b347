//! The page of a comparison.

use maud::{Markup, html};

use super::measure::Measured;
use super::pictures::pictures;
use super::{Found, describe};
use crate::program::Failure;
use crate::program::showcase::relative_standard_error;
use crate::report::{Better, Column, Estimate, Page, Plot, Series, Table, Viewer};

/// The share of the smallest error from which the reference's own error is worth a warning.
const SUSPICIOUS: f64 = 0.1;

impl Found<'_> {
    pub(super) fn page(&self) -> Result<Page, Failure> {
        let names: Vec<&str> = self.entries.iter().map(|entry| entry.text.as_str()).collect();
        let whole: Vec<(&str, &Measured)> = names.iter().copied().zip(self.whole()).collect();
        let pictures = pictures(&self.reference.image, &whole)?;
        let shown = whole.iter().filter(|(_, measured)| !measured.errors.is_empty()).count();
        let right = if shown > 1 { 2 } else { 0 };
        let viewer = Viewer { pictures, left: 1, right, exposure: self.common.exposure };
        let level = self.level();
        let last = self.plan.budgets.len() - 1;
        let body = html! {
            h2 { "Images" }
            p {
                "What is shown of an estimator is the mean of its " (self.most_trials(level)) " renderings with " (describe(self.plan.budgets[level]))
                ": it has less noise than each of them. Maps of the squared error are means over the renderings, and have the relative MSE of the "
                "table as their mean; FLIP compares the image that is shown with the reference, at exposure 0."
            }
            (viewer.html())
            h2 { "Results" }
            (self.table(level).html())
            (self.reference_note(level))
            h2 { "Convergence" }
            div.plots { (self.plot("time", "seconds", |measured| &measured.seconds)) (self.plot("samples", "samples per pixel", |measured| &measured.samples)) }
            @if last > 0 {
                details { summary { "All budgets" }
                    @for smaller in (0..=last).filter(|other| *other != level) { (self.table(smaller).html()) }
                }
            }
            (notes())
        };
        Ok(Page { title: format!("{}: {}", self.scene.name(), list(&names)), lead: self.lead(), body })
    }

    /// The settings.
    fn lead(&self) -> Markup {
        let wanted = self.plan.trials;
        let found = self.most_trials(0);
        let full = self.measured.iter().flatten().all(|measured| measured.errors.len() as u64 == wanted);
        html! {
            dl.settings {
                div { dt { "scene" } dd { (self.arguments.scene) } }
                div { dt { "size" } dd { (self.size()) } }
                div { dt { "budget" } dd { (describe(self.plan.budgets[self.plan.budgets.len() - 1])) } }
                div { dt { "trials" } dd { (wanted) } }
                div { dt { "seed" } dd { (self.plan.seed) } }
                div { dt { "reference" } dd { (self.reference.about) } }
                @for entry in self.entries.iter().filter(|entry| entry.arguments.estimator.connects_light_paths()) {
                    div { dt { (entry.text) } dd { (entry.arguments.light_paths.describe_paths()) } }
                }
            }
            @if !full {
                p.notice { "Interrupted: " (found) " of " (wanted) " trials were begun. Intervals tell what these few are worth." }
            }
        }
    }

    /// The largest number of trials that an estimator has with this budget.
    fn most_trials(&self, level: usize) -> usize {
        self.measured.iter().map(|of_entry| of_entry[level].errors.len()).max().unwrap_or(0)
    }

    fn table(&self, level: usize) -> Table {
        let of = |number: fn(&Measured) -> Estimate| -> Vec<Estimate> {
            self.measured.iter().map(|of_entry| number(&of_entry[level])).collect()
        };
        let column = |title: &str, unit: &str, better, number| Column {
            title: title.to_owned(),
            unit: unit.to_owned(),
            better,
            values: of(number),
        };
        Table {
            caption: format!(
                "{}; means of {} trials with their 95 % intervals",
                describe(self.plan.budgets[level]),
                self.most_trials(level)
            ),
            heading: "estimator".to_owned(),
            rows: self.entries.iter().map(|entry| entry.text.clone()).collect(),
            columns: vec![
                column("samples", "per pixel", None, |measured| Estimate::of_mean(&measured.samples)),
                column("time", "seconds", Some(Better::Lower), |measured| Estimate::of_mean(&measured.seconds)),
                column("rays", "", Some(Better::Lower), |measured| Estimate::of_mean(&measured.rays)),
                column("error", "relative MSE", Some(Better::Lower), |measured| Estimate::of_mean(&measured.errors)),
                column("efficiency", "1 / (error · seconds)", Some(Better::Higher), |measured| {
                    Estimate::of_inverse_product(&measured.errors, &measured.seconds)
                }),
            ],
        }
    }

    fn plot(&self, against: &str, unit: &str, cost: fn(&Measured) -> &Vec<f64>) -> Markup {
        let series = self.entries.iter().zip(self.measured).map(|(entry, of_entry)| {
            let some = || of_entry.iter().filter(|measured| !measured.errors.is_empty());
            let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
            Series {
                name: entry.text.clone(),
                points: some().map(|measured| (mean(cost(measured)), Estimate::of_mean(&measured.errors))).collect(),
                trials: some()
                    .flat_map(|measured| cost(measured).iter().zip(&measured.errors).map(|(x, y)| [*x, *y]))
                    .collect(),
            }
        });
        let plot = Plot {
            title: format!("Error against {against}"),
            x: unit.to_owned(),
            y: "relative MSE".to_owned(),
            series: series.collect(),
        };
        plot.html()
    }

    /// The reference's own error counts as an error of whatever is compared with it: the expectation of `(x - r)^2` is that of
    /// `(x - E[r])^2` and the variance of `r`. The variance in the file is an estimate, neither a bound from above nor from below.
    fn reference_note(&self, level: usize) -> Markup {
        let own = relative_standard_error(&self.reference.image).powi(2);
        let errors = self.measured.iter().map(|of_entry| Estimate::of_mean(&of_entry[level].errors).value);
        let smallest = errors.filter(|error| error.is_finite()).fold(f64::INFINITY, f64::min);
        html! {
            @if own.is_finite() && smallest.is_finite() {
                p class=[(own > SUSPICIOUS * smallest).then_some("notice")] {
                    "The reference is noisy, too: about " (format!("{own:.1e}")) " of each of these errors is the reference's own, " (percent(own / smallest))
                    " of the smallest one"
                    @if own > SUSPICIOUS * smallest { "; with more samples (--reference-spp) it would be less" }
                    ". That is estimated from the scatter of its samples as if they were independent: too much for those of a good sequence, and without what none "
                    "of them has found."
                }
            } @else if !own.is_finite() {
                p { "How much of these errors is noise of the reference is not known: it has no variances." }
            }
        }
    }
}

/// A share with two digits.
fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    match percent {
        0.0..0.01 => "less than 0.01 %".to_owned(),
        0.01..1.0 => format!("{percent:.2} %"),
        1.0..10.0 => format!("{percent:.1} %"),
        _ => format!("{percent:.0} %"),
    }
}

/// What the numbers mean.
fn notes() -> Markup {
    html! {
        section.notes {
            h2 { "How to read this" }
            ul {
                li { b { "Error" } ": the mean over pixels and channels of (x − r)² / (r² + 0.01), with the reference r." }
                li { b { "Efficiency" } ": one over error times time. For unbiased estimators it does not depend on the budget." }
                li {
                    b { "Intervals" } " contain the true value with a probability of 95 %. They come from the scatter between trials, which have "
                    "different seeds; estimators took turns, so that a machine that slows down does so for all of them."
                }
                li { b { "★ best" } " is a number whose interval is apart from all others of its column; " b { "≈ tied" } " are those that overlap with the best one's." }
                li { b { "Slopes" } " are fitted to all trials by least squares in logarithms. Error falls as one over cost, slope −1, for independent samples; faster for good sequences; to a floor with bias." }
            }
        }
    }
}

fn list(names: &[&str]) -> String {
    match names {
        [] => String::new(),
        [one] => (*one).to_owned(),
        [all @ .., last] => format!("{} and {last}", all.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_have_two_digits() {
        for (share, text) in
            [(0.0, "less than 0.01 %"), (0.00123, "0.12 %"), (0.0456, "4.6 %"), (0.25, "25 %"), (3.0, "300 %")]
        {
            assert_eq!(percent(share), text);
        }
    }

    #[test]
    fn lists_read_like_lists() {
        assert_eq!((list(&[]), list(&["a"]), list(&["a", "b", "c"])), (String::new(), "a".into(), "a, b and c".into()));
    }
}
