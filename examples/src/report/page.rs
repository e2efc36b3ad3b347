//! The page around everything.

use maud::{DOCTYPE, Markup, PreEscaped, html};

use super::number::breakable;

const STYLE: &str = include_str!("style.css");
const SCRIPT: &str = include_str!("viewer.js");

/// A page in one file: style, script and data are in it, and nothing is fetched.
#[derive(Clone, Debug)]
pub struct Page {
    /// The title.
    pub title: String,
    /// What it is about, below the title.
    pub lead: Markup,
    /// Everything else.
    pub body: Markup,
}

impl Page {
    /// The file.
    pub fn html(&self) -> String {
        // The policy makes sure that nothing is fetched, now or after a careless change.
        let policy = "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src data:";
        let page = html! {
            (DOCTYPE)
            html lang="en" {
                head {
                    meta charset="utf-8";
                    meta http-equiv="Content-Security-Policy" content=(policy);
                    meta name="viewport" content="width=device-width, initial-scale=1";
                    meta name="generator" content=(concat!("Lichtwerk ", env!("CARGO_PKG_VERSION")));
                    title { (self.title) }
                    link rel="icon" href="data:,";
                    style { (PreEscaped(STYLE)) }
                }
                body {
                    header {
                        h1 { (breakable(&self.title)) }
                        button.theme type="button" { "Theme: system" }
                        div.lead { (self.lead) }
                    }
                    main { (self.body) }
                    footer { p { "Written by Lichtwerk " (env!("CARGO_PKG_VERSION")) "." } }
                    script { (PreEscaped(SCRIPT)) }
                }
            }
        };
        page.into_string()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pages_are_whole_escape_titles_and_fetch_nothing() {
        let page = Page { title: "<a> & b".into(), lead: html! {}, body: html! { p { "<x>" } } };
        let text = page.html();
        assert!(text.starts_with("<!DOCTYPE html>") && text.ends_with("</html>"));
        assert!(text.contains("<h1>&lt;a&gt; &amp; b</h1>") && text.contains("<p>&lt;x&gt;</p>"));
        assert!(!text.contains("http://") && !text.contains("https://"), "an address to fetch from");
        // What is included as it is must not end its element.
        assert!(!STYLE.contains('<') && !SCRIPT.contains("</script"));
    }
}
