//! The HTML report: order, escaping, determinism, degenerate results, and a browser's opinion where
//! there is one.
// Each test file uses a part of what they share.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::common::{assessment, certification as odd, coach, xml};
use fishplate::report::{figure, html, view};
use fishplate::result::Certification;

fn page(found: &Certification) -> String {
    html::html(&view::document(found), &figure::figures(found))
        .expect("the templates can be filled")
}

#[test]
fn chapters_come_in_the_order_of_an_assessor() {
    let page = page(&coach::certification());
    let ids = [
        "cover",
        "summary",
        "figure-overview",
        "vehicle",
        "sections",
        "quantities",
        "quantity-0",
        "figure-pairs-0",
        "quantity-11",
    ];
    let more = [
        "traces",
        "figure-trace-1",
        "domain",
        "figure-domain",
        "protocol",
        "figure-graph",
        "provenance",
        "statements",
    ];
    let places: Vec<usize> = ids
        .iter()
        .chain(&more)
        .map(|id| page.find(&format!("id=\"{id}\"")).unwrap_or_else(|| panic!("no {id}")))
        .collect();
    assert!(places.is_sorted(), "{places:?}");
    assert_eq!(
        page.matches("<svg").count(),
        1 + 11 + 2 + 1,
        "overview, quantities with values, traces, domain"
    );
    assert!(
        page.contains("not validated") && page.contains("10 of 12 met, 1 not met, 1 not assessed")
    );
    assert!(
        page.contains("Rules that differ in meaning") && page.contains("limit std 0.40 m&#x2f;s^2")
    );
}

/// What limits the verdict stands beside it, on the screen as on paper.
#[test]
fn limitations_are_on_the_cover() {
    let page = page(&coach::certification());
    let cover = between(&page, "<header id=\"cover\"", "</header>");
    assert!(cover.contains("Limitations"), "{cover}");
}

#[test]
fn every_value_is_in_the_page() {
    let found = coach::certification();
    let page = page(&found);
    let first = &found.quantities[0];
    // Statistics, the worst pairs, and three numbers for each pair.
    let article = between(&page, "id=\"quantity-0\"", "</article>");
    let values = between(article, "<details", "</details>");
    assert_eq!(values.matches("<td class=\"number").count(), 3 * first.values.len());
    assert_eq!(between(article, "Largest differences", "</tbody>").matches("<tr").count(), 1 + 5);
    for file in &found.campaign.files {
        assert!(page.contains(&file.sha256), "{}", file.path);
    }
}

#[test]
fn the_same_result_gives_the_same_bytes() {
    for found in [coach::certification(), odd::certification(), coach::empty()] {
        assert_eq!(page(&found), page(&found.clone()));
    }
}

#[test]
fn texts_of_users_are_printed_and_nothing_more() {
    for found in [coach::certification(), odd::certification()] {
        let page = page(&found);
        assert_eq!(page.matches("<script>").count(), 1);
        assert_eq!(page.matches("</script>").count(), 1);
        assert!(
            !page.contains("<img src=x")
                && !page.contains("<script>alert")
                && !page.contains("<!--")
        );
        assert!(page.contains("&lt;script&gt;alert(1)&lt;&#x2f;script&gt;"));
        assert!(
            page.chars().all(|c| c == '\n' || !c.is_control()),
            "control characters are spelled out"
        );
        assert!(!page.contains('\u{202e}'));
    }
    let page = page(&coach::certification());
    assert!(
        page.contains("{{ 7*7 }}{% raw %}#{7*7}"),
        "templates are not run over what users wrote"
    );
    assert!(page.contains("S&quot;&gt;&lt;img src=x onerror=alert(2)&gt;"));
}

#[test]
fn nothing_outside_the_page_is_named() {
    let page = page(&coach::certification());
    let policy = between(&page, "Content-Security-Policy\" content=\"", "\"");
    assert!(
        policy.starts_with("default-src &#x27;none&#x27;; style-src &#x27;sha256-"),
        "{policy}"
    );
    assert!(
        !policy.contains("unsafe") && !policy.contains('*') && !policy.contains("http"),
        "{policy}"
    );
    for attribute in ["src=\"", "href=\""] {
        for (at, _) in page.match_indices(attribute) {
            let target = &page[at + attribute.len()..];
            assert!(
                target.starts_with('#') || target.starts_with("data:image&#x2f;svg+xml;base64,"),
                "{}",
                &target[..40]
            );
        }
    }
    assert!(!page.contains(" style=\"") && !page.contains("@import") && !page.contains("url("));
    for (at, _) in page.match_indices("http") {
        let rest = &page[at..];
        assert!(
            rest.starts_with("http-equiv") || rest.starts_with("http://www.w3.org/2000/svg\""),
            "{}",
            &rest[..40]
        );
    }
}

#[test]
fn elements_are_closed_and_ids_are_one_of_a_kind() {
    for found in [
        coach::certification(),
        odd::certification(),
        assessment::certification(),
        coach::empty(),
        coach::unassessed(),
    ] {
        let page = page(&found);
        let body = page
            .replace(between(&page, "<style>", "</style>"), "")
            .replace(between(&page, "<script>", "</script>"), "");
        xml::balanced(&body, &["meta", "img", "br"]);
        let mut ids: Vec<&str> = page
            .match_indices(" id=\"")
            .map(|(at, _)| page[at + 5..].split('"').next().unwrap_or_default())
            .collect();
        let all = ids.len();
        ids.sort_unstable();
        ids.dedup();
        assert_eq!(ids.len(), all);
        for (at, _) in page.match_indices("href=\"#") {
            let target = page[at + 7..].split('"').next().unwrap_or_default();
            assert!(ids.binary_search(&target).is_ok(), "#{target} is nowhere");
        }
    }
}

#[test]
fn results_with_nothing_in_them_still_make_a_report() {
    let mut one = coach::certification();
    one.quantities.truncate(1);
    one.quantities[0].values.truncate(1);
    one.sections.truncate(1);
    let mut no_sections = coach::certification();
    no_sections.sections.clear();
    for found in [coach::empty(), odd::empty(), coach::unassessed(), one, no_sections] {
        let page = page(&found);
        assert!(page.contains("id=\"statements\"") && page.contains("</html>"));
        for word in ["NaN", "undefined", ">inf"] {
            let body = page.replace(between(&page, "<script>", "</script>"), "");
            assert!(!body.contains(word), "{word}");
        }
    }
    assert!(page(&coach::empty()).contains("not assessable"));
}

/// An assessment says so, has one row for each estimate in the summary, and a table and a figure of
/// all groups.
#[test]
fn an_assessment_is_no_validation() {
    let page = page(&assessment::certification());
    assert!(
        page.contains("<title>Assessment report: ")
            && page.contains("Assessment of a vehicle by measured records")
    );
    assert!(
        page.contains("<p class=\"word\">requirements not met</p>")
            && page.contains("<dt>Assessed values</dt>")
    );
    for (from, to) in [
        ("<body>", "id=\"identity\""),
        ("id=\"quantities\"", "id=\"domain\""),
        ("id=\"statements\"", "</main>"),
    ] {
        let part = between(&page, from, to);
        for word in ["alidat", "imulat", "Pair", " pairs"] {
            assert!(
                !part.contains(word),
                "`{word}` in {}",
                &part[part.find(word).unwrap_or(0).saturating_sub(80)..][..160]
            );
        }
    }
    let summary = between(&page, "<caption>Estimates and their limits", "</table>");
    assert_eq!(summary.matches("<tr class=\"row-").count(), 3);
    assert!(
        summary.contains(assessment::FAILS) && summary.contains("15 of 16; 1 not assessed"),
        "{summary}"
    );
    let groups = between(&page, ", limit 10 kN + 2&#x2f;3 · Q0", "</table>");
    assert_eq!(groups.matches("<tr class=\"row-").count(), 16);
    for figure in ["frequency-0", "regression-0-1", "pairs-0", "trace-0"] {
        assert!(page.contains(&format!("id=\"figure-{figure}\"")), "{figure}");
    }
}

/// What the browser finds is written into the page's title by a probe that clicks, filters and
/// counts. The policy would stop the probe, so it is taken out here: that hostile texts are inert
/// must not hang on it alone.
const PROBE: &str = r##"<script>
const say = [];
const table = document.querySelector("#summary table");
const firsts = () => Array.from(table.tBodies[0].rows, row => row.cells[9].textContent.trim());
const click = n => table.tHead.rows[0].cells[n].querySelector("button").click();
click(9); say.push("up=" + firsts().slice(0, 2) + ".." + firsts().at(-1));
click(9); say.push("down=" + firsts()[0] + ".." + firsts().at(-1));
say.push("sort=" + table.tHead.rows[0].cells[9].getAttribute("aria-sort"));
const values = document.querySelector("#quantity-0 .values");
values.tHead.rows[1].cells[2].querySelector("button").click();
const third = Array.from(values.tBodies[0].rows, row => Number(row.cells[4].textContent.replace("\u2212", "-")));
say.push("nested=" + third.every((value, at) => at === 0 || value >= third[at - 1]));
const zone = document.getElementById("zone");
zone.value = "=3"; zone.dispatchEvent(new Event("change"));
say.push("rows=" + Array.from(values.tBodies[0].rows).filter(row => !row.hidden).length);
say.push("marks=" + document.querySelectorAll("#figure-pairs-0 .mark:not(.faded)").length);
const mark = document.querySelector("#figure-pairs-0 .mark");
mark.dispatchEvent(new PointerEvent("pointermove", { bubbles: true, clientX: 5, clientY: 5 }));
say.push("tip=" + document.getElementById("tip").textContent.slice(0, 9));
say.push("scripts=" + document.scripts.length, "images=" + document.querySelectorAll("img:not([src^='data:'])").length);
say.push("ran=" + window.ran, "errors=" + window.errors);
document.title = say.join("; ");
</script></body>"##;
const WATCH: &str = r#"<head><script>window.ran = 0; window.errors = 0; window.alert = () => { window.ran += 1; };
addEventListener("error", () => { window.errors += 1; }, true);</script>"#;

#[test]
fn in_a_browser_the_script_runs_and_hostile_texts_do_not() {
    let Some(browser) = browser() else {
        crate::common::tools::skip("chromium");
        return;
    };
    let folder = tempfile::tempdir().expect("a temporary folder");
    let page = page(&coach::certification());
    let (dom, said) = open(&browser, folder.path(), "report.html", &page);
    assert!(
        dom.contains("<button type=\"button\" title=\"Sort by this column\">"),
        "the script runs under the page's own policy"
    );
    assert!(dom.contains("<option value=\"=4\">"));
    assert!(!said.contains("CONSOLE"), "{said}");

    let start = page.find("<meta http-equiv").unwrap_or_default();
    let end = start + page[start..].find('>').unwrap_or_default() + 1;
    let open_page = format!("{}{}", &page[..start], &page[end..])
        .replace("<head>", WATCH)
        .replace("</body>", PROBE);
    let (dom, said) = open(&browser, folder.path(), "probe.html", &open_page);
    let title = between(&dom, "<title>", "</title>");
    let expected = "up=0.02,0.09..–; down=0.83..–; sort=descending; nested=true; rows=7; marks=56; tip=S01, Y_1R; scripts=3; images=0; ran=0; errors=0";
    assert_eq!(title, expected, "{said}");
}

fn browser() -> Option<PathBuf> {
    let names = ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable"];
    let path = std::env::var_os("PATH")?;
    let folders: Vec<PathBuf> = std::env::split_paths(&path).collect();
    names
        .iter()
        .flat_map(|name| folders.iter().map(move |folder| folder.join(name)))
        .find(|file| file.is_file())
}

/// The document after its scripts have run, and what the browser logged.
fn open(browser: &Path, folder: &Path, name: &str, page: &str) -> (String, String) {
    let file = folder.join(name);
    std::fs::write(&file, page).expect("a page in the temporary folder");
    let flags = "--headless --no-sandbox --disable-gpu --disable-quic --no-first-run --disable-background-networking \
                 --disable-component-update --disable-sync --enable-logging=stderr --dump-dom";
    let output = Command::new(browser)
        .args(flags.split_whitespace())
        .arg(format!("--user-data-dir={}", folder.join(format!("{name}-profile")).display()))
        .arg(format!("file://{}", file.display()))
        .output()
        .expect("the browser can be started");
    (
        String::from_utf8_lossy(&output.stdout).into_owned(),
        String::from_utf8_lossy(&output.stderr).into_owned(),
    )
}

fn between<'a>(text: &'a str, start: &str, end: &str) -> &'a str {
    let from = text.find(start).unwrap_or_else(|| panic!("no {start}")) + start.len();
    let to = text[from..].find(end).unwrap_or_else(|| panic!("no {end} after {start}"));
    &text[from..from + to]
}
