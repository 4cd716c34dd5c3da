//! As much of XML as it takes to look into drawings and pages.

/// One start tag or empty element: its name and what stands in it.
#[derive(Debug)]
pub struct Tag<'a> {
    pub name: &'a str,
    text: &'a str,
    /// Text up to the next tag.
    pub content: &'a str,
}

impl<'a> Tag<'a> {
    pub fn get(&self, attribute: &str) -> Option<&'a str> {
        let (_, rest) = self.text.split_once(&format!(" {attribute}=\""))?;
        rest.split('"').next()
    }

    /// An attribute that must be a number.
    pub fn number(&self, attribute: &str) -> f64 {
        let text = self.get(attribute).unwrap_or_else(|| panic!("no {attribute} in {self:?}"));
        text.parse().unwrap_or_else(|_| panic!("{attribute} of {self:?} is no number"))
    }
}

/// All start tags in order.
pub fn tags(text: &str) -> Vec<Tag<'_>> {
    let pieces = text
        .split('<')
        .skip(1)
        .filter(|piece| piece.starts_with(|c: char| c.is_ascii_alphabetic()));
    pieces
        .map(|piece| {
            let (inside, content) = piece.split_once('>').expect("a tag ends");
            let name =
                inside.split(|c: char| c.is_whitespace() || c == '/').next().unwrap_or_default();
            Tag { name, text: inside, content: content.trim() }
        })
        .collect()
}

/// Panics unless every element that is opened is closed in turn; `empty` are names that need no
/// end.
pub fn balanced(text: &str, empty: &[&str]) {
    let mut open: Vec<&str> = Vec::new();
    for piece in text.split('<').skip(1).filter(|piece| !piece.starts_with('!')) {
        let (inside, rest) = piece.split_once('>').unwrap_or_else(|| panic!("<{piece} has no end"));
        assert!(!rest.contains('>'), "> not escaped: {rest}");
        if let Some(name) = inside.strip_prefix('/') {
            assert_eq!(open.pop(), Some(name.trim()), "closed by </{name}>");
            continue;
        }
        assert_eq!(inside.matches('"').count() % 2, 0, "quotes of <{inside}>");
        let name = inside.split(|c: char| c.is_whitespace() || c == '/').next().unwrap_or_default();
        if !inside.ends_with('/') && !empty.contains(&name) {
            open.push(name);
        }
    }
    assert!(open.is_empty(), "{open:?} left open");
}
