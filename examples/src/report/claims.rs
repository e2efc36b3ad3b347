//! Tables of claims.

use maud::{Markup, html};

use super::Estimate;
use super::number::{number, with_interval};
use crate::experiments::{Claim, Report, Row};

/// What the paper says, what was measured, and whether that agrees.
pub(super) fn claims(claims: &[Claim]) -> Markup {
    let all_hold = claims.iter().all(|claim| claim.holds);
    html! {
        @if !claims.is_empty() {
            div.scroll tabindex="0" role="region" aria-label="Claims" {
                table.claims {
                    thead { tr {
                        th scope="col" { "claim" } th.number scope="col" { "claimed" }
                        th.number scope="col" { "measured " small { "(95 % interval)" } }
                        th scope="col" { "verdict" }
                        @if !all_hold { th scope="col" { "why not" } }
                    } }
                    tbody { @for claim in claims { (row(claim, all_hold)) } }
                }
            }
        }
    }
}

fn row(claim: &Claim, all_hold: bool) -> Markup {
    html! {
        tr.fails[!claim.holds] {
            th scope="row" { (claim.id) }
            td.number { (claim.paper) }
            td.number { (with_interval(&Estimate { value: claim.measured, ci95: claim.ci95 })) }
            td {
                @if !claim.is_claimed() { "measured" } @else if claim.holds { span.holds { "✓ holds" } } @else { span.broken { "✗ does not hold" } }
            }
            @if !all_hold { td.note {
                (why_not(claim))
                @if !claim.note.is_empty() { br; (claim.note) }
            } }
        }
    }
}

/// How far a claim is from what was measured, where it does not hold.
///
/// A bound (`>= 2`, `< 1`) or a number within the interval could still be true: the experiment was too short to tell.
pub(super) fn why_not(claim: &Claim) -> String {
    let [low, high] = claim.ci95;
    if claim.holds {
        return String::new();
    }
    if !claim.measured.is_finite() {
        return "nothing could be measured".to_owned();
    }
    let number: String = claim.paper.chars().filter(|c| c.is_ascii_digit() || ".-+e".contains(*c)).collect();
    match number.parse::<f64>() {
        Ok(limit) if low <= limit && limit <= high => {
            format!("the interval contains {limit}: more trials would be needed to tell")
        }
        Ok(limit) if high < limit => format!("all of the interval is below {limit}"),
        Ok(limit) => format!("all of the interval is above {limit}"),
        Err(_) => "the measurement contradicts it".to_owned(),
    }
}

/// A number of a row.
type Measure = fn(&Row) -> f64;

/// The rows of `report.json`.
pub(super) fn rows(report: &Report) -> Markup {
    let has = |measure: Measure| report.rows.iter().any(|row| measure(row) != 0.0);
    let all: [(&str, Measure); 4] = [
        ("seconds", |row| row.seconds),
        ("rays", |row| row.rays as f64),
        ("variance", |row| row.variance),
        ("relative MSE", |row| row.rel_mse),
    ];
    let columns: Vec<_> = all.into_iter().filter(|(_, measure)| has(*measure)).collect();
    html! {
        div.scroll tabindex="0" role="region" aria-label="Measurements" {
            table.rows {
                thead { tr {
                    th scope="col" { "scene" } th scope="col" { "estimator" } th scope="col" { "settings" }
                    @for (title, _) in &columns { th.number scope="col" { (title) } }
                } }
                tbody {
                    @for row in &report.rows {
                        tr {
                            td { (row.scene) } td { (row.estimator) } td.settings { (settings(row)) }
                            @for (_, measure) in &columns { td.number { (number(measure(row))) } }
                        }
                    }
                }
            }
        }
    }
}

fn settings(row: &Row) -> String {
    let setting = |(name, value): (&String, &serde_json::Value)| match value {
        serde_json::Value::String(text) => format!("{name} {text}"),
        other => format!("{name} {other}"),
    };
    row.params.iter().map(setting).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn claim(paper: &str, measured: f64, ci95: [f64; 2], holds: bool) -> Claim {
        Claim { id: "<c>".into(), paper: paper.into(), measured, ci95, holds, ..Claim::default() }
    }

    #[test]
    fn claims_that_do_not_hold_say_why() {
        for (paper, ci95, reason) in [
            ("> 1", [0.8, 1.2], "more trials"),
            (">= 2", [0.8, 1.2], "below 2"),
            ("< 0.5", [0.8, 1.2], "above 0.5"),
            ("1e-1", [0.8, 1.2], "above 0.1"),
            ("less noise", [0.8, 1.2], "contradicts"),
        ] {
            let text = why_not(&claim(paper, 1.0, ci95, false));
            assert!(text.contains(reason), "{paper}: {text}");
        }
        assert_eq!(why_not(&claim("> 1", 2.0, [1.5, 2.5], true)), "");
        assert!(why_not(&claim("> 1", f64::NAN, [f64::NAN; 2], false)).contains("nothing"));
    }

    #[test]
    fn verdicts_are_words_and_names_are_escaped() {
        let text = claims(&[claim("> 1", 2.0, [1.5, 2.5], true), claim("> 1", 0.5, [0.4, 0.6], false)]).into_string();
        assert!(text.contains("✓ holds") && text.contains("✗ does not hold") && text.contains("&lt;c&gt;"), "{text}");
        assert!(claims(&[]).into_string().is_empty());
        let known = claim("> 1", 0.5, [0.4, 0.6], false).because("rays & time");
        let text = claims(&[known]).into_string();
        assert!(text.contains("below 1<br>rays &amp; time"), "{text}");
        let text = claims(&[claim("-", 2.0, [1.5, 2.5], true)]).into_string();
        assert!(text.contains("measured</td>") && !text.contains("holds"), "nothing is claimed: {text}");
    }
}
