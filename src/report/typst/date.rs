//! Date of a PDF: the date of issue that the campaign states, or none.

use typst::foundations::Datetime;
use typst_pdf::Timestamp;

/// The date of issue, `2026-03-31`, at 00:00. `None` if the text is not a date.
pub fn issued(text: &str) -> Option<Timestamp> {
    let mut parts = text.split('-');
    let (year, month, day) =
        (parts.next()?.parse().ok()?, parts.next()?.parse().ok()?, parts.next()?.parse().ok()?);
    if parts.next().is_some() {
        return None;
    }
    Datetime::from_ymd_hms(year, month, day, 0, 0, 0).map(Timestamp::new_utc)
}

/// The PDF writer requires a date if files are attached. This one is removed afterwards.
pub fn placeholder() -> Option<Timestamp> {
    Datetime::from_ymd_hms(1, 1, 1, 0, 0, 0).map(Timestamp::new_utc)
}

/// The metadata entries that contain [`placeholder`]. They cannot occur in texts of the document,
/// which are compressed, or escape `<` and parentheses.
const PLACEHOLDERS: [&[u8]; 5] = [
    b"/ModDate(D:00010101000000Z)",
    b"/CreationDate(D:00010101000000Z)",
    b"<xmp:ModifyDate>0001-01-01T00:00:00+00:00</xmp:ModifyDate>",
    b"<xmp:CreateDate>0001-01-01T00:00:00+00:00</xmp:CreateDate>",
    b"<stEvt:when>0001-01-01T00:00:00+00:00</stEvt:when>",
];

/// Overwrites the entries with blanks, which are allowed there, so that all offsets in the file
/// remain valid.
pub fn remove_placeholder(bytes: &mut [u8]) {
    for entry in PLACEHOLDERS {
        let mut at = 0;
        while let Some(found) = bytes[at..].windows(entry.len()).position(|window| window == entry)
        {
            at += found;
            bytes[at..at + entry.len()].fill(b' ');
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_day_of_the_calendar_is_a_date() {
        assert!(issued("2026-02-28").is_some());
        for text in ["2026-02-30", "2026-02", "2026-02-28-1", "soon", ""] {
            assert!(issued(text).is_none(), "{text}");
        }
    }

    #[test]
    fn what_is_taken_out_leaves_the_rest_in_its_place() {
        let mut bytes = b"a/ModDate(D:00010101000000Z)/CreationDate(D:00010101000000Z)/ModDate(D:20260101000000Z)z".to_vec();
        let length = bytes.len();
        remove_placeholder(&mut bytes);
        assert_eq!((bytes.len(), bytes[0], bytes[length - 1]), (length, b'a', b'z'));
        assert_eq!(
            String::from_utf8_lossy(&bytes).split_whitespace().collect::<Vec<_>>(),
            ["a", "/ModDate(D:20260101000000Z)z"]
        );
    }
}
