//! Claims as tables for a page of documentation.

use std::fmt::Write;

use super::Estimate;
use super::claims::why_not;
use super::number::text_with_interval;
use crate::experiments::{Claim, Report};

/// A section for each experiment, from what it shows and what it found: a table of its claims, then why those do not hold that do not.
pub(super) fn markdown<'a>(sections: impl IntoIterator<Item = (&'a str, &'a Report)>) -> String {
    let mut text = String::new();
    for (about, report) in sections {
        let form = if report.quick { ", quick form" } else { "" };
        // Writing into a string does not fail.
        let _ = writeln!(text, "## {}\n\n{about}. Seed {}{form}.\n", report.experiment, report.seed);
        if report.claims.is_empty() {
            continue;
        }
        text.push_str("| claim | claimed | measured (95 % interval) | |\n|---|---|---|---|\n");
        for claim in &report.claims {
            let measured = text_with_interval(&Estimate { value: claim.measured, ci95: claim.ci95 });
            let _ =
                writeln!(text, "| {} | {} | {measured} | {} |", cell(&claim.id), cell(&claim.paper), verdict(claim));
        }
        text.push('\n');
        for claim in report.claims.iter().filter(|claim| !claim.holds) {
            let note = if claim.note.is_empty() { String::new() } else { format!(" {}", claim.note) };
            let _ = writeln!(text, "- *{}*: {}.{note}", claim.id, why_not(claim));
        }
        if report.claims.iter().any(|claim| !claim.holds) {
            text.push('\n');
        }
    }
    text.truncate(text.trim_end().len());
    text.push('\n');
    text
}

fn verdict(claim: &Claim) -> &'static str {
    match (claim.is_claimed(), claim.holds) {
        (false, _) => "measured",
        (true, true) => "holds",
        (true, false) => "**does not hold**",
    }
}

/// Bars end cells; alone, a dash means that nothing is claimed.
fn cell(text: &str) -> String {
    if text == "-" { String::new() } else { text.replace('|', "\\|") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn claims_that_do_not_hold_stand_below_their_table() {
        let claim = |id: &str, paper: &str, holds| Claim {
            id: id.into(),
            paper: paper.into(),
            measured: 0.5,
            ci95: [0.4, 0.6],
            holds,
            ..Claim::default()
        };
        let fails = claim("b", ">= 1", false).because("Rays are cheap.");
        let claims = vec![claim("a|a", "< 1", true), fails, claim("c", "-", true)];
        let report = Report { experiment: "e".into(), claims, seed: 3, ..Report::default() };
        let text = markdown([("what it shows", &report)]);
        assert!(text.starts_with("## e\n\nwhat it shows. Seed 3.\n\n| claim |"), "{text}");
        assert!(text.contains("| a\\|a | < 1 |") && text.contains("| holds |\n"), "{text}");
        assert!(text.contains("| b | >= 1 |") && text.contains("| **does not hold** |\n"), "{text}");
        assert!(text.contains("| c |  |") && text.contains("| measured |\n"), "{text}");
        assert!(text.ends_with("- *b*: all of the interval is below 1. Rays are cheap.\n"), "{text}");
    }
}
