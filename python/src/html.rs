//! Small pieces of HTML for notebooks. Every text is escaped.

use std::fmt::Write;

pub fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            c if c.is_control() => out.push(' '),
            c => out.push(c),
        }
    }
    out
}

pub fn table(names: &[String], rows: &[Vec<String>], note: Option<String>) -> String {
    let mut out = String::from("<table><thead><tr>");
    for name in names {
        let _ = write!(out, "<th>{}</th>", escaped(name));
    }
    out += "</tr></thead><tbody>";
    for row in rows {
        out += "<tr>";
        for cell in row {
            let _ = write!(out, "<td>{}</td>", escaped(cell));
        }
        out += "</tr>";
    }
    out += "</tbody></table>";
    if let Some(note) = note {
        let _ = write!(out, "<p>{}</p>", escaped(&note));
    }
    out
}

/// The head of a result: a title, and the verdict in words with a mark, so that colour is not
/// needed.
pub fn head(title: &str, holds: Option<bool>, word: &str, reasons: &[String]) -> String {
    let (mark, color) = match holds {
        Some(true) => ("✓", "#1b7f3b"),
        Some(false) => ("✗", "#b3261e"),
        None => ("–", "#6b6b6b"),
    };
    let mut out = format!(
        "<p>{}</p><p style=\"color:{color};font-weight:bold\">{mark} {}</p>",
        escaped(title),
        escaped(word)
    );
    if !reasons.is_empty() {
        out += "<ul>";
        for reason in reasons {
            let _ = write!(out, "<li>{}</li>", escaped(reason));
        }
        out += "</ul>";
    }
    out
}

/// A figure of the report. It is an image, so that neither its names nor its styles meet those of
/// the page.
pub fn figure(svg: &str, alt: &str) -> String {
    let mut data = String::with_capacity(3 * svg.len());
    for byte in svg.bytes() {
        match byte {
            b'a'..=b'z'
            | b'A'..=b'Z'
            | b'0'..=b'9'
            | b'-'
            | b'.'
            | b'_'
            | b'~'
            | b'/'
            | b':'
            | b'='
            | b' ' => data.push(byte.into()),
            _ => {
                let _ = write!(data, "%{byte:02X}");
            }
        }
    }
    format!(
        "<img style=\"max-width:100%\" alt=\"{}\" src=\"data:image/svg+xml,{data}\">",
        escaped(alt)
    )
}
